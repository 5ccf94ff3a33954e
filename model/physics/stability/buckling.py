"""Where a spring buckled, and where one only leans, from the steps of its run, so that a resumed run agrees.

A spring that is compressed buckles at the first point of its path at which an equilibrium becomes unstable, the force
passes a maximum, or the spring would fork if nothing pushed its axis aside; its axis moves aside quickly there.
docs/theory/stability.md derives what is used here.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import nan
from typing import NamedTuple

import numpy as np

from coilset.model.core.results.records.record import Step

SIDEWAYS = 0.05  # of the mean diameter: an axis that is farther aside leans, or has buckled
# Growth of the offset over the mean diameter by that of the travel over itself: springs that lean have up to 0.1 before
# their coils close, those that buckle 0.7 (wire that yields) to 8.
FAST = 0.5
AHEAD = 0.01  # of the travel, over which that growth is measured at least
REGAIN = 0.05  # of the travel: force that coils lose as they slip or lift off a seat is regained before
ALIKE = 0.02  # of the travel, by which forks from two threes of states in a row may differ
SINGULAR = 1e12  # condition number of states that show no fork
RESOLVED = 0.02  # of the travel: longer steps in which a spring buckles are cut
# Of force times mean diameter. Springs that snapped set 3e-6 and more free; coils that slide over each other set 2e-10
# free and less where they pass from one cubic of the wire's curve to the next, whose curvature jumps there.
SNAPPED = 1e-8


@dataclass(frozen=True)
class Buckling:
    """Where a spring buckled.

    Attributes:
        travel_mm, force_N: of the same point: a state of the run, or a point between two.
        offset_mm: maximum distance of its axis from the straight one after that.
    """

    travel_mm: float
    force_N: float
    offset_mm: float


class State(NamedTuple):
    """A state of the path: travel, mm; force, N; offset of the axis, mm; whether another path was left for it."""

    travel: float
    force: float
    offset: float
    left: bool = False


def state_of(step: Step) -> State:
    """What a step says about buckling; a state that is unstable has no path on."""
    left = step.negative_pivots > 0 or step.left_branch > 0
    return State(step.travel_mm, step.force_N, step.axis_offset_mm, left)


def buckling(steps: Sequence[Step], diameter: float) -> Buckling | None:
    """The Buckling found in a run, or None.

    Args:
        steps: Steps up to now.
        diameter: mean diameter of the coil, mm.
    """
    for path in _compressions(map(state_of, steps)):
        found = min((place for place in _places(path, diameter) if _moves_aside(path, place, diameter)), default=None)
        if found is not None:
            aside = max(state.offset for state in path if state.travel > found.travel)
            return Buckling(found.travel, found.force, aside)
    return None


def is_skipped(steps: Sequence[Step], trial: State, diameter: float) -> bool:
    """Whether a step to `trial` is too long to show where the spring buckles: it buckles there, or its axis leaves.

    Args:
        steps: Steps up to now.
        trial: State after the next one.
        diameter: mean diameter of the coil, mm.
    """
    found = buckling(steps, diameter)
    if found is not None and trial.travel > (1.0 + REGAIN) * found.travel_mm:
        return False
    states = [State(0.0, 0.0, 0.0), *map(state_of, steps)]
    before, far = states[-1], SIDEWAYS * diameter
    if trial.force <= 0.0 or trial.travel - before.travel <= RESOLVED * trial.travel:
        return False
    if before.offset <= far < trial.offset and (not steps or _is_fast(before, trial, trial.travel, diameter)):
        return True
    paths = list(_compressions([*states[1:], trial]))
    if not paths:  # it does not get shorter, as one that is turned
        return False
    path = paths[-1]
    last = path[-3:]
    places = [*_ends(path), *(_forks(last, diameter) if len(last) == 3 else ())]
    return any(place.travel >= last[0].travel and _moves_aside(path, place, diameter) for place in places)


def leaning(steps: Sequence[Step], diameter: float) -> Step | None:
    """The step with the greatest offset of an axis that leans although the spring does not buckle; else None.

    Args:
        steps: Steps up to now.
        diameter: mean diameter of the coil, mm.
    """
    pressed = [step for step in steps if step.force_N > 0.0]
    far = max(pressed, key=lambda step: step.axis_offset_mm, default=None)
    if far is None or far.axis_offset_mm <= SIDEWAYS * diameter or buckling(steps, diameter) is not None:
        return None
    return far


# ---- the path of a compression ---------------------------------------------------------------------------------------


def _compressions(states: Iterable[State]) -> Iterator[list[State]]:
    """Parts of the path along which a spring gets shorter and presses, each with the state before it."""
    path: list[State] = []
    before = State(0.0, 0.0, 0.0)
    for now in states:
        if now.travel > before.travel and now.force > 0.0:
            path = path or [before]
            path.append(now)
        elif path:
            yield path
            path = []
        before = now
    if path:
        yield path


def _places(path: Sequence[State], diameter: float) -> Iterator[State]:
    """Where a spring may buckle; a fork must show in the next three states, or in those before, too."""
    yield from _ends(path)
    threes = list(zip(path, path[1:], path[2:], strict=False))
    travels = [fork(three)[0] for three in threes]
    for number, three in enumerate(threes):
        beside = [*travels[max(number - 1, 0) : number], *travels[number + 1 : number + 2]]
        if any(abs(travel - travels[number]) < ALIKE * travel for travel in beside):
            yield from _forks(three, diameter)


def _forks(three: Sequence[State], diameter: float) -> Iterator[State]:
    """The fork between three states, if there is one, once the axis is visibly aside."""
    travel, bend, push = fork(three)
    if bend > 0.0 < push and three[0].travel <= travel <= three[2].travel and three[2].offset > SIDEWAYS * diameter:
        travels, forces, offsets = np.array(three)[:, :3].T
        yield State(travel, float(np.interp(travel, travels, forces)), float(np.interp(travel, travels, offsets)))


def _ends(path: Sequence[State]) -> Iterator[State]:
    """The states before another path is taken, and those of greatest force."""
    for number, (before, now) in enumerate(pairwise(path)):
        if now.left and not before.left:
            yield before if number else now
        if now.force < before.force and _stays_below(path[number + 1 :], before):
            yield before


def _stays_below(later: Sequence[State], top: State) -> bool:
    """Whether the force does not regain that of `top` over the next part of the travel, as far as it is known."""
    end = (1.0 + REGAIN) * top.travel
    known = [state for state in later if state.travel <= end]
    return all(state.force < top.force for state in known or later[:1])


def _moves_aside(path: Sequence[State], place: State, diameter: float) -> bool:
    """Whether the axis moves aside quickly from a place on, and far."""
    later = [state for state in path if state.travel > place.travel]
    if max((state.offset for state in later), default=0.0) <= SIDEWAYS * diameter:
        return False
    before = path[-len(later) - 1]
    least = before.travel + AHEAD * place.travel
    after = next((state for state in later if state.travel >= least), later[-1]._replace(travel=least))
    return _is_fast(before, after, place.travel, diameter)


def _is_fast(before: State, after: State, travel: float, diameter: float) -> bool:
    """Whether the axis moves aside quickly between two states, near a travel, mm."""
    return (after.offset - before.offset) * travel > FAST * diameter * (after.travel - before.travel)


def fork(three: Sequence[State]) -> tuple[float, float, float]:
    """Travel s_c at which a spring would fork if nothing pushed its axis aside, and b, c, from three states; else NaN.

    With the travel s, the offset w and a push in proportion to the load, Koiter's symmetric fork is

        (s_c − s + b w²) w = c s,  or  s_c w + b w³ − c s = s w,

    linear in s_c, b and c. A spring follows it if b and c are positive.
    """
    s, w = (np.array([state[k] for state in three]) for k in (0, 2))
    if s[0] <= 0.0 or w[0] <= 0.0 or np.any(np.diff(w) <= 0.0):
        return nan, nan, nan
    (S, W), s, w = (s[2], w[2]), s / s[2], w / w[2]  # travels and offsets may differ by orders of magnitude
    matrix = np.stack([w, w**3, -s], axis=1)
    if np.linalg.cond(matrix) > SINGULAR:
        return nan, nan, nan
    travel, bend, push = np.linalg.solve(matrix, s * w)
    return float(travel * S), float(bend * S / W**2), float(push * W)


def snapped(step: Step, diameter: float) -> bool:
    """Whether the spring snapped through before this step and released a significant energy."""
    return step.left_branch > 0 and step.released_energy_Nmm > SNAPPED * abs(step.force_N) * diameter
