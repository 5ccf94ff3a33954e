"""What a load program does to its spring: presses, pulls or turns it."""

from typing import Literal

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.case.case import Case
from coilset.model.core.case.phases import heads_of

AT_REST = 1e-9  # of the free length: a target that does not load the spring along its axis


def _loads(case: Case, spring: Spring) -> list[float]:
    """Travels, mm, and forces, N, that a load program goes to; compression is positive."""
    goals = (phase.goal(spring.free_length, spring.block_height) for phase in case.targets)
    return [spring.free_length - value if kind == "height" else value for kind, value in goals]


def pulls(case: Case, spring: Spring) -> bool:
    """Whether a load program pulls the spring and never compresses it; without one, whether its drawing shows so."""
    if not case.loading:
        return _has(spring, "hooks") or (spring.wound_solid and not _has(spring, "arms"))
    loads = _loads(case, spring)
    return min(loads, default=0.0) < 0.0 and max(loads) <= 0.0


def is_pressed(case: Case, spring: Spring) -> bool:
    """Whether it is a compression spring: with travel and without hooks or arms, and neither pulled nor turned by its
    load program."""
    return not (spring.has_tails or spring.wound_solid or pulls(case, spring) or is_turned(case, spring))


def is_turned(case: Case, spring: Spring) -> bool:
    """Whether a load program turns the spring, by a rotation or a torque, and neither presses nor pulls it; without
    one, whether it has arms."""
    if not case.loading:
        return _has(spring, "arms")
    return bool(rotations(case, spring) or torques(case, spring))


def _has(spring: Spring, name: Literal["hooks", "arms"]) -> bool:
    return any(tail is not None and tail.pulled == (name == "hooks") for tail in spring.tails)


def rotations(case: Case, spring: Spring) -> tuple[float, ...]:
    """Rotations that a load program goes to, degrees, positive in the winding direction; none of one with a travel."""
    return _about_axis(case, spring, "turn")


def torques(case: Case, spring: Spring) -> tuple[float, ...]:
    """Torques that it goes to, N mm, likewise."""
    return _about_axis(case, spring, "torque")


def _about_axis(case: Case, spring: Spring, name: str) -> tuple[float, ...]:
    """Targets of the heads about the axis, by the name of the entry."""
    if any(abs(load) > AT_REST * spring.free_length for load in _loads(case, spring)):
        return ()
    found: list[float] = []
    for phase in case.loading:
        for end, target in heads_of(phase).items():
            value = getattr(target, name)
            if isinstance(value, float) and value:
                value *= spring.hand * (1.0 if end == "top" else -1.0)
                found += [] if value in found else [value]
    return tuple(found)
