"""What a run says: a line a step in words, JSON for scripts, each iteration, or nothing."""

import csv
import json
import re

import pytest
from mpi4py import MPI

from coilset.model.core.results.order_of_warnings import messages_in_order
from coilset.scripts.commands.solve import solve
from coilset.scripts.terminal.progress import Lines, Steps, duration

SEATS = ["both seats"]
CASE = """
spring: {wire_diameter: 5, mean_diameter: 40, turns: 2.5, pitch: 12}
material: ck15
contact: {bedding: 5250}
loading: [{to: block, steps: 3}, {to: {force: 0}, steps: 2}]
mesh: {elements_per_turn: 8, section: {kind: curved, radial: 2, angular: 6}}
"""


@pytest.fixture
def said(tmp_path, capsys):
    """What a run prints, and its folder."""

    def run(name="spring", out="out", **voice):
        path = tmp_path / f"{name}.yaml"
        path.write_text(CASE)
        solve(path, tmp_path / out, True, [], comm=MPI.COMM_SELF, **voice)
        return capsys.readouterr().out.splitlines(), tmp_path / out

    return run


def test_a_finished_run_that_is_resumed_has_no_table_of_steps(said, tmp_path, capsys):
    said()
    solve(tmp_path / "spring.yaml", tmp_path / "out", False, [], comm=MPI.COMM_SELF, resume=True)
    lines = capsys.readouterr().out.splitlines()
    assert "all 5 steps are there: only the results are written again" in lines
    assert not any("iter." in line for line in lines)


@pytest.mark.parametrize(
    ("travel", "told"), [(13, r"\d+\.\d+ N/mm"), (2, "needs a travel of 12.25 mm"), (-2, None)], ids=str
)
def test_the_rate_is_that_on_the_way_to_block(tmp_path, capsys, travel, told):
    """Of 17.5 mm to block. It was `none` of the travel, which a reader took for that of the run."""
    path = tmp_path / "spring.yaml"
    path.write_text(CASE)
    program = [f"loading=[{{to: {{travel: {travel}}}, steps: 1}}]", "ends=clamped"]
    solve(path, tmp_path / "out", True, program, comm=MPI.COMM_SELF)
    printed = capsys.readouterr().out
    assert bool(re.search(f"rate, 30 to 70 % of the travel to block +{told}", printed)) == bool(told)
    assert "none" not in printed.partition("rate, 30")[2].partition("maximum force")[0]
    assert ("block height" in printed) == bool(told)


ROW = re.compile(r" +(\d+) +\d+\.\d{4} +-?\d+\.\d{3} +\d+ ")


@pytest.mark.parametrize(("seconds", "rows"), [(0.4, [3, 5]), (0.8, [2, 3, 5]), (1.5, [1, 2, 3, 4, 5])])
def test_a_phase_has_a_row_and_more_as_time_passes(said, monkeypatch, seconds, rows):
    """A run had 50 to 240 lines before its answer. So many seconds a step; a row a second at the most."""
    times = {"now": 0.0}
    step = Steps.step

    def slow(self, found):
        times["now"] += seconds
        step(self, found)

    monkeypatch.setattr(Steps, "step", slow)
    monkeypatch.setattr("coilset.scripts.terminal.progress.time.monotonic", lambda: times["now"])
    lines, _ = said(voice="steps")
    assert [int(found[1]) for line in lines if (found := ROW.match(line))] == rows


def test_a_run_that_ends_early_shows_its_last_step(said, monkeypatch, capsys):
    step = Steps.step

    def ends(self, found):
        step(self, found)
        if found.number == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(Steps, "step", ends)
    monkeypatch.setattr("coilset.scripts.terminal.progress.OFTEN", 1e6)
    with pytest.raises(KeyboardInterrupt):
        said(voice="steps")
    assert [int(found[1]) for line in capsys.readouterr().out.splitlines() if (found := ROW.match(line))] == [2]


def test_json_has_the_rows_of_the_history_and_the_summary(said):
    lines, folder = said(voice="json")
    events = [json.loads(line) for line in lines]
    assert {event["event"] for event in events[:-6]} <= {"warning", "begin"}
    steps, end = [event for event in events if event["event"] == "step"], events[-1]
    with open(folder / "history.csv", encoding="utf-8") as file:
        for row, step in zip(csv.DictReader(file), steps, strict=True):
            at_the_end = {name for name in row if name in ("estimated_force_error_N", "estimated_height_error_mm")}
            assert all(step[name] is None for name in at_the_end)  # until the companion has run
            of_steps = {name: value for name, value in row.items() if name not in at_the_end}
            assert {name: "" if step[name] is None else str(step[name]) for name in of_steps} == of_steps
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert end["summary"] == {name: value for name, value in summary.items() if name != "origin"}
    assert [step["done"] for step in steps] == pytest.approx([1 / 6, 2 / 6, 3 / 6, 3 / 4, 1.0])
    assert [step["touching"] for step in steps] == [*SEATS * 2, "both seats, coils", *SEATS, "no contact"]


def test_quiet_prints_the_answer_alone(said):
    """Checks and numbers, and nothing before or behind them."""
    lines, _ = said(voice="quiet")
    assert lines[0].startswith(("Permitted by all", "Not "))
    assert lines[1].split() == ["check", "verdict", "value", "limit", "reserve"]
    assert any(line.startswith("  set ") for line in lines)
    assert not any("warning:" in line or "results in" in line or ROW.match(line) for line in lines)


def test_one_line_of_progress_then_the_answer(said, monkeypatch):
    """Of a run that takes long, where it is no terminal, one more as the time doubles."""
    times, step = {"now": 0.0}, Lines.step

    def slow(self, found):
        times["now"] += 21.0
        step(self, found)

    lines, _ = said()
    assert [line.partition(":")[0] for line in lines[:2]] == ["spring.yaml", "Not known"]
    monkeypatch.setattr(Lines, "step", slow)
    monkeypatch.setattr("coilset.scripts.terminal.progress.time.monotonic", lambda: times["now"])
    lines, _ = said()
    assert [line.split(",")[0] for line in lines if line.startswith("step ")] == ["step 1", "step 3"]


def test_verbose_prints_each_iteration(said):
    """As many as the step took and the state it began with, the last one in equilibrium; no colours in a file."""
    lines, _ = said(voice="verbose")
    assert not any("\x1b" in line for line in lines)
    told, steps = [], 0
    for line in lines[1 + next(k for k, one in enumerate(lines) if one.startswith(" step")) :]:
        if found := re.match(
            r" +iteration (\d+): residual \S+ N(?:, out of balance ([^ ,]+))?(, step length \S+)?", line
        ):
            number, balance, length = int(found[1]), found[2], found[3]
            assert (number == 0) == (length is None)  # nothing was corrected yet
            told = [] if number == 0 else [*told, float(balance)]
        elif found := re.match(r" +\d+ +\S+ +\S+ +(\d+) ", line):
            steps += 1
            assert len(f"{line}  2 cuts  40 min left") <= 80  # columns of a terminal
            assert 0 < len(told) <= int(found[1])  # of the last solve, where contacts are augmented
            assert told[-1] < 1e-6 <= max(told)
    assert steps == 5
    assert "iteration 0" not in "".join(said()[0])


def test_a_warning_is_printed_once(said):
    """Those of the case came again after the results, in the same words."""
    lines, folder = said()
    printed = " ".join(" ".join(lines).split())
    messages = messages_in_order(json.loads((folder / "summary.json").read_text(encoding="utf-8")))
    assert messages
    assert [printed.count(message) for message in messages] == [1] * len(messages)
    assert printed.index("warning:") > printed.index("results in")


def test_names_are_printed_as_they_are(said, capsys):
    """Brackets in them are no markup, and a path stays whole however long it is."""
    lines, folder = said(name="a[bold]", out="[b]" + 100 * "x")
    assert f"  results in {folder}/" in lines
    assert any(line.startswith("a[bold].yaml: ") for line in lines)
    Lines().warn("see [red] there")
    assert capsys.readouterr().out == "warning: see [red] there\n"


@pytest.mark.parametrize(("seconds", "words"), [(40.4, "40 s"), (99.6, "100 s"), (150.0, "2 min"), (9000.0, "2.5 h")])
def test_times_are_printed_in_few_digits(seconds, words):
    assert duration(seconds) == words
