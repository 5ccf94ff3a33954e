"""`coilset bench --springs`: what becomes of random springs is counted by family; costs are those of the runs."""

import json

import pytest

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.case import check
from coilset.scripts.commands import bench as command
from coilset.scripts.terminal import spring_costs
from coilset.verification.benchmarks import springs
from coilset.verification.random_springs.press_one import press
from coilset.verification.random_springs.springs import FAMILIES

SMALL = springs.WARM


def side(end="complete", seconds=1.0, evaluations=10, cuts=0, force=100.0):
    return {"end": end, "message": "", "seconds": seconds, "evaluations": evaluations, "cuts": cuts, "force_N": force}


def row(family, friction, *sides):
    return {"number": 0, "family": family, "friction": friction, "sides": list(sides)}


def test_a_spring_ends_in_one_of_four_ways():
    complete = press(SMALL, 60.0)
    assert (complete["end"], complete["steps"]) == ("complete", 4)
    assert complete["evaluations"] >= complete["iterations"] > 4
    assert complete["length_mm"] == pytest.approx(7.0)  # (2.5 + 1) wires of 2 mm
    beyond = SMALL | {"loading": [{"to": {"height": 6.9}}]}
    refused = press(beyond, 60.0)
    assert (refused["end"], refused["steps"], refused["force_N"]) == ("refused", 0, None)
    assert "below the block height of 7 mm" in refused["message"]
    assert press(SMALL, 0.05)["end"] == "too slow"
    crushed = SMALL | {"contact": {"penetration_limit": 1e-9}, "solver": {"control": {"newton": {"augmentations": 1}}}}
    assert press(crushed, 60.0)["end"] == "unsolved"


def test_groups_and_percentiles():
    rows = [row("cone", False, side(seconds=s, cuts=c)) for s, c in ((1.0, 0), (2.0, 0), (9.0, 4))]
    rows.append(row("barrel", True, side("unsolved", 30.0)))
    grouped = springs.groups(rows)
    assert list(grouped) == ["barrel", "cone", "without friction", "with friction", "all"]
    assert [len(group) for group in grouped.values()] == [1, 3, 3, 1, 4]
    spent = springs.costs(grouped["cone"], 0)
    assert spent["seconds"] == [2.0, pytest.approx(2.0 + 0.8 * 7.0), 9.0]
    assert spent["cuts"] == [0.0, pytest.approx(3.2), 4.0]


def test_checkouts_are_compared_where_springs_end_in_both():
    rows = [
        row("cone", False, side(seconds=1.0, evaluations=5), side(seconds=4.0, force=101.0)),
        row("cone", True, side("unsolved"), side()),
    ]
    cells = [list(column.cells) for column in spring_costs.comparison(rows).columns]
    assert cells[0] == ["cone", "without friction", "all"]
    assert [column[0] for column in cells[1:]] == ["1", "0.25", "0.25", "0.25", "0.50", "0.99 %"]


@pytest.mark.slow
def test_the_command_runs_springs_in_two_checkouts(tmp_path, monkeypatch, capsys):
    """The processes of both sides, with small springs in place of random ones; this checkout is the other one, too."""
    case = SMALL | {"material": "ck15", "mesh": {"section": {"kind": "curved"}}}
    monkeypatch.setattr(springs, "random_spring", lambda number: case)
    monkeypatch.setattr(springs, "features", lambda case: {"friction"})
    start = command.launchers()[0]
    monkeypatch.setattr(command, "launchers", lambda against: [start, start])
    command.bench_springs(str(tmp_path / "out"), 2, "elsewhere")
    printed = capsys.readouterr().out
    record = json.loads((tmp_path / "out" / "springs.json").read_text())
    assert [one["family"] for one in record] == list(FAMILIES[:2])
    assert all(one["sides"][0]["force_N"] == one["sides"][1]["force_N"] for one in record)
    for words in ("median", "90 %", "worst", "cuts", "the same in the other checkout", "cylinder", "with friction"):
        assert words in printed


def test_a_process_that_dies_is_reported():
    dead = springs.Side(["false"], {})
    dead.end()
    with pytest.raises(CoilsetError, match="ended"):
        dead.press(SMALL, 1.0)


def test_each_law_and_kind_of_section_is_compiled_before_its_first_spring_is_timed():
    """Spring 62 seemed to take 60 s without a step, all of which were spent on compiling its law."""
    cases = [springs.random_spring(number) for number in (3, 4, 8, 62)]
    short = [springs.warming(case) for case in cases]
    assert [one["material"] for one in short] == ["ck15", "ck15", "chaboche", "chaboche"]
    assert [one["mesh"]["section"]["kind"] for one in short] == ["curved", "curved", "curved", "plane"]
    assert all(check(one).material == one["material"] for one in short)
