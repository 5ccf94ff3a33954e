"""A design file is read strictly: what is wrong with it is said before anything is run."""

import numpy as np
import pytest
import yaml

from coilset.model.core.base.errors import InputError
from coilset.model.tools.design.conditions import conditions
from coilset.model.tools.design.design import make_search
from coilset.model.tools.design.file import read_design_file

FIND, SUCH = {"spring.pitch": [9, 15]}, {"free_length_after_mm": 25.0}


def build(path):
    """Read a design and guess at one of its corners."""
    search = make_search(read_design_file(path))
    search.evaluator.guess(search.low)


@pytest.mark.parametrize(
    ("find", "such_that", "problem"),
    [
        ({"spring.pitch": [15, 9]}, SUCH, "find.spring.pitch: from 15 to 9 is not a range"),
        ({"spring.pitch": 9}, SUCH, "find.spring.pitch: must be the minimum and the maximum value"),
        (FIND, {}, "such_that: there is no condition"),
        (FIND, {"free_length_after": 25.0}, "is free_length_after_mm meant?"),
        (FIND, {"set_mm": -0.3}, "such_that.set_mm: is -0.3; must be greater than 0 of a spring between seats"),
        (FIND, {"force_at": {"height": 30.0}}, "such_that.force_at.0.N: this entry is required"),
        ({**FIND, "spring.turns": [2, 3]}, SUCH, "2 unknowns and 1 condition"),
        ({"spring.pich": [9, 15]}, SUCH, "spring.pich: unknown entry; is pitch meant?"),
        ({"loading.7.to.height": [18, 20]}, SUCH, "find.loading.7.to.height: '7' is not an entry of this list"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(design_file, find, such_that, problem):
    with pytest.raises(InputError) as caught:
        build(design_file(find, such_that))
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("such_that", "place"),
    [
        ({"working": {"force_at_90_N": 35.0}}, "working.force_at_90_N"),
        ({"working": {"force_at_90_N": {"at_least": 35.0}}}, "working.force_at_90_N.at_least"),
        ({"force_at": {"height": 90.0, "N": 35.0}}, "force_at"),
        ({"force_max_N": 35.0}, "force_max_N"),
    ],
)
@pytest.mark.parametrize("hooks", [True, False])
def test_a_force_of_the_wrong_sign_of_a_pulled_spring_is_refused(tmp_path, such_that, place, hooks):
    """No spring has it: a search for one went on for five minutes."""
    spring = {"wire_diameter": 1.2, "outer_diameter": 12.0, "turns": 18, "initial_tension": 8.0}
    spring |= {"hooks": {"bottom": {"shape": "german"}, "top": {"shape": "german"}}} if hooks else {}
    loading = [{"to": {"force": -35.0}}, {"to": {"force": 0}}]
    entries = {"spring": spring, "material": "elastic", "ends": "clamped", "loading": loading}
    path = tmp_path / "design.yaml"
    path.write_text(yaml.safe_dump(entries | {"find": {"spring.turns": [12, 30]}, "such_that": such_that}))
    with pytest.raises(InputError) as caught:
        make_search(read_design_file(path))
    assert f"such_that.{place}: is 35; must be below 0 of a spring that is pulled" in str(caught.value)
    assert str(caught.value).endswith("give -35")
    path.write_text(path.read_text().replace("35.0", "-35.0").replace("--", "-"))
    make_search(read_design_file(path))


def test_what_no_spring_between_the_bounds_can_be_is_refused_before_one_is_run(design_file):
    """A word as an unknown, and a height below block, 12.5 mm and 17.5 mm of these, are called by their own entries."""
    with pytest.raises(InputError, match=r"^find\.spring\.hand: 9\.0: must be 'right' or 'left'$"):
        make_search(read_design_file(design_file({"spring.hand": [9, 15]}, SUCH)))
    low = {"force_at": [{"height": 18.0, "N": 50.0}, {"height": 12.0, "N": 100.0}]}
    turns = {"spring.turns": [1.5, 2.5]}
    below = r"^such_that\.force_at\.1\.height: is 12 mm, below the block height, which is 12\.5 mm or more between "
    with pytest.raises(InputError, match=below):
        make_search(read_design_file(design_file(turns, low)))
    make_search(read_design_file(design_file(turns, {"force_at": {"height": 13.0, "N": 100.0}})))  # a few of these can


def test_a_height_that_one_spring_does_not_reach_is_called_by_the_entry_of_the_file(design_file):
    search = make_search(
        read_design_file(design_file({"spring.turns": [1.5, 2.5]}, {"force_at": {"height": 13.0, "N": 100.0}}))
    )
    reason = search.evaluator.run(np.array([2.5])).reason
    assert reason == "such_that.force_at.height: is 13 mm, below the block height of 17.5 mm; give block, or more"


def test_a_case_stands_in_the_file_or_beside_it(tmp_path, design_file, example):
    beside = tmp_path / "beside.yaml"
    beside.write_text(yaml.safe_dump({"case": str(example), "find": FIND, "such_that": SUCH}), encoding="utf-8")
    assert read_design_file(beside).base["spring"]["turns"] == 2.5
    with pytest.raises(InputError, match="loading: is an entry of a case, and case: names one already"):
        read_design_file(design_file(FIND, SUCH, case=str(example)))


def test_paths_in_the_case_count_from_its_file(tmp_path, design_file):
    assert read_design_file(design_file(FIND, SUCH, material="voce")).base["material"] == "voce"
    assert read_design_file(design_file(FIND, SUCH, material="mine.yaml")).base["material"] == str(
        tmp_path / "mine.yaml"
    )


def test_a_force_is_read_where_the_program_goes_to_its_height(design_file):
    read = read_design_file(
        design_file(FIND, {"force_at": [{"height": 20.0, "N": 100.0}, {"height": 22.0, "N": 50.0}]})
    )
    found, data = conditions(read.spec, read.base)
    assert [(one.height, one.phase) for one in found] == [(20.0, 0), (22.0, 2)]
    assert [phase["to"] for phase in data["loading"]] == [
        {"height": 20.0},
        {"force": 0},
        {"height": 22.0},
        {"force": 0},
    ]
    assert len(read.base["loading"]) == 2


def test_a_length_after_needs_a_release(design_file):
    read = read_design_file(design_file(FIND, SUCH, loading=[{"to": "block"}]))
    with pytest.raises(InputError, match="let the load program end with"):
        conditions(read.spec, read.base)


def test_the_limits_of_the_case_are_conditions(design_file):
    """On both sides, at a working length that is visited for them; a condition of the file replaces one."""
    limits = {"free_length": [24.0, 26.0], "force_at_22": {"nominal": 150.0, "tolerance": 5.0}, "set": [2.0, 9.0]}
    entries = {"limits": limits, "working": {"lengths": [22.0]}}
    path = design_file({**FIND, "spring.turns": [2, 3]}, {"set_mm": {"at_most": 8.0}}, **entries)
    read = read_design_file(path)
    found, data = conditions(read.spec, read.base)
    assert {one.name: one.target for one in found} == {
        "such_that.set_mm.at_most": 8.0,
        "such_that.free_length_after_mm.at_most": 26.0,
        "such_that.free_length_after_mm.at_least": 24.0,
        "such_that.working.force_at_22_N.at_most": 155.0,
        "such_that.working.force_at_22_N.at_least": 145.0,
    }
    assert data["working"]["lengths"] == [22.0]


def test_limits_alone_are_enough(design_file):
    path = design_file(FIND, SUCH, limits={"free_length": [24.0, 26.0]})
    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    del data["such_that"]
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    found = make_search(read_design_file(path)).run()
    assert found.met
    assert 24.0 * 0.999 < found.best.values[0] < 26.0 * 1.001


@pytest.mark.parametrize(
    ("limits", "problem"),
    [
        ({"free_length": "EN 15800 grade 2"}, "limits.free_length: the middle of EN 15800 grade 2 moves"),
        ({"rate": [10.0, 12.0]}, "limits.rate: a design has no condition on it"),
        ({"set": [0.0, 12.0]}, "limits.set: must not be 0"),
    ],
)
def test_limits_that_are_no_conditions(design_file, limits, problem):
    read = read_design_file(design_file(FIND, SUCH, limits=limits))
    with pytest.raises(InputError, match=problem):
        conditions(read.spec, read.base)
