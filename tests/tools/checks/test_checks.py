"""What is permitted of springs, against hand calculations by the formulas of EN 13906."""

from math import exp, inf, isfinite, log10, pi, sqrt

import pytest
import yaml

from coilset.model.core.case.case import check as checked
from coilset.model.tools.checks.check import Check, Verdict, sentence
from coilset.model.tools.checks.permissible import hot_block_stress
from coilset.model.tools.checks.table import checks
from coilset.model.tools.sheet.from_results import of_steps

PULLED = """
spring: {wire_diameter: 1.2, outer_diameter: 12, turns: 18, initial_tension: 8, hooks: {bottom: {shape: german,
  length: 18.6}, top: {shape: german, length: 18.6}}}
material: {wire: EN 10270-1 SH}
ends: clamped
loading: [{to: {force: -35}}, {to: {force: 0}}]
working: {lengths: [75, 90]}
"""
TURNED = """
spring: {wire_diameter: 2.0, inner_diameter: 14, turns: 6.25, pitch: 2.2, arms: {bottom: {length: 30.0},
  top: {length: 30.0}}}
material: {wire: EN 10270-1 SH}
ends: clamped
heads: {top: {sideways: free}}
contact: {arbor: 12.0}
loading: [{to: {force: 0, top: {turn: 90}}}, {to: {force: 0, top: {torque: 0}}}]
"""
VALVE = """
spring: {wire_diameter: 4.0, outer_diameter: 32, turns: 8, pitch: {turns: [0, 3, 5, 8], values: [6.5, 6.5, 8.5, 8.5],
  interpolation: linear}, end_coils: closed and ground}
material: {wire: EN 10270-2 VDSiCr}
temperature: 423.15
ends: seats
loading: [{to: block}, {to: {force: 0}}]
working: {lengths: [46, 38]}
"""
DIE = """
spring: {wire: {rectangle: {width: 5.0, height: 3.0, corner: 0.4}}, outer_diameter: 25, turns: 8, free_length: 51,
  end_coils: closed and ground}
material: {wire: EN 10270-2 VDSiCr}
ends: seats
loading: [{to: {travel: 15}}, {to: {force: 0}}]
working: {lengths: [43, 36]}
"""
CONE = """
spring: {wire_diameter: 0.5, outer_diameter: {shape: cone, bottom: 9, top: 4}, turns: 5, free_length: 12,
  end_coils: closed}
material: {wire: EN 10270-3 1.4310}
ends: seats
loading: [{to: block}, {to: {force: 0}}]
working: {lengths: [8, 4]}
"""
PLAIN = """
spring: {wire_diameter: 2.0, mean_diameter: 16, turns: 8, free_length: 46, end_coils: closed and ground}
material: {wire: EN 10270-1 SH}
ends: seats
loading: [{to: block}, {to: {force: 0}}]
working: {lengths: [34, 25]}
"""


def made(text, summary=None, **changes):
    """The checks of a case by their names, after changes of its entries."""
    case = yaml.safe_load(text)
    for place, value in changes.items():
        *path, last = place.split("__")
        entries = case
        for name in path:
            entries = entries[name]
        entries[last] = value
    read = checked(case)
    spring = read.spring.build()
    found = None if summary is None else of_steps(summary | {"free_length_before_mm": spring.free_length}, ())
    return {one.name: one for one in checks(read, spring, found)}


def working(*states):
    """Working states of a summary: lengths, mm, and forces, N."""
    return [{"length_wanted": length, "length_mm": length, "force_N": force, "reason": ""} for length, force in states]


def strength(d):
    """Rm of EN 10270-1 SH, MPa."""
    return 2230.0 - 820.0 * log10(d)


def test_a_cycle_of_an_extension_spring_is_judged_by_its_size(example):
    """The shipped spring from 150 to 180 mm: its upper stress is 9 MPa above the line, which is drawn for positive
    stresses."""
    text = (example.parent / "springs" / "extension.yaml").read_text(encoding="utf-8")
    one = made(text, working={"lengths": [150.0, 180.0]})["fatigue, τk2"]
    lg = log10(3.0)
    zero, limit, knee = 506.0 - 175.0 * lg, 1118.0 - 410.0 * lg, 832.0 - 322.0 * lg
    assert (zero, limit, knee) == pytest.approx((422.5, 922.4, 678.4), abs=0.1)
    lower = float(one.remark.split()[2])
    assert lower == pytest.approx(584.4, rel=0.02)
    assert one.value == pytest.approx(861.8, rel=0.02)
    assert one.high == pytest.approx(zero + (limit - zero) * lower / knee, abs=0.5)
    assert one.verdict is Verdict.NOT_PERMITTED
    assert one.reserve == pytest.approx(-9.0, abs=4.0)


def test_an_extension_spring_is_judged_in_its_hooks():
    """By the stress of the run there, 1233.7 MPa at 35 N, against 0.7 Rm: 1.23 times; the coils have 1.75."""
    run = {"force_max_N": -35.0, "tail_stress_max_MPa": 1233.7, "tail_stress_max_turn": 18.08}
    found = made(PULLED, run | {"working": working((75.0, -20.68), (90.0, -34.16))})
    hooks, coils = found["σ of the hooks at 35 N"], found["τ of the coils at 35 N"]
    assert hooks.value == 1233.7
    assert hooks.high == pytest.approx(0.7 * strength(1.2))
    assert hooks.high / hooks.value == pytest.approx(1.23, abs=0.005)
    assert coils.value == pytest.approx(8.0 * 10.8 * 35.0 / (pi * 1.2**3))
    assert coils.high == pytest.approx(0.45 * strength(1.2))
    assert not any("buckling" in name for name in found)
    torn = made(PULLED, run | {"tail_stress_max_MPa": 1600.0})
    assert torn["σ of the hooks at 35 N"].verdict is Verdict.NOT_PERMITTED


def test_coiling_reaches_so_much_initial_tension():
    """8 N are 127 MPa, more than is readily coiled with w = 9; 30 N are 477 MPa, three times what can be."""
    one = made(PULLED)["τ0 of the initial tension"]
    assert one.value == pytest.approx(8.0 * 10.8 * 8.0 / (pi * 1.2**3))
    assert one.high == pytest.approx(58.0 * 6.894757 * exp(-0.105 * 9.0))
    assert "readily coiled up to 121 MPa" in one.remark
    assert one.verdict is Verdict.PERMITTED
    much = made(PULLED, spring__initial_tension=30.0)["τ0 of the initial tension"]
    assert (round(much.value), much.verdict) == (477, Verdict.NOT_PERMITTED)


def test_a_torsion_spring_has_a_limit():
    """At 90° 0.7 Rm permits it, at 220° its wire has more than its strength: R of the coils with 60 mm of legs."""
    E, d, D, n = 206000.0, 2.0, 16.0, 6.25
    rate = 1.0 / (3667.0 * D * n / (E * d**4) + 60.0 / (E * pi * d**4 / 64.0) * 180.0 / pi)
    assert rate == pytest.approx(7.547, abs=1e-3)
    small, large = (
        made(TURNED, loading=[{"to": {"force": 0, "top": {"turn": turn}}}])[f"σ of the coils at {turn}°"]
        for turn in (90, 220)
    )
    for one, turn in ((small, 90.0), (large, 220.0)):
        assert one.value == pytest.approx(32.0 * rate * turn / (pi * d**3), rel=1e-2)
        assert one.high == pytest.approx(0.7 * strength(d))
    assert (small.verdict, large.verdict) == (Verdict.PERMITTED, Verdict.NOT_PERMITTED)
    assert large.value > strength(d)


def test_against_its_winding_the_inside_of_a_torsion_spring_counts():
    opened = made(TURNED, loading=[{"to": {"force": 0, "top": {"turn": -90}}}])
    (name,) = (name for name in opened if name.startswith("σq of the coils"))
    plain = made(TURNED)["σ of the coils at 90°"]
    w = 8.0
    assert opened[name].value / plain.value == pytest.approx((4.0 * w**2 - w - 1.0) / (4.0 * w * (w - 1.0)))


def test_coils_close_on_their_arbor():
    """D n/(n + α/360°) − d = 13.385 mm at 90°, 12 mm within it."""
    one = made(TURNED)["inner diameter on the arbor"]
    assert one.value == pytest.approx(16.0 * 6.25 / 6.5 - 2.0)
    assert one.reserve == pytest.approx(1.385, abs=1e-3)
    assert made(TURNED, contact__arbor=13.9)["inner diameter on the arbor"].verdict is Verdict.NOT_PERMITTED


def test_a_warm_spring_is_not_judged_by_the_strength_of_a_cold_one():
    """The valve spring at 150 °C. At solid it is cold: the last coil closes 4.5 mm of pitch with 521.5 N."""
    force = 79500.0 * 4.0**4 * 4.5 / (8.0 * 28.0**3)
    found = made(VALVE)
    solid = found["τ at solid"]
    assert force == pytest.approx(521.5, abs=0.1)
    assert solid.value == pytest.approx(8.0 * 28.0 * force / (pi * 4.0**3), rel=1e-3)
    assert solid.high == pytest.approx(0.56 * (2125.0 - 466.0 * log10(4.0)))
    assert solid.verdict is Verdict.PERMITTED
    loaded = found["τ at 38 mm"]
    assert loaded.verdict is Verdict.NOT_KNOWN
    assert "150 °C" in loaded.because
    assert found["temperature"].cells[1:] == ("permitted", "150", "≤ 246", "96")
    assert made(VALVE, temperature=523.15 - 50.0)["temperature"].verdict is Verdict.PERMITTED
    cold = made(VALVE, temperature=293.15)["τ at 38 mm"]
    assert cold.verdict is Verdict.PERMITTED
    unknown = [one for one in found.values() if one.verdict is Verdict.NOT_KNOWN]
    assert [one.name for one in unknown] == ["τ at 38 mm", "fatigue, τk2"]


def test_beyond_the_cold_limit_a_warm_spring_is_not_permitted():
    run = {"force_max_N": 1500.0, "working": working((46.0, 300.0), (38.0, 1400.0))}
    assert made(VALVE, run)["τ at 38 mm"].verdict is Verdict.NOT_PERMITTED


def test_rectangular_wire_has_its_own_modulus():
    """934.7 N at 36 mm, by the run; W = a b²/(3 + 1.8 b/a) of the rectangle with corners, which rounding lowers."""
    run = {"force_max_N": 934.7, "working": working((43.0, 493.0), (36.0, 934.7))}
    found = made(DIE, run)
    sharp = 0.5 * 20.0 * 934.7 / (5.0 * 3.0**2 / (3.0 + 1.8 * 3.0 / 5.0))
    assert sharp < found["τ at 36 mm"].value < 1.06 * sharp
    assert found["index D/d"].verdict is Verdict.PERMITTED  # 4, as the standard allows
    assert "its wire is not round" in found["tolerance"].because


def test_a_cone_is_judged_by_its_widest_active_coil():
    run = {"force_max_N": 21.0, "working": working((8.0, 2.01), (4.0, 5.47))}
    found = made(CONE, run)
    # of the mean diameters from 8.5 to 3.5 mm over 5 turns, from turn 1 on
    assert found["τ at 4 mm"].value == pytest.approx(8.0 * 7.5 * 5.47 / (pi * 0.5**3), rel=1e-6)
    assert found["shortest length"].low == pytest.approx(0.5)
    assert found["tolerance"].verdict is Verdict.NOT_KNOWN
    assert sum(one.verdict is Verdict.NOT_KNOWN for one in found.values()) <= 2


def test_gaps_and_solid_length_of_the_standard():
    """Lc = n_t d_max = 8 · 2.025, Sa = n (0.0015 D²/d + 0.1 d)."""
    found = made(PLAIN)
    assert found["shortest length"].low == pytest.approx(8.0 * 2.025)
    gaps = found["sum of gaps"]
    assert gaps.value == pytest.approx(25.0 - 16.2)
    assert gaps.low == pytest.approx(6.0 * (0.0015 * 16.0**2 / 2.0 + 0.2))
    near = made(PLAIN, working={"lengths": [34.0, 17.0]})
    assert (near["shortest length"].verdict, near["sum of gaps"].verdict) == (Verdict.PERMITTED, Verdict.NOT_PERMITTED)


def test_the_stress_at_solid_is_that_of_the_finished_spring():
    """2 mm of set of 31 mm to block take as much of the stress."""
    wound = made(PLAIN)["τ at solid"]
    after = made(PLAIN, {"force_max_N": 200.0, "free_length_after_mm": 44.0})["τ at solid"]
    assert after.value / wound.value == pytest.approx(29.0 / 31.0)
    assert f"as wound {wound.value:.4g}" in after.remark


@pytest.mark.parametrize(("tilting", "seating"), [((), 0.5), (("top",), 0.7), (("bottom", "top"), 1.0)])
def test_buckling_is_that_of_the_true_ends(tilting, seating):
    """Of a slender spring; s_K of EN 13906-1 with E and G of the wire."""
    seats = {"hold": "groove"} | {end: {"tilt": "free"} for end in tilting}
    found = made(PLAIN, spring__free_length=120.0, seats=seats, working={"lengths": [60.0]}, spring__turns=14.0)
    one = found["travel before buckling"]
    E, G, length = 206000.0, 81500.0, 120.0
    root = 1.0 - (1.0 - G / E) / (0.5 + G / E) * (pi * 16.0 / (seating * length)) ** 2
    assert one.high == pytest.approx(length * 0.5 / (1.0 - G / E) * (1.0 - sqrt(root)))
    assert one.value == pytest.approx(60.0)
    assert one.verdict is Verdict.NOT_PERMITTED
    assert f"ν = {seating:g}" in one.source
    assert not isfinite(made(PLAIN)["travel before buckling"].high)


@pytest.mark.parametrize(("diameter", "verdict"), [(8.0, "permitted"), (7.0, "not permitted"), (44.0, "not permitted")])
def test_the_index_of_cold_coiled_springs(diameter, verdict):
    """4 to 20 of EN 13906-1: 4, 3.5 and 22."""
    one = made(PLAIN, spring__mean_diameter=diameter)["index D/d"]
    assert (one.value, one.verdict.value) == (pytest.approx(diameter / 2.0), verdict)


@pytest.mark.parametrize(("height", "verdict"), [(65.0, Verdict.PERMITTED), (64.5, Verdict.NOT_PERMITTED)])
def test_the_stress_of_a_named_wire(height, verdict):
    """R = 81500 · 5⁴/(8 · 40³ · 2.5) = 39.79 N/mm, τ = 8 D R s/(π d³) = 32.43 s; 0.56 Rm = 927.8 N/mm² at 28.6 mm."""
    spring = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 35.4}
    one = made(PLAIN, spring=spring, ends="clamped", working={"lengths": [height]})[f"τ at {height:g} mm"]
    assert one.value == pytest.approx(32.43 * (93.5 - height), rel=1e-3)
    assert (one.high, one.verdict) == (pytest.approx(927.8, abs=0.1), verdict)


def test_american_wire_has_a_limit_of_the_corrected_stress():
    """Shigley's table 10-6: 45 % of Rm of music wire, between 1944 and 1979 MPa of its table at 2 mm."""
    one = made(PLAIN, material={"wire": "ASTM A228"})["τk at 25 mm"]
    rate = 80000.0 * 2.0**4 / (8.0 * 16.0**3 * 6.0)
    # moduli go by the diameter: 81 GPa up to 3.175 mm
    rate *= 81000.0 / 80000.0
    assert one.value == pytest.approx(8.5 / 7.25 * 8.0 * 16.0 * rate * 21.0 / (pi * 8.0), rel=1e-3)
    assert 0.45 * 1944.0 < one.high < 0.45 * 1979.0


def test_a_run_is_believed_before_a_formula():
    run = {"force_max_N": 300.0, "working": working((34.0, 60.0), (25.0, 120.0))}
    assert made(PLAIN, run)["τ at 25 mm"].value == pytest.approx(8.0 * 16.0 * 120.0 / (pi * 8.0))
    assert "as wound" in made(PLAIN)["τ at 25 mm"].remark


def test_hot_coiled_bar_has_limits_of_its_own():
    """28 mm of EN 10089, between 813.1 and 794.6 MPa of 25 and 30 mm."""
    assert hot_block_stress(28.0).stress == pytest.approx(813.1 - 0.6 * 18.5)
    assert hot_block_stress(5.0) is None


def test_a_limit_beyond_is_never_permitted_and_a_missing_one_never_known():
    assert Check("a", 1.0, high=1.0).verdict is Verdict.PERMITTED
    assert Check("a", 1.0 + 1e-6, high=1.0).verdict is Verdict.NOT_PERMITTED
    assert Check("a", 1.1, high=1.0, because="of heat").verdict is Verdict.NOT_PERMITTED
    assert Check("a", 0.9, high=1.0, because="of heat").verdict is Verdict.NOT_KNOWN
    assert Check("a", 0.9, because="nobody says").verdict is Verdict.NOT_KNOWN
    assert Check("a", 5.0, 4.0, 20.0).cells == ("a", "permitted", "5", "4 to 20", "1")
    assert Check("a", 5.0, high=inf, unit="mm").cells == ("a, mm", "permitted", "5", "≤ ∞", "∞")


def test_all_checks_in_a_sentence():
    good, bad, open_ = Check("a", 1.0, high=2.0), Check("b", 3.0, high=2.0), Check("c", because="no limit")
    assert sentence([good]) == "Permitted by all checks."
    assert sentence([good, bad, open_]) == "Not permitted: b. Not known: c. Permitted by all other checks."
    assert sentence([bad]) == "Not permitted: b."
