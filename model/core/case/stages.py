"""The phases of a case as stages of the load program."""

from collections.abc import Sequence
from typing import Literal

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.body.body import SECONDS
from coilset.model.core.case.phases import AnyPhase, TimePhase, drives_at
from coilset.model.core.equilibrium.path.program import Stage


def stage_of(loading: Sequence[AnyPhase], number: int, spring: Spring, timeless: bool = False) -> Stage:
    """A phase by its number, for the load program of a spring; `timeless`: phases to a target take no time."""
    phase, drives = loading[number], drives_at(loading, number)
    steps = tuple(phase.steps) if isinstance(phase.steps, list) else phase.steps
    if isinstance(phase, TimePhase):
        time = phase.duration
        return Stage(time.keep, None, steps, phase.label, time.length, phase.temperature, drives=drives)
    hours = 0.0 if timeless else (phase.seconds or 0.0) / SECONDS
    kind: Literal["height", "force"] = "height"
    value: float | None = None
    if phase.drives_axially:
        kind, value = phase.goal(spring.free_length, spring.block_height)
    elif number:  # as the last phase left it
        kind = stage_of(loading, number - 1, spring).kind
    return Stage(kind, value, steps, phase.label, hours, even=True, drives=drives)
