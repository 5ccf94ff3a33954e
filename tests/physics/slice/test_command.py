"""`coilset slice`: what it writes, its summary beside that of `solve`, and one line for what it refuses."""

import csv
import json
import math

import numpy as np
import pytest

from coilset.meshes.sections.shapes import Curve
from coilset.model.compose import summary as of_spring
from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.physics.slice.analysis import TOUCHING, SliceAnalysis
from coilset.model.tools.studies import slice_output as output
from coilset.model.tools.studies.slice_summary import UNSEEN, summarise
from coilset.scripts.commands.slice import slice_case
from coilset.verification.spring_references.yielding_ring import Ring, Steel, tube

SHORT = ["loading=[{to: {travel: 6}, steps: 3}, {to: {force: 0}, steps: 2}]", "ends=clamped"]


def test_files_and_summary(example, tmp_path):
    slice_case(example, tmp_path / "here", settings=SHORT, across=3.0)
    summary = json.loads((tmp_path / "here" / "summary.json").read_text())
    rows = list(csv.DictReader((tmp_path / "here" / "history.csv").read_text().splitlines()))
    assert [float(row["travel_mm"]) for row in rows[:3]] == pytest.approx([2, 4, 6], abs=1e-9)
    held = float(rows[-1]["travel_mm"])  # with the torque of ends that do not turn, which then goes
    assert 1e-6 < abs(summary["set_mm"] / held - 1.0) < 1e-2
    assert summary["turn_after"] != 1.0
    assert summary["force_max_N"] == pytest.approx(max(float(row["force_N"]) for row in rows), rel=1e-12)
    assert summary["complete"]
    assert summary["released"]["surface_shear_max_MPa"] == summary["residual_shear_max_MPa"]
    assert summary["shear_inside_max_MPa"] == -summary["loaded"]["shear_inside_MPa"] > 0  # as of a spring's run
    assert summary["residual_shear_inside_MPa"] == -summary["released"]["shear_inside_MPa"] < 0
    assert (tmp_path / "here" / "section.png").read_bytes().startswith(b"\x89PNG")
    assert len(list((tmp_path / "here" / "fields").glob("*.vtu"))) == 3
    with pytest.raises(InputError, match="--overwrite"):
        slice_case(example, tmp_path / "here", settings=SHORT, across=3.0)
    slice_case(example, tmp_path / "here", force=True, settings=SHORT, across=3.0, pictures=False)
    assert not (tmp_path / "here" / "section.png").exists()


@pytest.mark.parametrize(("material", "maps"), [("elastic", 2), ("ck15", 4)])
def test_the_rounding_that_is_left_in_an_elastic_section_is_not_drawn(example, tmp_path, monkeypatch, material, maps):
    """Its 1e-6 MPa after the release had all colours."""
    drawn = []
    monkeypatch.setattr(output, "save", lambda sheet, path: drawn.append(sheet))
    slice_case(example, tmp_path, settings=[*SHORT, f"material={material}"], across=3.0)
    (sheet,) = drawn
    assert sum(axes.get_ylabel() == "upward, η in mm" for axes in sheet.axes) == maps
    assert ("at force 0 N no stress remains" in sheet.get_suptitle()) == (material == "elastic")


def test_an_interrupted_picture_leaves_all_numbers(example, tmp_path, monkeypatch):
    def interrupt(*_args):
        raise KeyboardInterrupt

    monkeypatch.setattr(output, "figure", interrupt)
    with pytest.raises(KeyboardInterrupt):
        slice_case(example, tmp_path, settings=SHORT, across=3.0)
    assert json.loads((tmp_path / "summary.json").read_text())["complete"]


def test_summary_has_the_entries_of_a_springs_run(example):
    settings = [
        "loading=[{to: {travel: 1}, steps: 1}, {to: {force: 0}, steps: 1}]",
        "ends=clamped",
        "mesh.elements_per_turn=8",
        "material=elastic",
    ]
    case = read_case(example, settings)
    spring, coil = Analysis(case), SliceAnalysis(case, across=3.0)
    spring.run()
    coil.run()
    theirs, ours = of_spring.summarise(spring.setup, spring.result), summarise(coil)
    assert set(UNSEEN) < set(theirs) <= set(ours)
    for entry in ("free_length_before_mm", "block_height_mm", "steps", "material", "ends"):
        assert ours[entry] == theirs[entry]
    # the rod's chords of 8 in a turn and its plane section: 1 % in the rate
    assert ours["rate_N_per_mm"] == pytest.approx(theirs["rate_N_per_mm"], rel=0.02)
    assert ours["inside_factor"] == pytest.approx(1.16, abs=0.02)
    assert abs(ours["set_mm"]) < 1e-6


def test_block_is_where_the_coils_touch(example):
    coil = SliceAnalysis(read_case(example, ["loading=[{to: block, steps: 4}]"]))
    steps = coil.run().steps
    assert coil.problem.pressure.gap == pytest.approx(0.0, abs=1e-6)
    assert steps[-1].seat_height_mm > coil.spring.block_height  # by the wire's inclination
    assert steps[-1].seat_height_mm == pytest.approx(coil.spring.block_height, abs=0.05)
    assert steps[-1].force_N == max(step.force_N for step in steps)


def test_block_is_where_slanted_sides_touch(example):
    """A side at 45° is nearer to the next coil than its height over it; only many approaches close the gap."""
    diamond = Curve(np.array([(0, -2.5), (2.5, 0), (0, 2.5), (-2.5, 0)]))
    coil = SliceAnalysis(read_case(example, ["loading=[{to: block, steps: 2}]"]), diamond, across=3.0)
    coil.run()
    assert 0.0 <= coil.problem.pressure.gap <= TOUCHING * coil.wire_diameter


def test_the_tubes_of_a_slice_and_of_a_ring_twist_alike(tmp_path):
    """A coil of nearly no pitch; the line across the section leaves its hole out."""
    spring = {"wire": {"tube": {"outer": 4.0, "inner": 2.4}}, "mean_diameter": 40.0, "turns": 4.0, "pitch": 4.1}
    data = {
        "spring": spring,
        "material": "elastic",
        "ends": "clamped",
        "loading": [{"to": {"travel": 0.1}, "steps": 1}],
    }
    coil = SliceAnalysis(check(data))
    ring = Ring(20.0, tube(4.0, 2.4), Steel(coil.law.G, lambda strain: (np.full_like(strain, 1e9), strain)), (2, 8))
    ring.go_to(1e-3)
    assert 4.0 * coil.run().rate == pytest.approx(ring.force / ring.travel, rel=2e-3)
    assert np.abs(coil.line.places[:, 0]).min() >= 1.2
    output.figure(tmp_path / "tube.png", coil)


@pytest.mark.parametrize("keep", ["height", "force"])
def test_time_passes_as_in_the_rod(keep):
    """A coil without ends loses and creeps as one of four turns does; the travels by creep differ by 2.05 %.

    Heated, the coil's rate G d⁴/(8 D³ n) grows with its dimensions, as 1 + α ΔT. The rod's falls as (1 + α ΔT)⁻²: it
    keeps the wire's diameter, and the length to which its twist refers.
    """
    loading = (
        "loading=[{to: {force: 300}, steps: 3}, {heat: {to: 373.15, minutes: 20}, steps: 3}, "
        f"{{hold: {{hours: 100, keep: {keep}}}, steps: 8}}]"
    )
    slender = ["spring.mean_diameter=60", "spring.turns=4", "mesh.elements_per_turn=16", "mesh.section.angular=16"]
    case = read_case(EXAMPLES / "time" / "relaxation.yaml", [loading, *slender])
    coil, spring = SliceAnalysis(case), Analysis(case)
    ours, theirs = coil.run().steps, spring.run().steps
    assert [step.hours for step in ours] == pytest.approx([step.hours for step in theirs], rel=1e-12)
    assert [step.temperature_K for step in ours] == pytest.approx([step.temperature_K for step in theirs], rel=1e-12)
    growth = 1.0 + spring.rod.law.thermal_strain(293.15, 373.15)
    ratios = [steps[5].force_N / steps[2].force_N for steps in (ours, theirs)]
    assert ratios[0] == pytest.approx(ratios[1] * growth**3, rel=1e-4)
    if keep == "height":
        assert ours[2].load_loss_percent is None
        lost = [1.0 - steps[-1].force_N / steps[5].force_N for steps in (ours, theirs)]
        assert lost[0] == pytest.approx(lost[1], rel=0.02)
        assert lost[0] > 0.01
        whole = 100.0 * (1.0 - ours[-1].force_N / ours[2].force_N)  # of both phases, as in the rod
        assert summarise(coil)["load_loss_percent"] == ours[-1].load_loss_percent == pytest.approx(whole)
    else:
        crept = [steps[-1].travel_mm - steps[5].travel_mm for steps in (ours, theirs)]
        assert crept[0] == pytest.approx(crept[1], rel=0.025)
        assert crept[0] > 0.01


@pytest.mark.parametrize(
    ("settings", "section", "problem"),
    [
        (["spring.mean_diameter={shape: cone, bottom: 40, top: 50}"], None, "spring.mean_diameter: 40.*cylindrical"),
        (["spring.end_coils=closed", "spring.turns=6"], None, "spring.pitch: .*leave end_coils out"),
        (["loading=[{to: {height: 17}}]"], None, "loading.0.to: .*below block"),
        (["loading=[{to: {travel: 30}}]"], None, "loading.0.to: .*below block"),
        (
            ["heat={conductivity: 50}", "loading=[{to: {travel: 1}, seconds: 2}]"],
            None,
            "heat: no heat flows",
        ),
        ([], "oval:4:6", "spring.wire_diameter: 5 mm, but the section is 6 mm high"),
        (
            ["spring.outer_diameter={shape: cone, bottom: 45, top: 55}", "spring.mean_diameter=null"],
            None,
            "ck15_presetting.yaml: spring.outer_diameter: .*cylindrical",
        ),
        ([], "ring", "^--section: 'ring' is not a section"),
        ([], "round:0", "^--section: diameter: 0 mm is not possible"),
        ([], "rectangle:4:5:3", "^--section: corner: 3 mm is more than the sides allow"),
        ([], "rectangle:60:5", "ck15_presetting.yaml: spring.mean_diameter: .*reaches 30 mm inwards"),
        (["material=none"], None, "material"),
        (["seats={hold: groove, top: {turn: 100}}"], None, "seats.top.turn"),
    ],
)
def test_what_it_refuses(example, tmp_path, settings, section, problem):
    with pytest.raises(InputError, match=problem) as caught:
        slice_case(example, tmp_path / "here", settings=settings, section=section)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 2
    assert not (tmp_path / "here").exists()


def test_a_slice_from_python_goes_no_further_than_block(example):
    with pytest.raises(InputError, match=r"^loading\.0\.to: .*below block"):
        SliceAnalysis(read_case(example, ["loading=[{to: {height: 17}}]"]), across=3.0)


@pytest.mark.parametrize("across", [0.5, 1000.0, math.nan])
def test_too_few_or_too_many_triangles_are_the_options_fault(example, tmp_path, across):
    with pytest.raises(InputError, match=rf"^--across: {across:g} is not possible; give 1 to 100 "):
        slice_case(example, tmp_path / "here", across=across)
    assert not (tmp_path / "here").exists()


def test_the_name_of_the_folder_is_printed_as_it_is(example, tmp_path, capsys):
    slice_case(example, tmp_path / "[bold]x", settings=SHORT, across=3.0, pictures=False)
    assert f"results in {tmp_path / '[bold]x'}" in capsys.readouterr().out


WIDE_BELOW = "-2.5,-2.5\n2.5,-2.5\n0,2.5\n"


def test_stress_is_looked_at_within_the_section(example, tmp_path):
    """At η = 0 a triangle is half as wide as at its base: its surface there is at the inside and the outside."""
    path = tmp_path / "triangle.csv"
    path.write_text(WIDE_BELOW)
    slice_case(example, tmp_path / "here", settings=SHORT, across=3.0, section=str(path), pictures=False)
    summary = json.loads((tmp_path / "here" / "summary.json").read_text())
    for moment in ("loaded", "released"):
        for name in ("shear", "equivalent_stress"):
            ξ, η = summary[moment][f"surface_{name}_max_at_mm"]
            assert abs(ξ) <= 0.5 * (2.5 - η) + 1e-9


def test_a_section_beside_its_centre_line_is_refused(example, tmp_path):
    path = tmp_path / "high.csv"
    path.write_text("-2.5,1\n2.5,1\n2.5,6\n-2.5,6\n")
    with pytest.raises(InputError, match=r"^--section: points: the section lies at η = 1 to 6 mm"):
        slice_case(example, tmp_path / "here", section=str(path))
