"""To the working states after the load program, and back: they change nothing of its results.

A spring that was released is elastic up to the load that it has seen, so that these are few steps. Whether it is, they
show: the plastic work at each state and the free length after them are compared with those before.
"""

import logging
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal

from coilset.model.compose.load_history import LoadHistory
from coilset.model.core.base.errors import SolveError
from coilset.model.core.case.phases import Phase, Target
from coilset.model.core.equilibrium.path.program import LoadProgram
from coilset.model.core.results.records.record import Step, Working, WorkingState
from coilset.model.core.results.records.releases import FREE
from coilset.model.physics.reactions.seat_reactions import seat_reactions

log = logging.getLogger("coilset.steps")
FEW = 4  # equal steps to a state, where the errors of automatic ones are not estimated


def working_states(history: LoadHistory, follow: Callable[[Step], object] = lambda step: None) -> Working | None:
    """The finished spring at the working lengths and forces of its case; None without any; collective.

    Args:
        history: a complete run.
        follow: called with each Step on the way.
    """
    spec = history.case.working
    if spec is None:
        return None
    with _excursion(history, follow) as way:
        free = abs(history.control.force) <= FREE * history.result.greatest_force
        if free and history.case.release == "free":
            try:
                _stand_free(history)
            except SolveError as error:
                return Working(tuple(_not_there(target, str(error)) for _, target in spec.targets))
        start = history.control.height
        found: dict[str, WorkingState] = {}
        for place, target in sorted(spec.targets, key=lambda one: _distance(one[1], start)):
            found[place] = _state(history, way, target, start if free else math.inf)
        more = None
        if free:
            try:
                way.go(Target(force=0.0))
                more = start - history.control.height
            except SolveError as error:
                log.info("the free length after the working states is unknown: %s", error)
    return Working(tuple(found[place] for place, _ in spec.targets), more)


class _Way:
    """A load program of its own after that of a run.

    Attributes:
        last: the last Step.
    """

    def __init__(self, history: LoadHistory, follow: Callable[[Step], object]) -> None:
        self.history, self.follow = history, follow
        self.program, self.last = LoadProgram(history.control, history.continuation), history.result.steps[-1]

    def go(self, target: Target) -> None:
        """Go to a target, unless the spring is there already; collective.

        Raises:
            SolveError: if there is no equilibrium.
        """
        history, case = self.history, self.history.case
        steps: int | Literal["auto"] = FEW if case.steps_error is None else "auto"
        loading = [*case.loading, Phase(to=target, steps=steps)]
        phase = len(loading) - 1
        self.program.begin(phase)
        stage = history.stage(phase, loading)
        now = history.control.height if stage.kind == "height" else history.control.force
        for taken in self.program.run(stage) if stage.value != now else ():
            self.last = history.recorder.step(phase, taken, loading)
            self.follow(self.last)


@contextmanager
def _excursion(history: LoadHistory, follow: Callable[[Step], object]) -> Iterator[_Way]:
    """A way after which everything is as before."""
    try:
        with history.continuation.excursion():
            yield _Way(history, follow)
    finally:
        history.program.begin(history.program.number)


def _stand_free(history: LoadHistory) -> None:
    """Put the spring that nothing holds between its heads, whether or not it was so before; collective.

    Raises:
        SolveError: if it finds no equilibrium.
    """
    ends, setup = history.free_ends, history.setup
    ends.let_go()
    x = history.layout.gather(history.rod.x)
    if history.case.ends == "seats":
        lowest = float((x[:, 2] - setup.spring.below).min())
        ends.stand(lowest, setup.outer_length(x))
    else:
        history.system.attach()


def _distance(target: Target, start: float) -> tuple[bool, float]:
    """Lengths from the nearest on, then forces from the smallest on, so that each way is part of one loading."""
    if target.height is not None:
        return False, abs(start - target.height)
    return True, abs(target.force or 0.0)


def _not_there(target: Target, reason: str) -> WorkingState:
    ((kind, value),) = target.axial.items()
    return WorkingState("length" if kind == "height" else "force", value, f"no equilibrium was found ({reason})")


def _state(history: LoadHistory, way: _Way, target: Target, free_height: float) -> WorkingState:
    """The spring at a target; `free_height` is that of the released spring, infinite if it is not released."""
    kind: Literal["length", "force"] = "length" if target.height is not None else "force"
    state = WorkingState(kind, next(iter(target.axial.values())))
    on_seats = history.case.ends == "seats"
    if on_seats and target.height is not None and target.height > free_height:
        return replace(state, reason=f"the finished spring is free there, {free_height:.5g} mm long")
    try:
        way.go(target)
    except SolveError as failure:
        return replace(state, reason=f"no equilibrium was found ({failure})")
    control, recorder = history.control, history.recorder
    force, greatest = control.force, max(history.result.greatest_force, abs(control.force))
    if on_seats and force < -history.rod.faint_force(greatest):
        return replace(state, reason="the spring is free there, and seats cannot pull")
    shot = replace(recorder.snapshot(f"working, {state.label}"), force=force)
    turns, line, steps = history.setup.turns, history.setup.force_line, len(history.result.steps)
    seats = seat_reactions(history.system, control, turns, steps, greatest, line)
    return replace(state, rate=_rate(history), step=way.last, seats=seats, snapshot=shot)


def _rate(history: LoadHistory) -> float:
    """Slope of the force on further compression, by a travel of a thousandth of the free length; collective."""
    continuation, control = history.continuation, history.control
    travel, force = continuation.control.probe * history.spring.free_length, control.force
    outcome, after = continuation.probe(control.to_travel(travel), lambda: control.trial_force)
    return (after - force) / travel if outcome.converged else math.nan
