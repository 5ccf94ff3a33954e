"""The releases of a run: the moments at which a loaded spring is free of load again."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from coilset.model.core.results.records.record import Result, Setup, Snapshot, Step

TURNED = 2.0  # torque over force times coil radius from which a spring is loaded by the torque about its axis
LEAST_TURN = 1e-6  # degrees: a spring that is turned by less is not turned, but for rounding
STILL = 1e-9  # of the free length: heads that move by less keep it
NOTICED = 1e-5  # of the free length: a set of less, 0.3 µm of 30 mm, is none to whoever measures it
FREE = 1e-6  # of the maximum force so far: a spring under less is free of load


@dataclass(frozen=True)
class Release:
    """A spring free of load.

    Attributes:
        phase: number of the phase that ended so, from 0 on.
        snapshot: Snapshot at its end.
        step: the last step up to there.
        free_length: then, mm.
        set: loss of free length since the start, mm.
    """

    phase: int
    snapshot: Snapshot
    step: Step
    free_length: float
    set: float

    @property
    def set_error(self) -> float | None:
        """Estimated error of the set by the steps' length, true value minus result, mm; None if it is unknown."""
        error = self.step.steps_height_error_mm
        return None if error is None else -error


def releases(setup: Setup, result: Result) -> list[Release]:
    """All releases of a run, the last one last; a spring that has left a seat is held by its tips' springs only."""
    return list(_released(setup, result))


def last_release(setup: Setup, result: Result) -> Release | None:
    """The last release; None if the spring was never free of load again."""
    return next(reversed(releases(setup, result)), None)


def is_turned(setup: Setup, steps: Sequence[Step]) -> bool:
    """Whether a run loads its spring by a torque about the axis, as a torsion spring, and not by a force along it: by
    their size, or by heads that keep the length, between which coils that lie on each other press."""
    turn, torque, force, travel = (
        max((abs(getattr(one, name)) for one in steps), default=0.0)
        for name in ("turn_deg", "torque_Nmm", "force_N", "travel_mm")
    )
    kept = travel < STILL * setup.spring.free_length
    return turn > LEAST_TURN and (kept or torque > TURNED * 0.5 * setup.spring.mean_diameter * force)


def turned_radius(setup: Setup, steps: Sequence[Step]) -> float:
    """The coil's mean radius, mm, at which travel and force of a run that turns its spring are measured; else 0."""
    return 0.5 * setup.spring.mean_diameter if is_turned(setup, steps) else 0.0


def set_of(release: Release, radius: float) -> float:
    """Loss of free length, mm, or of a spring that was turned the rotation that stays, mm at the radius, if not 0."""
    return radius * math.radians(release.snapshot.turn) if radius else release.set


def load_of(setup: Setup, steps: Sequence[Step]) -> Callable[[Step], float]:
    """What loads a spring after a step: the magnitude of its axial force, N, or of its torque, N mm."""
    if is_turned(setup, steps):
        return lambda step: abs(step.torque_Nmm)
    return lambda step: abs(step.force_N)


def is_released(setup: Setup, steps: Sequence[Step], load: Callable[[Step], float] | None = None) -> bool:
    """Whether the last of these steps leaves a spring free of load; by `load_of` all steps of the run, or these."""
    load = load or load_of(setup, steps)
    return bool(steps) and not steps[-1].lift_off_mm and load(steps[-1]) <= FREE * max(map(load, steps))


def _released(setup: Setup, result: Result) -> Iterator[Release]:
    load = load_of(setup, result.steps)
    number_of_phases = len(result.snapshots) - 1
    for phase, snapshot in enumerate(result.snapshots[1:]):
        steps = [step for step in result.steps if step.phase <= phase]
        maximum = max(map(load, steps), default=0.0)
        ends = phase == number_of_phases - 1
        if not is_released(setup, steps, load) or not (maximum or ends):
            continue
        length = snapshot.height if setup.spring.has_tails else setup.outer_length(snapshot.x)
        yield Release(phase, snapshot, steps[-1], length, setup.spring.free_length - length)
