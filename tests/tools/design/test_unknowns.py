"""Unknowns that scale a table, drive several entries or are chosen from a list; conditions that are limits."""

import json

import numpy as np
import pytest
import yaml

import coilset.open
from coilset.model.core.base.errors import InputError
from coilset.model.tools.design.choices import choose
from coilset.model.tools.design.design import make_search, solve
from coilset.model.tools.design.evaluation import Evaluator
from coilset.model.tools.design.file import read_design_file
from coilset.model.tools.design.output import found_data
from coilset.model.tools.report.design_page import write_design_report
from coilset.scripts.commands.design import design

TABLE = {"turns": [0, 1.25, 2.5], "values": [11.0, 13.0, 11.0], "interpolation": "linear"}
SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": TABLE}
HEIGHT = {"loading.0.to.height": [18, 24]}
LENGTH = {"free_length_after_mm": 25.0}


def test_a_table_is_scaled_as_a_whole(search):
    """Each value by the same factor, and no turn; its length as wound, 5 mm of wire and 30 mm of pitch, follows."""
    one = search({"spring.pitch": {"scale": [0.8, 1.2]}}, {"free_length_before_mm": 32.0}, spring=SPRING)
    found = solve(one).found
    assert found.x == pytest.approx([27.0 / 30.0], rel=1e-6)
    pitch = found_data(found)["spring"]["pitch"]
    assert pitch["values"] == pytest.approx([9.9, 11.7, 9.9], rel=1e-6)
    assert pitch["turns"] == TABLE["turns"]
    cone = {**SPRING, "pitch": 12.0, "mean_diameter": {"shape": "funnel", "bottom": 50, "neck": 30, "cone_turns": 1.5}}
    one = search({"spring.mean_diameter": {"scale": [0.5, 1.2]}}, {"rate_N_per_mm": 30.0}, spring=cone)
    assert one.evaluator.data(np.array([0.5]))["spring"]["mean_diameter"] == {
        "shape": "funnel",
        "bottom": 25.0,
        "neck": 15.0,
        "cone_turns": 1.5,
    }


def test_entries_are_tied_to_one_unknown(search):
    """The ends' pitch is the unknown, the middle's half of it and 7.5 mm more."""
    tied = [
        "spring.pitch.values.0",
        "spring.pitch.values.2",
        {"entry": "spring.pitch.values.1", "factor": 0.5, "offset": 7.5},
    ]
    one = search({"end_pitch": {"from": 9, "to": 15, "entries": tied}}, {"free_length_before_mm": 35.0}, spring=SPRING)
    found = solve(one).found
    values = found_data(found)["spring"]["pitch"]["values"]
    # height over two linear pieces of 1.25 turns: 1.25 (p₀ + p₁), p₁ = p₀/2 + 7.5
    assert values == pytest.approx([11.0, 13.0, 11.0], rel=1e-6)
    assert one.evaluator.named[0].head == "end pitch, mm"


def test_the_value_of_a_table_is_named_by_its_turn(search):
    one = search({"spring.pitch.values.1": [9, 15]}, LENGTH, spring=SPRING)
    assert one.evaluator.named[0].head == "pitch at turn 1.25, mm"


def test_a_limit_that_is_not_active_leaves_the_solution(search):
    alone = solve(search(HEIGHT, LENGTH)).found
    found = solve(search(HEIGHT, LENGTH | {"force_max_N": {"at_most": 300.0}})).found
    assert found.met
    assert found.x == pytest.approx(alone.x, rel=1e-6)
    limit = found.search.conditions[1]
    assert not limit.is_active(found.off[1])
    assert limit.wanted == "at most 300 N"


def test_a_limit_that_is_active_decides(search):
    """Pressed as little from its own 20 mm as makes the spring no longer than 24 mm: the limit is met exactly.

    Without it the height of the case stays, which is met at once.
    """
    free = solve(search(HEIGHT, {"free_length_after_mm": {"at_least": 15.0}})).found
    assert (free.met, free.x[0]) == (True, pytest.approx(20.0, abs=1e-9))
    found = solve(one := search(HEIGHT, {"free_length_after_mm": {"at_least": 26.0}})).found
    assert found.met
    assert found.best.values[0] == pytest.approx(26.0, rel=1e-6)
    assert one.conditions[0].is_active(found.off[0])
    assert found.x[0] > 20.0


def test_of_many_springs_the_nearest_to_the_case_is_found(search, monkeypatch):
    """Two unknowns, one equation and a limit that is not active: the gradient of the distance is along the slopes.

    The uniform rod is computed 128 times; a search for more digits than it has computes it 293 times.
    """
    guesses, guess = [], Evaluator.guess
    monkeypatch.setattr(Evaluator, "guess", lambda *args: guesses.append(args) or guess(*args))
    find = HEIGHT | {"spring.wire_diameter": [4, 5.5]}
    found = solve(one := search(find, LENGTH | {"force_max_N": {"at_most": 400.0}})).found
    assert len(guesses) < 200
    assert found.met
    assert one.is_open
    own = (np.array([20.0, 5.0]) - one.low) / one.width
    away, slope = one.part(found.x) - own, found.slopes[0]
    across = away - (away @ slope) / (slope @ slope) * slope
    # the search ends where it moves by 0.1 % of the bounds
    assert np.abs(across).max() < 3e-3
    assert np.linalg.norm(away) > 0.02


@pytest.mark.slow
def test_limits_that_exclude_each_other_are_refused_with_the_reason(search):
    with pytest.raises(InputError, match="cannot be met together with the other conditions"):
        solve(search(HEIGHT, {"free_length_after_mm": {"at_least": 26.0}, "force_max_N": {"at_least": 200.0}}))


def test_a_wire_is_chosen_from_a_list(search):
    """Of three sizes one meets the force with a height of its own; the first of the list that does is taken."""
    find = HEIGHT | {"spring.wire_diameter": {"choices": [5.25, 4.75, 4.5]}}
    such = LENGTH | {"force_max_N": {"at_most": 190.0}}
    solution = solve(one := search(find, such))
    assert [option.found.met for option in solution.options.tried] == [False, True, True]
    assert solution.found is solution.options.tried[1].found
    assert solution.found.x[1] == 4.75
    assert solution.options.total == 3
    assert found_data(solution.found)["spring"]["wire_diameter"] == 4.75
    assert len(one.evaluations) == one.evaluator.count


def test_choices_alone_come_as_near_as_one_of_them(search):
    solution = solve(search({"loading.0.to.height": {"choices": [18, 20, 22]}}, LENGTH))
    assert not solution.found.met
    offs = [abs(option.found.off[0]) for option in solution.options.tried]
    assert solution.options.best is solution.options.tried[int(np.argmin(offs))]


def test_of_many_combinations_those_next_to_the_solution_are_evaluated(search):
    """60 combinations: four runs at the corners about the solution in which both lists are ranges."""
    lists = {
        "loading.0.to.height": [18.0 + 0.5 * k for k in range(12)],
        "spring.wire_diameter": [4.5, 4.75, 5.0, 5.25, 5.5],
    }
    find = {name: {"choices": values} for name, values in lists.items()}
    one = search(find, LENGTH | {"force_at": {"height": 21.0, "N": 160.0}})
    options = choose(one, lists)
    assert (len(options.tried), options.total) == (4, 60)
    chosen = [tuple(option.chosen.values()) for option in options.tried]
    assert chosen == [(20.0, 4.75), (20.0, 5.0), (20.5, 4.75), (20.5, 5.0)]  # about 20.50 mm and 4.96 mm
    assert options.best.off == min(option.off for option in options.tried)


@pytest.mark.parametrize(
    ("find", "such_that", "problem"),
    [
        ({"spring.pitch": {"scale": [1.2, 0.8]}}, LENGTH, "find.spring.pitch: scale from 1.2 to 0.8 is not a range"),
        ({"spring.pitch": {"scale": [0.8]}}, LENGTH, "find.spring.pitch.scale"),
        ({"spring.hand": {"scale": [0.8, 1.2]}}, LENGTH, "find.spring.hand: the case has no spring.hand to scale"),
        ({"spring.pitch": {"choices": [12.0]}}, LENGTH, "find.spring.pitch.choices"),
        ({"spring.pitch": {"choices": [12.0, 12.0]}}, LENGTH, "find.spring.pitch: choices holds a value twice"),
        ({"material": {"choices": ["ck15", "voce"]}}, LENGTH, "find.material.choices.0: 'ck15': must be a number"),
        ({"p": {"from": 9, "to": 15, "entries": []}}, LENGTH, "find.p.entries"),
        ({"p": {"from": 9, "to": 15, "entries": [{"entry": "spring.pitch", "factor": 0.0}]}}, LENGTH, "factor 0"),
        ({"p": {"from": 9, "to": 15, "entry": "spring.pitch"}}, LENGTH, "p.entry: unknown entry; is entries meant"),
        (
            {"spring.pitch": [9, 15], "p": {"from": 9, "to": 15, "entries": ["spring.pitch"]}},
            LENGTH | {"set_mm": 3.0},
            "find.spring.pitch: spring.pitch is driven by p already",
        ),
        (HEIGHT, {"set_mm": {}}, "such_that.set_mm: is empty; give at_least or at_most"),
        (HEIGHT, {"set_mm": {"at_least": 5, "at_most": 4}}, "such_that.set_mm: at_least 5 leaves nothing below"),
        (HEIGHT, {"set_mm": {"most": 4}}, "such_that.set_mm.most: unknown entry; is at_most meant?"),
        (HEIGHT, {"set_mm": "4"}, "such_that.set_mm: '4': must be a number"),
        (HEIGHT, {"force_at": {"height": 21.0, "N": {"at_least": "x"}}}, "force_at.0.N.at_least: 'x': must be"),
    ],
)
def test_wrong_unknowns_and_limits_get_one_line(design_file, find, such_that, problem):
    with pytest.raises(InputError) as caught:
        make_search(read_design_file(design_file(find, such_that)))
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)


def test_page_terminal_and_file_give_choices_and_limits_in_words(design_file, tmp_path, capsys):
    spring = {**SPRING, "pitch": {**TABLE}}
    find = {"spring.pitch.values.1": [10, 15], "spring.wire_diameter": {"choices": [5.0, 4.5]}}
    such = {"free_length_before_mm": 35.0, "force_max_N": {"at_most": 1000.0}}
    path = design_file(find, such, spring=spring, trade_offs={"spring.mean_diameter": [38.0]})
    design(str(path), str(tmp_path / "out"), False, False)
    printed = capsys.readouterr().out
    assert "pitch at turn 1.25 = 13 mm  (spring.pitch.values.1)" in printed
    assert "for at most 1000 N, not active" in printed
    assert "(the best of all 2)" in printed
    written = json.loads((tmp_path / "out" / "design.json").read_text(encoding="utf-8"))
    assert [(one["kind"], one["active"], one["met"]) for one in written["conditions"]] == [
        ("equals", True, True),
        ("at_most", False, True),
    ]
    assert [one["is_best"] for one in written["choices"]["tried"]] == [True, False]
    page = write_design_report(tmp_path / "out").read_text(encoding="utf-8")
    assert "<dt>pitch at turn 1.25</dt>" in page
    assert "at most 1000 N" in page
    assert "yes, not active" in page
    assert "All 2 combinations" in page
    assert "maximum force at most 1020 N" in page  # of the estimates
    assert coilset.open(tmp_path / "out")["force_max_N"].attrs["at_most"] == 1000.0
    found = yaml.safe_load((tmp_path / "out" / "found.yaml").read_text(encoding="utf-8"))
    assert found["spring"]["wire_diameter"] == 5.0
