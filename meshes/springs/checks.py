"""What rules a spring out: a wire too thick for its coils, overlapping coils."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from coilset.meshes.springs.block import TOUCH
from coilset.meshes.springs.ends import touching_pitch
from coilset.model.core.base.errors import InputError

if TYPE_CHECKING:
    from coilset.meshes.springs.geometry import Spring

INDEX_LEAST = 3.0


@dataclass(frozen=True)
class Fault:
    """One reason why a spring is impossible: the entry concerned, and the text."""

    place: str
    text: str


def faults(spring: "Spring") -> Iterator[Fault]:
    """The reasons why a spring is impossible, one after the other; its coils may touch, as wound onto each other."""
    for check in (_index, _coils):
        yield from check(spring)


def refuse(spring: "Spring", place: str | None = None, file: str = "") -> "Spring":
    """Raise `InputError` for the first fault; return the spring if there is none.

    Args:
        spring: `Spring`.
        place: reported instead of the fault's own, for a spring not defined by drawing entries.
        file: the file that the spring came from.
    """
    for fault in faults(spring):
        raise InputError(fault.text, fault.place if place is None else place, file)
    return spring


def coil_distances(spring: "Spring") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Distances between the centre lines of neighbouring coils in the plane through the axis.

    Returns:
        Turns t, the distances between the turns t and t + 1, and the sums of the wire's radii there, mm; each of shape
        (n,), empty if the spring has less than one turn. Of wire that is not round, the distances along the axis, which
        are infinite where coils pass each other, and those at which the coils touch.
    """
    low = spring.breaks[spring.breaks <= spring.turns - 1]
    if spring.turns > 1:
        low = np.append(low, spring.turns - 1)
    up = low + 1
    aside, rise = spring.aside(low, up), spring.height(up) - spring.height(low)
    wire = 0.5 * (spring.wire_diameter(up) + spring.wire_diameter(low))
    if spring.section is None:
        return low, np.hypot(aside, rise), wire
    touching = touching_pitch(wire, aside, spring.section)
    return low, np.where(touching > 0.0, rise, np.inf), np.where(touching > 0.0, touching, wire)


def _index(spring: "Spring") -> Iterator[Fault]:
    t = spring.breaks
    index = 2 * spring.mean_radius(t) / (spring.wire_diameter(t) * max(1.0, spring.width))
    i = np.argmin(index)
    if index[i] < INDEX_LEAST:
        yield Fault(
            "spring.mean_diameter",
            "the wire is thicker than the coil allows: "
            f"D/d = {index[i]:.3g} at turn {t[i]:.3g}, must be at least {INDEX_LEAST:g}",
        )


def _coils(spring: "Spring") -> Iterator[Fault]:
    turn, distance, wire = coil_distances(spring)
    if len(turn) == 0:
        return
    gap = distance - wire
    i = np.argmin(gap / wire)
    if gap[i] < -TOUCH * wire[i]:
        yield Fault(
            "spring",
            f"coils overlap: between the turns {turn[i]:.3g} and {turn[i] + 1:.3g} the "
            f"centres of the wire are {distance[i]:.3g} mm apart, must be at least {wire[i]:.3g} mm",
        )
