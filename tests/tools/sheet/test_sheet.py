"""The sheet of a spring: the printed sheet of another program, what a run found beside it, and the command."""

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.tools.checks.table import checks
from coilset.model.tools.sheet import from_results
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.rows import sections
from coilset.model.tools.sheet.sheet import Sheet
from coilset.model.tools.standards import en15800, goodman
from coilset.model.tools.standards.cylinder import Cylinder
from coilset.model.tools.wires import names, wire
from coilset.scripts.commands.sheet import Options, list_wires, sheet

# HeliSpring, spring S.198: wire DM of 5 mm, De 39.6, n 9.5, n_t 11.5, L0 105.8, 280 N at 88.5 mm, 620 N at 67.5 mm
PRINTED = Cylinder(5.0, 34.6, 11.5, 9.5, 105.8, 9.547, "closed and ground", 57.5)
DM = wire("EN 10270-1 DM")
SPRING = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=2.5, pitch=12.0).build()


def rows(made):
    return {row.label.strip(): row for _, part in sections(made) for row in part}


def test_printed_sheet_of_another_program():
    made = Sheet(PRINTED, DM.elastic(5.0), 1260.0, DM, (88.5, 67.5), dynamic=True)
    shown = rows(made)
    assert shown["spring index w"].value == pytest.approx(6.92)
    assert shown["minimum tensile strength Rm"].value == pytest.approx(1460, abs=5)
    assert shown["rate R"].value == pytest.approx(16.181, abs=5e-4)
    assert shown["force at 88.5 mm"].value == pytest.approx(280, abs=0.1)
    assert shown["force at 67.5 mm"].value == pytest.approx(620, abs=0.4)
    assert shown["minimum sum of gaps Sa"].value == pytest.approx(12.3, abs=0.06)
    assert shown["block length Lc"].value == pytest.approx(11.5 * 5.035)  # d_max with the tolerance of EN 10270-1
    # τ = 8 · 34.6 · 280/(π 125) = 197.4, k = 7.42/6.17
    assert shown["lower stress τk1"].value == pytest.approx(1.2026 * 197.4, rel=1e-3)
    assert shown["permissible stress range"].value is None  # no endurance of DM is known
    assert all(row.sure or row.value is None for row in shown.values())


FIBRES = ("s11", "t12", "t13", "B11", "B12", "B13", "b")
WARPING = ("s11", "s22", "s33", "t12", "t13", "t23", "B11", "B22", "B33", "B12", "B13", "B23", "b")


def run_folder(folder, residual=-60.0, components=FIBRES):
    """A results folder with a spring that was pressed to 60 mm and released to 100 mm, as `coilset solve` writes it."""
    folder.mkdir()
    summary = {
        "free_length_before_mm": 105.8,
        "free_length_after_mm": 100.0,
        "set_mm": 5.8,
        "rate_N_per_mm": 16.0,
        "force_max_N": 700.0,
        "shear_max_MPa": 500.0,
        "block_height_mm": 57.5,
        "material": "steel",
    }
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    history = "seat_height_mm,force_N\n80,400\n60,700\n80,350\n100,0\n"
    (folder / "history.csv").write_text(history, encoding="utf-8")
    # two snapshots, 46 elements, one Gauss section, a ring of four points at 0.9 of a wire of radius 2.5
    angle = np.arange(4) * np.pi / 2
    y, z = (np.broadcast_to(2.25 * one, (46, 1, 4)) for one in (np.cos(angle), np.sin(angle)))
    of_points = ("element", "gauss", "point")
    state, (t12, t13) = np.zeros((2, 46, 1, 4, len(components))), map(components.index, ("t12", "t13"))
    for i, shear in enumerate((-400.0, -residual)):  # about the axis; the load's is negative here
        state[i, ..., t12], state[i, ..., t13] = -shear * np.sin(angle), shear * np.cos(angle)
    state[:, [0, -1]] = 1e3  # the ends do not count
    turn = np.linspace(0, 11.5, 47)
    radius = np.array([17.3, 17.4])[:, None] + np.where(np.abs(turn - 5.75) > 4, 1.0, 0.0) * [[0], [1]]
    moved = np.array([0.0, 2.0])[:, None]  # sideways, as a whole
    position = np.stack([moved + radius * np.cos(2 * np.pi * turn), radius * np.sin(2 * np.pi * turn), 0 * radius], -1)
    xr.Dataset(
        {
            "point_state": (("snapshot", "element", "gauss", "point", "component"), state),
            "y": (of_points, y),
            "z": (of_points, z),
            "force": ("snapshot", [700.0, 0.0]),
            "height": ("snapshot", [105.8, 60.0]),
            "position": (("snapshot", "station", "axis"), position),
            "weight": (of_points, np.full((46, 1, 4), 0.25 * 0.5 / 0.9**2)),
        },
        coords={"turn": ("station", turn), "component": list(components)},
    ).to_netcdf(folder / "points.nc", engine="h5netcdf")
    return folder


@pytest.mark.parametrize("components", [FIBRES, WARPING], ids=["fibres", "warping"])
def test_what_a_run_found(tmp_path, components):
    run = from_results.read(run_folder(tmp_path / "run", components=components))
    assert run.residual == pytest.approx(-60.0)
    assert run.ring == pytest.approx(0.9)
    assert run.growth == pytest.approx(0.2)
    assert run.force_at(90.0) == pytest.approx(175.0)  # on release, the last time it passed
    assert run.force_at(103.0) == pytest.approx(400 * 2.8 / 25.8)  # only on the way down
    assert run.force_at(50.0) is None
    assert run.force_at(60.0 - 1e-12) == run.force_at(60.0) == 700.0  # a length that was computed
    heights, forces = np.append(run.heights[:3], [60.0, 60.0]), np.append(run.forces[:3], [680.0, 650.0])
    held = replace(run, heights=heights, forces=forces)
    assert held.force_at(60.0) == 650.0  # what the hold has left
    assert run.work_to(80.0) == pytest.approx(0.5 * 400 * 25.8)
    assert run.work_to(55.0) is None


def test_values_that_were_found_stand_beside_the_formulas(tmp_path):
    run = from_results.read(run_folder(tmp_path / "run"))
    shown = rows(Sheet(PRINTED, DM.elastic(5.0), 1260.0, wire("EN 10270-1 DH"), (88.5, 67.5), found=run))
    assert shown["rate R"].found == 16.0
    assert shown["free length L0"].found == 100.0
    assert shown["force at 67.5 mm"].found == pytest.approx(700 - 350 * 7.5 / 20)
    assert shown["force at 67.5 mm"].why == "after setting R (L0 − L) is 525.9 N"
    # of the finished spring's force, as on the drawing; it was that of the spring as wound
    spread = en15800.force_tolerance(2, 5.0, 34.6, 9.5, 568.75)
    assert shown["force at 67.5 mm ±"].value == pytest.approx(spread)
    assert shown["wire length l"].found == 1260.0
    assert shown["force at block Fc"].found is None  # it was not pressed to block
    assert shown["growth of D to block"].found is None
    # ½ √(R/m), m of 9.5 of 11.5 turns of 1260 mm: 16 N/mm, 7.85e-6 · π 5²/4 · 1040.9 mm = 0.16044 kg
    assert shown["natural frequency"].found == pytest.approx(0.5 * np.sqrt(16e3 / 0.16044), rel=1e-4)
    assert shown["natural frequency"].why == "½ √(R/m) with the rate R found at first touch and the helix's mass"
    finished = replace(run, summary=run.summary | {"rate_30_70_after_N_per_mm": 17.0})
    after = rows(Sheet(PRINTED, DM.elastic(5.0), 1260.0, wire("EN 10270-1 DH"), (88.5, 67.5), found=finished))
    assert after["rate R"].found == 17.0
    assert after["natural frequency"].found == pytest.approx(0.5 * np.sqrt(17e3 / 0.16044), rel=1e-4)
    assert "R found of the finished spring" in after["natural frequency"].why
    assert shown["travel to buckling"].found is None
    endured = shown["permissible stress range"]
    line = goodman.line(wire("EN 10270-1 DH").endurance(), 5.0)
    assert endured.value == pytest.approx(line.stress_range(shown["lower stress τk1"].value))
    assert endured.found == pytest.approx(line.stress_range(shown["lower stress τk1"].value - 60.0))
    assert endured.found > endured.value
    assert "preset springs" in endured.formula
    assert endured.why.endswith("the line is of preset springs, so it may count twice")


def test_forces_beside_the_formulas_of_a_pull_are_those_of_the_first_or_of_the_finished_spring(tmp_path):
    """Pulled to 120 mm, on to 140 mm, and released: at 120 mm 250 N on the first pull, 150 N on the way back."""
    run = from_results.read(run_folder(tmp_path / "run"))
    run = replace(
        run,
        heights=np.array([105.8, 120.0, 140.0, 120.0, 110.0]),
        forces=-np.array([0.0, 250.0, 400.0, 150.0, 0.0]),
    )
    made = Sheet(PRINTED, DM.elastic(5.0), 1260.0, DM, (120.0, 130.0), found=run, pulled=True)
    shown = rows(made)
    assert (shown["force at 120 mm"].found, shown["force at 120 mm"].why) == (250.0, "first pull")
    assert shown["force at 130 mm"].found == pytest.approx(325.0)
    working = {"length_wanted": 120.0, "reason": "", "force_N": -148.0}
    finished = replace(run, summary=run.summary | {"working": [working]})
    shown = rows(replace(made, found=finished))
    assert (shown["force at 120 mm"].found, shown["force at 120 mm"].why) == (148.0, "of the finished spring")
    assert (shown["force at 130 mm"].found, shown["force at 130 mm"].why) == (pytest.approx(325.0), "first pull")


def pressed_to_block(folder, force, **entries):
    """A run that ends at block under a force; entries of its summary."""
    run = from_results.read(run_folder(folder))
    heights, forces = np.append(run.heights, 57.5), np.append(run.forces, force)
    return replace(run, heights=heights, forces=forces, summary=run.summary | entries)


def test_stress_at_block_is_that_of_the_formula_also_beside_a_run(tmp_path):
    """Coils that lie on each other carry 8000 N past the wire; R s is 782 N."""
    run = pressed_to_block(tmp_path / "run", 8000.0, force_max_N=8000.0)
    alone = Sheet(PRINTED, DM.elastic(5.0), 1260.0, DM)
    beside = replace(alone, found=run)
    assert rows(beside)["force at block Fc"].found == 8000.0
    assert rows(beside)["stress τc"].found is None


def test_what_a_run_found_at_block_and_when_it_buckled(tmp_path):
    run = pressed_to_block(tmp_path / "run", 800.0, buckling_travel_mm=41.0)
    shown = rows(Sheet(PRINTED, DM.elastic(5.0), 1260.0, found=run))
    assert shown["force at block Fc"].found == 700.0  # of the summary
    assert shown["growth of D to block"].found == pytest.approx(0.2)
    assert shown["travel to buckling"].found == 41.0


def test_line_of_the_goodman_diagram():
    line = goodman.line(wire("EN 10270-1 SH").endurance("shot peened"), 10.0)
    # a − b lg 10
    assert (line.at_zero, line.knee, line.limit) == (601 - 193, 698 - 273, 1119 - 409)
    assert line.upper(0.0) == 408
    assert line.upper(425.0) == pytest.approx(710)
    assert line.upper(600.0) == 710
    assert line.stress_range(650.0) == 60
    assert line.stress_range(800.0) == 0
    assert line.times == "10⁷"
    assert line.tested == "preset springs"


CASE = """spring: {wire_diameter: 4.0, mean_diameter: 32.0, turns: 7.5, free_length: 60.0, end_coils: closed and ground}
material: elastic
loading:
  - {to: block}
  - {to: {height: 52.0}}
  - {to: {travel: 20.0}}
  - {to: {force: 0}}
"""


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(CASE, encoding="utf-8")
    return path


def test_command_prints_and_draws(case, tmp_path, capsys):
    sheet(case, Options(wire="EN 10270-1 SH", surface="shot peened", out=[tmp_path / "out"]))
    printed = capsys.readouterr().out
    assert "force at 52 mm" in printed  # the working lengths of the load program
    assert "force at 40 mm" in printed
    assert "972.33 MPa" in printed
    assert (tmp_path / "out" / "goodman.png").stat().st_size > 10_000
    with pytest.raises(InputError, match="already exists; use --overwrite"):
        sheet(case, Options(wire="EN 10270-1 SH", surface="shot peened", out=[tmp_path / "out"]))


@pytest.mark.parametrize(("least", "said"), [(60.0, False), (1.0, True)], ids=["above block", "at block"])
def test_a_set_is_held_against_presetting_where_the_run_was_at_block(case, tmp_path, capsys, least, said):
    folder = run_folder(tmp_path / "run")
    (folder / "summary.json").write_text(json.dumps({"free_length_before_mm": 105.8, "set_mm": 1.0}), encoding="utf-8")
    (folder / "history.csv").write_text(f"seat_height_mm,force_N\n{least},700\n104.8,0\n", encoding="utf-8")
    sheet(case, Options(folder, pictures=False))
    printed = capsys.readouterr().out
    assert re.search(r"^ +formula +run ", printed, re.MULTILINE)
    assert ("presetting takes 1 mm" in " ".join(printed.split())) == said


def run_of(folder, case, **entries):
    """A results folder of a run of a case, with some entries otherwise."""
    folder = run_folder(folder)
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    summary["origin"] = {"case": read_case(case).model_dump(mode="json") | entries}
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"turns": 9.0}, "spring.turns was 9, is 7.5 in the case; give"),
        ({"turns": 9.0, "hand": "left"}, "spring.turns was 9, is 7.5 in the case; spring.hand was left, is right in"),
        ({"pitch": 9.0, "free_length": None}, "spring.free_length was not given, is 60 in the case"),
    ],
)
def test_results_of_another_spring_are_refused(case, tmp_path, capsys, changes, said):
    folder = run_of(tmp_path / "run", case, spring=read_case(case).spring.model_dump(mode="json") | changes)
    with pytest.raises(InputError) as error:
        sheet(case, Options(folder, pictures=False))
    assert str(error.value).startswith(f"{folder}: --results: the run is of another spring: spring.")
    assert said in str(error.value)
    assert "\n" not in str(error.value)
    assert not capsys.readouterr().out


def test_a_run_of_the_case_itself_is_taken(example, tmp_path):
    """Whose arms have a list of bends without entries."""
    torsion = example.parent / "springs" / "torsion.yaml"
    sheet(torsion, Options(run_of(tmp_path / "run", torsion), pictures=False))


def test_another_load_program_is_named_before_the_rows(case, tmp_path, capsys):
    def printed(name, program):
        sheet(case, Options(run_of(tmp_path / name, case, loading=program), pictures=False))
        return " ".join(capsys.readouterr().out.split())

    same = read_case(case).model_dump(mode="json")["loading"]
    assert "another load program" not in printed("same", [phase | {"steps": 7} for phase in same])
    other = [same[0], {**same[1], "to": same[1]["to"] | {"height": 50.0}}, *same[2:]]
    before, _, _ = printed("other", other).partition("formula run")
    assert "is of another load program: loading.1.to.height was 50, is 52 in the case" in before
    shorter, _, _ = printed("shorter", same[:3]).partition("formula run")
    assert "loading.3 was not given, is {to: {force: 0}} in the case" in shorter


def test_a_case_without_a_load_program_has_a_sheet(case, tmp_path, capsys):
    """And is compared with a run of its spring, whatever that went through."""
    run = run_of(tmp_path / "run", case)
    case.write_text(CASE.partition("loading")[0], encoding="utf-8")
    sheet(case, Options(run, lengths=[52.0], pictures=False))
    printed = capsys.readouterr().out
    assert "force at 52 mm" in printed
    assert "another load program" not in printed


def test_command_draws_nothing_without_a_wire(case, tmp_path, capsys):
    sheet(case, Options(out=[tmp_path / "out"]))
    printed = " ".join(capsys.readouterr().out.split())
    assert "is not known; give tensile_strength in its file, or a wire by its name" in printed
    assert not (tmp_path / "out").exists()


def test_wires_are_listed(capsys):
    list_wires()
    assert "EN 10270-2 VDSiCr" in capsys.readouterr().out
    for name in names():
        list_wires(name)
        printed = capsys.readouterr().out
        for _, entry in wire(name).entry.sourced():
            assert wire(name).citation(entry) in printed
    list_wires("EN 10270-2 FDC")
    printed = capsys.readouterr().out
    assert "d = 0.5 to 17: 1834 − 488 lg d, at most 1900 MPa" in printed
    assert "0.56 Rm, uncorrected stress" in printed
    assert "1e+07 times, preset springs: upper stress 375 − 117 lg d over 0, 889 − 263 lg d" in printed
    assert "over 669 − 183 lg d MPa" in printed
    assert "not found: endurance of all wires of CrV, SiCr and SiCrV" in printed
    with pytest.raises(InputError, match="'copper' is not a known wire"):
        list_wires("copper")


def test_a_warm_spring_has_the_moduli_and_the_yield_stress_of_its_temperature(example):
    """`creeping` at 433.15 K: G = 79000 − 7900/2, k0² = (666666.67 + 426666.67)/2; 10 % less stiff at the end."""
    made = case_sheet(read_case(example, ["material=creeping", "temperature=433.15"]), SPRING, None)
    assert made.elastic.shear_modulus == pytest.approx(75050.0)
    assert made.rate == pytest.approx(75050.0 * 5.0**4 / (8 * 40.0**3 * 2.5))
    assert made.yield_stress == pytest.approx(np.sqrt(1.5 * 546666.67))
    with pytest.raises(InputError, match=r"^temperature: 600 K is outside the table of 'creeping'"):
        case_sheet(read_case(example, ["material=creeping", "temperature=600"]), SPRING, None)


@pytest.mark.parametrize(
    ("name", "temperature", "G", "loss"),
    [
        ("EN 10270-2 VDSiCr", 293.15, 79500, 0.0),
        ("EN 10270-2 VDSiCr", 423.15, 79500, 0.25e-3 * 130),
        ("EN 10270-3 1.4310", 473.15, 70000, 0.40e-3 * 180),
        ("EN 10270-1 SH", 233.15, 81500, -0.25e-3 * 60),
    ],
)
def test_a_warm_wire_has_the_moduli_of_its_temperature(example, name, temperature, G, loss, capsys, tmp_path):
    """By hand, G of 20 °C and the slope of the standard; the sheet had those of 20 °C at any temperature.

    Of the case's wire, and of one given by --wire; with the warning of a run that the strength is that of 20 °C.
    """
    rate = G * (1.0 - loss) * 5.0**4 / (8 * 40.0**3 * 2.5)
    settings = [f"material={{wire: {name}}}", f"temperature={temperature}"]
    made = case_sheet(read_case(example, settings), SPRING, None)
    assert made.rate == pytest.approx(rate)
    assert made.elastic.young_modulus == pytest.approx(wire(name).elastic(5.0).young_modulus * (1.0 - loss))
    other = ["material={wire: EN 10270-1 DH}", f"temperature={temperature}"]
    assert case_sheet(read_case(example, other), SPRING, None, name).rate == pytest.approx(rate)
    sheet(example, Options(settings=settings, out=[tmp_path], pictures=False))
    said = " ".join(capsys.readouterr().out.split())
    assert f"{rate:.5g} N/mm" in said
    assert ("the strength is that of 20 °C" in said) == (loss != 0.0)


@pytest.mark.parametrize(
    ("settings", "held"),
    [
        ([], True),
        (["ends=clamped"], True),
        (["seats={hold: groove}"], True),
        (["seats={hold: groove, top: {turn: free}}"], False),
    ],
)
def test_only_ends_that_are_free_to_turn_are_those_of_the_formula(example, settings, held):
    """Tips in pockets cannot turn: tan²α weighs ½ − ν in place of (1 − ν)/(2 (1 + ν))."""
    made = case_sheet(read_case(example, settings), SPRING, None)
    nu, tangent = made.elastic.young_modulus / (2 * made.elastic.shear_modulus) - 1, 12 / (40 * np.pi)
    weight = 0.5 - nu if held else (1 - nu) / (2 * (1 + nu))
    shown = rows(made)
    assert shown["R of a rising wire"].value == pytest.approx(made.rate / (1 + weight * tangent**2), rel=2e-5)
    assert shown["growth of D to block"].why.endswith(", these are held") == held


def test_wrong_questions(case, tmp_path):
    with pytest.raises(InputError, match=r"^--surface: 'peened' is no surface; give as coiled or shot peened$"):
        sheet(case, Options(surface="peened", out=[tmp_path / "out"]))
    with pytest.raises(InputError, match=r"--length: 20 mm is no working length; must be between the block length 28"):
        sheet(case, Options(lengths=[20.0], out=[tmp_path / "out"]))
    with pytest.raises(InputError, match=f"^{tmp_path}: holds no results of a run: there is no summary.json$"):
        sheet(case, Options(results=tmp_path, out=[tmp_path / "out"]))
    folder = run_folder(tmp_path / "run")
    (folder / "history.csv").unlink()
    with pytest.raises(InputError, match=f"^{folder}: holds no results of a run: there is no history.csv"):
        from_results.read(folder)
    (folder / "history.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(InputError, match="is not a result of coilset solve"):
        from_results.read(folder)
    shutil.rmtree(folder)


def test_a_pulled_spring_gets_no_rows_for_compression_springs(tmp_path):
    path = tmp_path / "pulled.yaml"
    path.write_text(
        "spring: {wire_diameter: 2, mean_diameter: 16, turns: 8, pitch: 2.04}\nmaterial: {wire: EN 10270-1 SH}\n"
        "ends: clamped\nloading: [{to: {travel: -20}}, {to: {force: 0}}]\n"
    )
    case = read_case(path)
    spring = case.spring.build()
    made = case_sheet(case, spring, None)
    assert [title for title, _ in sections(made)] == ["Dimensions", "Extension spring, EN 13906-2"]
    assert "block length Lc" not in rows(made)
    assert rows(made)["force at 38.32 mm"].value == pytest.approx(20.0 * made.rate, rel=1e-9)
    found = " ".join(one.name for one in checks(case, spring))
    assert not any(word in found for word in ("buckling", "gaps", "solid"))
