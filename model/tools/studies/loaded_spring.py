"""The spring of a results folder at a state: its last equilibrium, brought to a height, travel or force from there."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpi4py import MPI

from coilset.meshes.springs.geometry import Spring
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import Case, check
from coilset.model.core.results.files.checkpoint import Checkpoint, Saved
from coilset.model.core.results.files.opened import open_run

STATES = "end, block, block-3mm, height=30, travel=5 or force=100"


def after_run(case: Case, at: str = "end") -> Analysis:
    """The analysis of a case after its load program, gone on to a state; collective.

    Args:
        at: `end`, the end of the load program; or where the spring goes from there: `block`, so many mm short of it, or
            `height=`, `travel=` (mm, since the start) or `force=` (N).

    Raises:
        InputError: the state has no meaning, the seats do not touch the spring there, or it cannot be built.
        SolveError: no equilibrium was found.
    """
    return _touched(lambda state: _run(case, state), at)


def _run(case: Case, at: str) -> Analysis:
    analysis = Analysis(_gone_on(case, at), detailed=False, estimates=False)
    analysis.run()
    return analysis


def after_results(folder: str | Path, at: str = "end") -> Analysis:
    """The analysis of a results folder, from its checkpoint gone on to a state; collective.

    Args:
        folder: results of `coilset solve`, with their checkpoint.
        at: as for `after_run`.

    Raises:
        InputError: there are no such results, the run is not complete, the state has no meaning, or the seats do not
            touch the spring there.
        SolveError: no equilibrium was found there.
    """
    return _touched(lambda state: _resumed(folder, state), at)


def _resumed(folder: str | Path, at: str) -> Analysis:
    run = check(open_run(folder).case, Path("case"))
    case = _gone_on(run, at)
    saved = _saved(Path(folder), case)
    analysis = Analysis(case, detailed=False, estimates=False)
    if saved.position.stage < len(run.loading):
        raise InputError("the run did not reach its end; continue it by solve --resume first", "", folder)
    analysis.resume(saved)
    if at != "end":
        analysis.run()
    return analysis


def _touched(going: Callable[[str], Analysis], at: str) -> Analysis:
    """The analysis that went on to a state, if the seats touch the spring there; collective.

    Args:
        going: gives the analysis gone on to a state in words.
        at: the state.

    Raises:
        InputError: the spring is free there; only the weak springs that hold its tips would pull it.
    """
    analysis = going(at)
    if not analysis.result.steps[-1].lift_off_mm:
        return analysis
    height, free = analysis.control.height, going("force=0")
    length = free.setup.outer_length(free.layout.gather(free.rod.x))
    raise InputError(
        f"'{at}' leads to a height of {height:.6g} mm, above the present free length of {length:.5g} mm, but seats "
        "cannot pull; give a height up to it",
        "--at",
    )


def _saved(folder: Path, case: Case) -> Saved:
    """The checkpoint of the finest run of this case in a folder; collective."""
    refusal: InputError | None = None
    for number in range(len(list(folder.glob("checkpoint-*"))), -1, -1):
        checkpoint = Checkpoint(folder, case, number)
        if number == 0 and refusal is None:
            checkpoint.require()
        if not checkpoint.exists():
            continue
        try:
            return checkpoint.load(MPI.COMM_WORLD)
        except InputError as error:  # of a run that was coarser, or discarded
            refusal = refusal or error
    assert refusal is not None
    raise refusal


def _gone_on(case: Case, at: str) -> Case:
    """The case with one more phase, to a state; in equal steps where their errors are not estimated."""
    phase = phase_to(at, case.spring.build())
    if phase is None:
        return case
    if case.steps_error is None:
        phase["steps"] = case.solver.control.steps.automatic
    data = case.model_dump(mode="json")
    gone = check(data | {"loading": [*data["loading"], phase]}, Path("case"))
    return gone


def phase_to(at: str, spring: Spring) -> dict[str, Any] | None:
    """The phase of a load program that goes to a state in words; None for the end of the run.

    Raises:
        InputError: if the words have no meaning.
    """
    if at == "end":
        return None
    if at == "block":
        return {"to": "block"}
    number = r"([0-9]+\.?[0-9]*(?:e[-+]?[0-9]+)?)"
    if found := re.fullmatch(rf"block-{number} ?mm", at):
        return {"to": {"height": spring.block_height + float(found[1])}}
    if found := re.fullmatch(rf"(height|travel|force)=(-?){number} ?(?:mm|N)?", at):
        return {"to": {found[1]: float(found[2] + found[3])}}
    raise InputError(f"'{at}' is no state; give {STATES}", "--at")
