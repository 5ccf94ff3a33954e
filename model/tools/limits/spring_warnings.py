"""Warnings of a spring maker, each with its numbers; nothing here rejects a spring."""

from collections.abc import Iterator

import numpy as np

from coilset.meshes.springs.checks import TOUCH, coil_distances
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.warning import Warning

WIRE_USUAL = (0.07, 20.0)  # mm; EN 15800, table 1 and, from 16 mm on, annex A
ACTIVE_LEAST = 2.0  # EN 13906-1: number of active coils
TIP_LEAST = 0.25  # of the wire diameter
OFFSET_USUAL, TILT_USUAL = 0.1, 0.5  # of the wire diameter, and degrees: beyond, a scan was not set up on its axis


def spring_warnings(spring: Spring) -> list[Warning]:
    """All warnings about the unloaded spring itself; its index and its buckling are among the checks."""
    return [warning for check in (_wire, _solid_coils, _active, _ground, _axis) for warning in check(spring)]


def _wire(spring: Spring) -> Iterator[Warning]:
    """Lengths in metres or inches are most easily detected by the wire diameter."""
    t = spring.breaks
    wire, (low, high) = spring.wire_diameter(t), WIRE_USUAL
    i, limit = _farthest(wire, WIRE_USUAL)
    if limit is not None:
        yield Warning(
            "wire",
            "spring.wire_diameter",
            f"the wire is {wire[i]:.4g} mm thick at turn {t[i]:.3g}, outside the {low:g} to {high:g} mm usual in "
            "cold coiling (EN 15800); are all lengths in mm?",
            float(wire[i]),
            limit,
            "mm",
        )


def _farthest(values: np.ndarray, usual: tuple[float, float]) -> tuple[int, float | None]:
    """The number of the least value if it is below what is usual, else of the greatest; and the limit it is beyond."""
    low, high = usual
    if values.min() < low:
        return int(np.argmin(values)), low
    return int(np.argmax(values)), None if values.max() <= high else high


def _solid_coils(spring: Spring) -> Iterator[Warning]:
    t, distance, wire = coil_distances(spring)
    first = spring.bottom.end_turns + spring.bottom.transition_turns
    last = spring.turns - spring.top.end_turns - spring.top.transition_turns
    body = (t >= first) & (t + 1.0 <= last)
    solid = t[body & (distance < (1.0 + TOUCH) * wire)]
    if 1 < len(solid) < np.count_nonzero(body):  # where all touch the spring is closely wound, to be pulled or turned
        pitch = float(spring.pitch(solid).min())
        yield Warning(
            "solid coils",
            "spring.pitch",
            "coils of the body touch before any load, between turns "
            f"{solid[0]:.3g} and {solid[-1] + 1.0:.3g}; their pitch is {pitch:.4g} mm",
            pitch,
            unit="mm",
        )


def _active(spring: Spring) -> Iterator[Warning]:
    if spring.active_turns < ACTIVE_LEAST:
        yield Warning(
            "active turns",
            "spring.turns",
            f"only {spring.active_turns:.3g} active turns; formulas for rate "
            f"and stress need {ACTIVE_LEAST:g} or more (EN 13906-1)",
            spring.active_turns,
            ACTIVE_LEAST,
        )


def _ground(spring: Spring) -> Iterator[Warning]:
    for end, name, turn in ((spring.bottom, "bottom", 0.0), (spring.top, "top", spring.turns)):
        d = float(spring.wire_diameter(turn))
        if end.tip_thickness < TIP_LEAST:
            yield Warning(
                "ground tip",
                "spring.end_coils",
                f"the ground {name} end is {end.tip_thickness * d:.3g} mm "
                f"thick at its tip, less than a quarter of the wire ({TIP_LEAST * d:.3g} mm)",
                end.tip_thickness * d,
                TIP_LEAST * d,
                "mm",
            )
        flat = spring.flat_turns(name)
        if flat > end.end_turns + 1e-9:
            yield Warning(
                "ground flat",
                "spring.end_coils",
                f"the flat of the {name} end runs over {flat:.3g} turns "
                f"and cuts into the transition; its end turns are {end.end_turns:.3g}",
                flat,
                end.end_turns,
                "turns",
            )


def _axis(spring: Spring) -> Iterator[Warning]:
    """A scan that was moved far: its seats are perpendicular to the fitted axis, not to the file's."""
    axis, d = spring.measured_axis, float(spring.wire_diameter(0.5 * spring.turns))
    if axis is None:
        return
    moved = "the spring was moved onto the axis fitted to its points, to which the seats are perpendicular"
    if axis.offset > OFFSET_USUAL * d:
        text = f"the measured axis is {axis.offset:.3g} mm off the file's z axis at half height; {moved}"
        yield Warning("measured axis", "spring.file", text, axis.offset, OFFSET_USUAL * d, "mm")
    if axis.tilt > TILT_USUAL:
        text = f"the measured axis is tilted by {axis.tilt:.3g}° from the file's z axis; {moved}"
        yield Warning("measured axis", "spring.file", text, axis.tilt, TILT_USUAL, "degrees")
