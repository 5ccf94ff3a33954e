"""`coilset solve --interactive`: what is typed after a step is done in the next one; what is wrong changes nothing."""

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.scripts.terminal.interactive import HELP, Prompt, parse_phase

SETTINGS = [
    "ends=clamped",
    "mesh.elements_per_turn=8",
    "mesh.section={radial: 2, angular: 6}",
    "loading=[{to: {travel: 4}, steps: 4}, {to: {force: 0}, steps: 2}]",
    "accuracy=none",
]


@pytest.fixture
def typed(example):
    """Run a spring, 4 mm down in 4 steps and back in 2, with lines that are typed; then the input has ended.

    Returns:
        The Analysis, the lines that were said, and how many of those typed were read.
    """

    def run(*lines):
        analysis, said, read = Analysis(read_case(example, SETTINGS), MPI.COMM_SELF), [], []

        def ask(prompt):
            assert prompt == "coilset> "
            if len(read) == len(lines):
                raise EOFError
            read.append(lines[len(read)])
            return read[-1]

        try:
            analysis.run(Prompt(analysis, said.append, ask))
        except KeyboardInterrupt:
            said.append("interrupted")
        return analysis, said, len(read)

    return run


def travels(analysis):
    return [step.travel_mm for step in analysis.result.steps]


def forces(analysis):
    return [step.force_N for step in analysis.result.steps]


@pytest.fixture
def undisturbed(example):
    analysis = Analysis(read_case(example, SETTINGS), MPI.COMM_SELF)
    analysis.run()
    return analysis


def test_enter_goes_on_and_prompts_again(typed, undisturbed):
    analysis, said, read = typed("", "", "  ", "", "", "", "this is never asked for")
    assert read == 6  # once after each step
    assert said == []
    assert forces(analysis) == forces(undisturbed)
    assert analysis.result.complete


@pytest.mark.parametrize("lines", [["run"], [""], []], ids=["run", "end of input later", "end of input"])
def test_run_and_the_end_of_input_ask_no_more(typed, undisturbed, lines):
    analysis, said, read = typed(*lines)
    assert read == len(lines)
    assert said == []
    assert forces(analysis) == forces(undisturbed)


def test_size_is_that_of_the_next_step(typed):
    """In regular steps, here of 1 mm; those after it are larger again, up to the marks, which they do not pass."""
    analysis, said, _ = typed("size 0.25", "", "run")
    assert said == []
    assert travels(analysis)[:4] == pytest.approx([1.0, 1.25, 1.75, 2.0], abs=1e-9)
    for mark in (3.0, 4.0):
        assert min(abs(travel - mark) for travel in travels(analysis)) < 1e-9


def test_size_may_reach_beyond_the_next_mark(typed):
    analysis, said, _ = typed("size 3", "run")
    assert said == []
    assert travels(analysis)[:2] == pytest.approx([1.0, 4.0], abs=1e-9)
    assert [step.phase for step in analysis.result.steps] == [0, 0, 1, 1]


def test_another_target_outlives_a_stop(typed, example, tmp_path):
    """Stopped on its way to 30 mm, the run goes on to there, and then to the second phase."""
    case = read_case(example, SETTINGS)
    analysis, checkpoint = Analysis(case, MPI.COMM_SELF), Checkpoint(tmp_path, case)
    lines = iter(["to {height: 30}, steps: 2", "", "stop"])
    with pytest.raises(KeyboardInterrupt):
        analysis.run(Prompt(analysis, print, lambda prompt: next(lines)), checkpoint.save)
    resumed = Analysis(case, MPI.COMM_SELF)
    resumed.resume(Checkpoint(tmp_path, case).load(MPI.COMM_SELF))
    resumed.run()
    straight, _, _ = typed("to {height: 30}, steps: 2", "run")
    assert travels(resumed) == travels(straight)
    assert forces(resumed) == forces(straight)
    assert [shot.name for shot in resumed.result.snapshots] == ["start", "height 30 mm", "force 0 N"]
    other = read_case(example, [*SETTINGS, "loading.0.to={travel: 6}"])  # what the file asks for now is newer
    renewed = Analysis(other, MPI.COMM_SELF)
    renewed.resume(Checkpoint(tmp_path, other).load(MPI.COMM_SELF))
    renewed.run()
    assert max(travels(renewed)) == pytest.approx(6.0)


def test_another_target_is_in_the_case(typed):
    analysis, _, _ = typed("to {height: 30}, steps: 2", "run")
    assert analysis.case.loading[0].label == "height 30 mm"


def test_another_target_from_here(typed):
    """After 1 mm, at 34 mm: to 30 mm in 2 steps of 2 mm, in place of the first phase; then the second one follows."""
    analysis, said, _ = typed("to {height: 30}, steps: 2", "run")
    assert said == []
    assert travels(analysis)[:3] == pytest.approx([1.0, 3.0, 5.0], abs=1e-9)
    assert [step.phase for step in analysis.result.steps] == [0, 0, 0, 1, 1]
    assert abs(forces(analysis)[-1]) < 1e-6 * max(forces(analysis))


def test_another_method_finds_the_same_equilibrium(typed, undisturbed):
    analysis, said, _ = typed("method modified-newton", "run")
    assert said == []
    assert forces(analysis)[:4] == pytest.approx(forces(undisturbed)[:4], rel=1e-7)
    iterations = [sum(step.iterations for step in one.result.steps[1:]) for one in (analysis, undisturbed)]
    assert iterations[0] > iterations[1]  # it is another one: with the tangent of the step's start more are needed


def test_stop_keeps_what_was_found(typed, undisturbed):
    analysis, said, read = typed("", "stop", "run")
    assert said == ["interrupted"]
    assert read == 2
    assert forces(analysis) == forces(undisturbed)[:2]
    assert not analysis.result.complete
    last = analysis.result.snapshots[-1]
    assert last.name == "last equilibrium"
    assert (last.height, last.force) == (analysis.result.steps[-1].seat_height_mm, analysis.result.steps[-1].force_N)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("size 0", "above 0"),
        ("size -1", "above 0"),
        ("size nan", "above 0"),
        ("size much", "much"),
        ("to {travel: fast}", "travel"),
        ("to {travel: 1, force: 2}", "exactly one"),
        ("to blok", "block"),
        ("to {height: 20", "a target is block"),
        ("to {height: 2}, steps: 1", "below the block height"),
        ("to block, steps: 0", "steps"),
        ("method magic", "magic"),
        ("?", HELP),
        ("help", HELP),
    ],
)
def test_what_is_wrong_is_said_and_changes_nothing(typed, undisturbed, line, words):
    analysis, said, read = typed(line, "run")
    assert read == 2  # it asks again at once
    assert len(said) == 1
    assert words in said[0]
    assert forces(analysis) == forces(undisturbed)


def test_targets_are_phases():
    assert parse_phase("block").to == "block"
    phase = parse_phase("{height: 20}, steps: 8")
    assert (phase.to.height, phase.steps) == (20.0, 8)


@pytest.mark.parametrize("text", ["blok", "{height: yes}", "{height: 20, height: 21}", "{height: [", "{" * 2000, ""])
def test_other_targets_get_one_short_line(text):
    with pytest.raises(InputError, match="a target is block") as caught:
        parse_phase(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
