"""Springs of wire that is not round: a round one as an outline, hands, and the examples."""

import json
from pathlib import Path

import pytest

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import check, read_case
from coilset.model.tools.sheet.case_sheet import case_sheet

SPRINGS = Path(__file__).parents[2] / "examples" / "springs"
SMALL = ["mesh.elements_per_turn=8", "accuracy=none"]


def force(wire, **entries):
    """At a travel of 6 mm, N, far beyond yield, of a cylinder between seats."""
    spring = {"mean_diameter": 32.0, "turns": 3.0, "pitch": 9.0, **wire, **entries}
    mesh, steps = {"elements_per_turn": 8}, {"to": {"travel": 6.0}, "steps": 4}
    return Analysis(check({"spring": spring, "mesh": mesh, "accuracy": "none", "loading": [steps]})).run()


def test_a_disk_drawn_as_an_ellipse():
    """Polynomials of degree 6 in place of the disk's closed warping; the points are the same."""
    drawn = force({"wire": {"oval": {"width": 5.0, "height": 5.0}}})
    assert drawn.steps[-1].force_N == pytest.approx(force({"wire_diameter": 5.0}).steps[-1].force_N, rel=1e-3)


def test_a_left_handed_spring_of_turned_wire_is_the_mirror_image():
    """An egg turned by 10°: what is up stays up, though the binormal of a left-handed coil points down."""
    wire = {"wire": {"egg": {"inside": 2.5, "outside": 1.5, "distance": 1.6}, "angle": 10.0}}
    left, right = (force(wire, hand=hand).steps[-1].force_N for hand in ("left", "right"))
    assert left == pytest.approx(right, rel=1e-6)


def test_the_die_spring_has_the_rate_of_its_sheet():
    """R = 4 G J/(π D³ n) holds for a straight wire: D/width = 4 makes it stiffer, touching ends softer."""
    steps = "loading=[{to: {travel: 1.0}, steps: 2}]"
    case = read_case(SPRINGS / "die_spring.yaml", [*SMALL, steps])
    one, two = Analysis(case).run().steps
    rate = (two.force_N - one.force_N) / (two.travel_mm - one.travel_mm)
    assert rate == pytest.approx(case_sheet(case, case.spring.build(), None).rate, rel=0.1)


def test_the_valve_spring_goes_to_block():
    """Its coils stand on each other one by one: the rate grows, and the last step is at block."""
    steps = "loading=[{to: block, steps: 8}]"
    case = read_case(SPRINGS / "ovate_valve.yaml", [*SMALL, steps])
    spring = case.spring.build()
    found = Analysis(case).run()
    forces = [step.force_N for step in found.steps]
    assert found.steps[-1].seat_height_mm == pytest.approx(spring.block_height, abs=1e-6)
    assert forces[1] - forces[0] < 0.9 * (forces[-2] - forces[-3])
    assert found.steps[-1].penetration_mm < 0.06


def test_a_tube_beyond_yield_is_within_the_stated_error(tmp_path):
    """138.5 N by a ring's tube over its disk of the same diameter, 0.8085, times the spring of that disk."""
    law = {"law": "voce", "yield_stress": 400.0, "rise": 300.0, "rate": 40.0}
    point = {"temperature": 293.15, "elasticity": {"G": 79230.769, "nu": 0.3}, "isotropic": law}
    steel = {"name": "steel", "description": "made up", "source": "made up", "units": "N, mm, K"}
    steel["validity"] = {"plastic_work": 2000.0, "remark": "none"}
    steel["temperatures"] = [point | {"kinematic": "none", "non_normality": "none"}]
    (tmp_path / "steel.yaml").write_text(json.dumps(steel))
    data = {
        "spring": {"wire": {"tube": {"outer": 4.0, "inner": 2.4}}, "mean_diameter": 40.0, "turns": 4.0, "pitch": 10.0},
        "material": str(tmp_path / "steel.yaml"),
        "ends": "clamped",
        "release": "held",
        "loading": [{"to": {"travel": 19.336}}, {"to": {"force": 0}}],
    }

    def pressed(kind):
        analysis = Analysis(check(data | {"mesh": {"section": {"kind": kind}}}))
        return summarise(analysis.setup, analysis.run())

    free, curved = pressed("warping"), pressed("curved")
    assert 138.4 < free["force_max_N"] < 138.8
    assert free["set_mm"] >= 3.21
    assert abs(curved["force_max_N"] - free["force_max_N"]) < curved["estimated_force_error_N"] < 5.0
    assert abs(curved["set_mm"] - free["set_mm"]) < curved["estimated_set_error_mm"] < 0.5
