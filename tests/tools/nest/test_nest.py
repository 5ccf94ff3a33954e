"""Nested springs: their forces add up at common heights, their room is that of the growing coils, and wrong nests."""

import csv
import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.case.case import check
from coilset.model.core.results.records.labels import within
from coilset.model.core.results.records.record import Errors
from coilset.model.tools.nest.file import Press, read_nest
from coilset.model.tools.nest.nest import Member, Pressed, press
from coilset.model.tools.nest.output import COLUMNS
from coilset.model.tools.nest.plan import plan
from coilset.scripts.commands.nest import nest as nest_command

OUTER = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 14.0}
INNER = {"wire_diameter": 3.0, "mean_diameter": 24.0, "turns": 3.5, "pitch": 8.0, "hand": "left"}
COMMON = {
    "material": "elastic",
    "mesh": {"elements_per_turn": 12, "section": {"radial": 2, "angular": 8}},
    "loading": [{"to": "block"}],
}
LOADING = [{"to": {"height": 30.0}, "steps": 4}, {"to": {"height": 33.0}, "steps": 1}]
REPOSITORY = Path(__file__).resolve().parents[3]


def write(folder, outer=None, inner=None, loading=LOADING, **common):
    for name, spring in (("outer", OUTER | (outer or {})), ("inner", INNER | (inner or {}))):
        case = COMMON | common | {"spring": spring}
        del case["loading"]  # a nest has its own
        (folder / f"{name}.yaml").write_text(yaml.safe_dump(case), encoding="utf-8")
    members = {name: {"case": f"{name}.yaml"} for name in ("outer", "inner")}
    (folder / "nest.yaml").write_text(yaml.safe_dump(members | {"loading": loading}), encoding="utf-8")
    return folder / "nest.yaml"


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    return press(read_nest(write(tmp_path_factory.mktemp("nest"))))


def test_forces_are_those_of_each_spring_alone(pressed):
    """At the same heights; the inner spring, shorter by 9 mm, bears none before they come to it."""
    heights = pressed.plan.heights
    lengths = [member.setup.spring.free_length for member in pressed.members]
    assert heights[0] == max(lengths) == lengths[0]
    assert heights[4:] == pytest.approx([30.0, 33.0])
    for spring, length, forces in zip((OUTER, INNER), lengths, pressed.forces, strict=True):
        loading = [{"to": {"height": float(h)}, "steps": 1} for h in heights[1:] if h < length]
        alone = Analysis(check(COMMON | {"spring": spring, "loading": loading})).run()
        assert forces[heights >= length] == pytest.approx(0.0, abs=1e-6)
        assert forces[heights < length] == pytest.approx([step.force_N for step in alone.steps], rel=1e-7)
    assert (pressed.forces[1] == 0.0).sum() >= 4
    assert pressed.force == pytest.approx(pressed.forces[0] + pressed.forces[1])
    assert pressed.free_length_after == pytest.approx(heights[0], abs=1e-6)  # elastic
    assert not pressed.warnings


def test_room_is_no_more_than_the_distance_of_the_wires(pressed):
    """From (40 − 5)/2 − (24 + 3)/2 mm on; the distance between all stations of the one and of the other, less radii."""
    assert pressed.clearance[0] == pytest.approx(4.0, abs=1e-9)
    outer, inner = pressed.members
    wires = outer.result.frames[3].x, inner.result.frames[0].x  # at 30 mm, which the inner spring's first step reaches
    assert [float(np.ptp(x[:, 2])) for x in wires] == pytest.approx([25.0, 27.0], abs=0.1)
    apart = np.linalg.norm(wires[0][:, None] - wires[1][None], axis=-1).min() - 0.5 * (5.0 + 3.0)
    assert 3.5 < pressed.clearance[4] <= apart + 1e-9


def test_springs_that_set_are_let_go_each_to_its_own_length(tmp_path):
    found = press(read_nest(write(tmp_path, loading=[{"to": "block", "steps": 5}], material="ck15")))
    assert found.plan.heights[-1] == pytest.approx(max(m.setup.spring.block_height for m in found.members))
    lengths = []
    for member in found.members:
        assert member.result.steps[-1].force_N == pytest.approx(0.0, abs=1e-6)
        lengths.append(member.setup.outer_length(member.result.snapshots[-1].x))
        assert lengths[-1] < member.setup.spring.free_length - 1.0
    assert found.free_length_after == max(lengths)


def member(length, *errors):
    """A spring that was let go at a length, with errors of force and set."""
    shot = SimpleNamespace(x=None)
    of_run = SimpleNamespace(total=Errors(*errors, None)) if errors else None
    result = SimpleNamespace(complete=True, snapshots=[shot], errors=of_run)
    setup = SimpleNamespace(outer_length=lambda _: length)
    return Member("", None, None, setup, result)


def test_errors_of_a_nest_are_those_of_both_springs():
    """The shorter one may be the longer one within its error; forces add up."""

    def of(*members):
        return Pressed(SimpleNamespace(), members, np.zeros((2, 1)), np.zeros(1), ())

    nest = of(member(39.0, 60.0, 2.0), member(30.0, 0.5, 0.25))
    assert (nest.force_error, nest.set_error) == (60.5, 2.0)
    assert of(member(39.0, 60.0, 2.0), member(38.5, 0.5, 4.0)).set_error == pytest.approx(3.5)
    unknown = of(member(39.0), member(30.0, 0.5, 0.25))
    assert (unknown.force_error, unknown.set_error) == (None, None)


def test_the_table_has_the_errors(tmp_path, capsys):
    """As coilset solve prints them, here of two coarse meshes."""
    pressed_far = write(tmp_path, material="ck15", loading=[{"to": {"height": 20.0}, "steps": 4}])
    nest_command(pressed_far, tmp_path / "out", False, False)
    found = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    printed = capsys.readouterr().out
    assert within(found["set_mm"], found["estimated_set_error_mm"], "mm", 4) in printed
    assert within(found["force_max_N"], found["estimated_force_error_N"], "N", 2) in printed
    assert re.search(r"set +[\d.]+ ± [\d.]+ mm", printed)


def test_heights_of_the_plan():
    springs = [check(COMMON | {"spring": one}).spring.build() for one in (OUTER, INNER)]
    heights = plan([Press(to="block", steps=2), Press.model_validate({"to": {"height": 39.0}, "steps": 3})], springs)
    block = max(one.block_height for one in springs)
    assert heights.heights == pytest.approx(
        np.r_[40.0, 0.5 * (40.0 + block), block, block + np.arange(1, 4) * (39.0 - block) / 3]
    )
    phases = heights.program(31.0)
    assert [phase.to.height for phase in phases[:-1]] == pytest.approx([block, 31.0])
    assert phases[0].steps == pytest.approx([(31.0 - heights.heights[1]) / (31.0 - block), 1.0])
    assert phases[-1].to.force == 0.0
    assert heights.program(block) == []


def test_nests_without_room_are_refused_with_the_numbers(tmp_path):
    with pytest.raises(
        InputError, match=re.escape("inner: reaches 17.5 mm from the axis, but the outer spring leaves 17.5 mm")
    ):
        press(read_nest(write(tmp_path, inner={"mean_diameter": 32.0})))
    near = write(tmp_path, inner={"mean_diameter": 31.98}, loading=[{"to": "block", "steps": 2}])
    with pytest.raises(SolveError, match=r"at the height of [\d.]+ mm the springs touch each other: they overlap by"):
        press(read_nest(near))


def test_what_is_wrong_with_a_spring_names_its_file(tmp_path):
    """Entries that fit each other only when the spring is built, or the material; and one without an equilibrium."""
    for change, place in (({"outer": {"pitch": 2.0}}, "outer"), ({"inner": {"pitch": 2.0}}, "inner")):
        with pytest.raises(InputError) as error:
            press(read_nest(write(tmp_path, **change)))
        assert str(error.value).startswith(f"{tmp_path}/{place}.yaml: spring")
    with pytest.raises(InputError, match=f"^{tmp_path}/outer.yaml: temperature: "):
        press(read_nest(write(tmp_path, material="creeping", temperature=5.0)))
    hard = {"contact": {"penetration_limit": 1e-6}, "solver": {"control": {"steps": {"patience": 50}}}}
    with pytest.raises(SolveError, match=r"^outer: no equilibrium beyond "):
        press(read_nest(write(tmp_path, loading=[{"to": "block", "steps": 1}], **hard)))


def test_the_own_loading_of_a_spring_is_not_used(tmp_path):
    """Nor is one that it could not bear refused, where the seats do not even reach the spring."""
    wrong = write(tmp_path, loading=[{"to": {"height": 36.0}, "steps": 1}], outer={"turns": 4.5})
    file = tmp_path / "inner.yaml"
    case = yaml.safe_load(file.read_text(encoding="utf-8")) | {"loading": [{"to": {"height": 1.0}}]}
    file.write_text(yaml.safe_dump(case), encoding="utf-8")
    assert press(read_nest(wrong)).members[1].result is None


HEIGHT = "loading.0.to.height: is"
WRONG = [
    (
        {"loading": [{"to": {"height": 5.0}}]},
        f"{HEIGHT} 5 mm, below 17.5 mm, where the first of the springs is at block",
    ),
    ({"loading": [{"to": {"height": 50.0}}]}, f"{HEIGHT} 50 mm, above the free length of the longer spring, 40 mm"),
    ({"ends": "clamped"}, "ends: a nest is compressed between seats; give ends: seats"),
    ({"seats": {"hold": "groove", "top": {"tilt": "free"}}}, "seats: seats that tilt or move aside are shared by both"),
    ({"loading": []}, "loading: "),
]


@pytest.mark.parametrize(("change", "message"), WRONG)
def test_wrong_nests(change, message, tmp_path):
    with pytest.raises(InputError) as error:
        press(read_nest(write(tmp_path, **change)))
    assert message in str(error.value)


def test_a_nest_does_not_stand_on_cones(tmp_path):
    """A cone of 10° touches the inner spring, of 8 mm less radius, 1.4 mm lower than the outer one."""
    nest, file = write(tmp_path), tmp_path / "inner.yaml"
    case = yaml.safe_load(file.read_text(encoding="utf-8")) | {"seats": {"top": {"shape": "conical", "angle": 10.0}}}
    case["loading"] = [{"to": {"height": 28.0}}]
    file.write_text(yaml.safe_dump(case), encoding="utf-8")
    with pytest.raises(InputError, match="seats: a cone touches each spring of a nest at a height of its own"):
        read_nest(nest)


def test_heat_flows_in_no_nest(tmp_path):
    """Its seats take no time, so that all of it would stay where the wire has flowed."""
    nest, file = write(tmp_path), tmp_path / "outer.yaml"
    case = yaml.safe_load(file.read_text(encoding="utf-8")) | {"heat": {"conductivity": 50.0}}
    case["loading"] = [{"to": {"travel": 1.0}, "seconds": 1.0}]
    file.write_text(yaml.safe_dump(case), encoding="utf-8")
    with pytest.raises(InputError, match=r"outer.yaml: heat: takes time to flow, and the seats of a nest take none"):
        read_nest(nest)


def test_the_command_writes_the_nest_and_each_spring(tmp_path, capsys):
    out = tmp_path / "results"
    nest_command(
        write(tmp_path, inner={"hand": "right"}, loading=[{"to": {"height": 28.0}, "steps": 2}]), out, False, True
    )
    assert "wound in the same direction" in capsys.readouterr().out
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    rows = list(csv.DictReader((out / "nest.csv").read_text(encoding="utf-8").splitlines()))
    assert tuple(rows[0]) == COLUMNS
    assert float(rows[-1]["force_N"]) == summary["force_max_N"]
    assert summary["outer"]["force_max_N"] + summary["inner"]["force_max_N"] == pytest.approx(summary["force_max_N"])
    for name in ("outer", "inner"):
        assert (out / name / "summary.json").is_file()
        assert (out / name / "points.nc").is_file()
    assert (out / "characteristic.png").stat().st_size > 10_000
    capsys.readouterr()
    with pytest.raises(InputError, match="already holds results"):
        nest_command(tmp_path / "nest.yaml", out, False, False)
    assert not capsys.readouterr().out  # before a step is solved
    short = write(tmp_path, loading=[{"to": {"height": 36.0}, "steps": 1}], outer={"turns": 4.5})
    nest_command(short, out, True, False)  # which does not reach the inner spring
    assert (out / "outer" / "summary.json").is_file()
    assert not any((out / "inner").glob("*.*"))
    assert not (out / "characteristic.png").exists()
    page = (REPOSITORY / "docs/reference/results.md").read_text(encoding="utf-8")
    table = page[page.index("## Nests") :]
    for key in (*summary, *COLUMNS):
        assert f"`{key}`" in table, key


def test_the_shipped_nest_is_valid():
    nest = read_nest(REPOSITORY / "examples/nested/nest.yaml")
    assert plan(nest.loading, [case.spring.build() for case in nest.cases]).free_length == 70.0
