"""To the working states after the load program, and back: they change nothing of its results.

A spring that was released is elastic up to the load that it has seen, so that these are few steps. Whether it is, they
show: the plastic work at each state and the free length after them are compared with those before.
"""

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal

from coilset.model.base.errors import SolveError
from coilset.model.case.phases import Phase, Target
from coilset.model.equilibrium.path.program import LoadProgram, StepTaken
from coilset.model.results.records.record import Working, WorkingState
from coilset.model.results.records.releases import FREE
from coilset.model.results.records.seat_reactions import faint_force
from coilset.model.run.load_history import LoadHistory

log = logging.getLogger("coilset.steps")
FEW = 4  # equal steps to a state, where the errors of automatic ones are not estimated


def working_states(history: LoadHistory) -> Working | None:
    """The finished spring at the working lengths and forces of its case; None without any; collective."""
    spec = history.case.working
    if spec is None:
        return None
    with _excursion(history) as program:
        start = history.control.height
        free = abs(history.control.force) <= FREE * history.result.greatest_force
        found: dict[str, WorkingState] = {}
        for place, target in sorted(spec.targets, key=lambda one: _distance(one[1], start)):
            found[place] = _state(history, program, target, start if free else math.inf)
        more = None
        if free:
            try:
                _go(history, program, Target(force=0.0))
                more = start - history.control.height
            except SolveError as error:
                log.info("the free length after the working states is unknown: %s", error)
    return Working(tuple(found[place] for place, _ in spec.targets), more)


@contextmanager
def _excursion(history: LoadHistory) -> Iterator[LoadProgram]:
    """A load program of its own, after which everything is as before."""
    continuation, state = history.continuation, history.system.state
    before, number, pivots = state.copy(), continuation.number, continuation.negative_pivots
    try:
        yield LoadProgram(history.control, continuation)
    finally:
        state.put_back(before)
        history.system.restore()
        continuation.number, continuation.negative_pivots = number, pivots
        history.program.begin(history.program.number)


def _distance(target: Target, start: float) -> tuple[bool, float]:
    """Lengths from the nearest on, then forces from the smallest on, so that each way is part of one loading."""
    if target.height is not None:
        return False, abs(start - target.height)
    return True, abs(target.force or 0.0)


def _go(history: LoadHistory, program: LoadProgram, target: Target) -> StepTaken | None:
    """Go to a target; the last step, None if it is there already; collective."""
    steps: int | Literal["auto"] = FEW if history.case.steps_error is None else "auto"
    loading = [*history.case.loading, Phase(to=target, steps=steps)]
    program.begin(len(loading) - 1)
    stage = history.stage(len(loading) - 1, loading)
    now = history.control.height if stage.kind == "height" else history.control.force
    taken = list(program.run(stage)) if stage.value != now else []
    return taken[-1] if taken else None


def _state(history: LoadHistory, program: LoadProgram, target: Target, free_height: float) -> WorkingState:
    """The spring at a target; `free_height` is that of the released spring, infinite if it is not released."""
    kind: Literal["length", "force"] = "length" if target.height is not None else "force"
    state = WorkingState(kind, next(iter(target.axial.values())))
    seats = history.case.ends == "seats"
    if seats and target.height is not None and target.height > free_height:
        return replace(state, reason=f"the finished spring is free there, {free_height:.5g} mm long")
    try:
        taken = _go(history, program, target)
    except SolveError as failure:
        return replace(state, reason=f"no equilibrium was found ({failure})")
    control, recorder = history.control, history.recorder
    force, greatest = control.force, max(history.result.greatest_force, abs(control.force))
    if seats and force < -faint_force(history.rod, greatest):
        return replace(state, reason="the spring is free there, and seats cannot pull")
    estimate = None if taken is None else taken.outcome.estimate
    error = None if estimate is None else abs(estimate.force if kind == "length" else estimate.height)
    shot = replace(recorder.snapshot(f"working, {state.label}"), force=force)
    return replace(
        state,
        length=control.height,
        force=force + 0.0,
        rate=_rate(history),
        error=error if error is not None and math.isfinite(error) else None,
        seats=recorder.seat_reactions(len(history.result.steps), greatest),
        snapshot=shot,
    )


def _rate(history: LoadHistory) -> float:
    """Slope of the force on further compression, by a travel of a thousandth of the free length; collective."""
    continuation, control = history.continuation, history.control
    travel, force = continuation.control.probe * history.spring.free_length, control.force
    outcome, after = continuation.probe(control.to_height(control.height - travel), lambda: control.trial_force)
    return (after - force) / travel if outcome.converged else math.nan
