"""Stresses and plastic work on the wire's surface in the snapshots of a run: the largest, and where."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from coilset.model.core.results import surface
from coilset.model.core.results.records.record import Result, Setup, Snapshot

SAME_TURN = 1e-6  # turns: sections at the end of one element and at the start of the next one are nearer


def is_middle(setup: Setup) -> np.ndarray:
    """Whether sections are in the middle turns: a turn from the tips, or from the end coils of closed ends."""
    return _beyond_middle(setup) <= 0.0


def _beyond_middle(setup: Setup) -> np.ndarray:
    return surface.beyond_middle(setup.section_turns, *setup.spring.middle)


def shear_peak(setup: Setup, snapshot: Snapshot, ends: bool = False) -> surface.Peak:
    """The maximum shear stress on the wire's surface in the middle turns or, on request, in the end turns.

    The surface value is a property of the spring. The core holds a larger residual shear stress, but the value found
    there depends on the position of the section points.
    """
    among = is_middle(setup) != ends
    stress = surface.shear(snapshot.surface_state, snapshot.components)
    return surface.peak(stress[among], setup.section_turns[among], setup.inside)


def peak_entries(name: str, top: surface.Peak | None, unit: str = "MPa") -> dict[str, Any]:
    """Entries of the summary on a peak: its value, its turn, and its angle from the coil's inside; None without it."""
    names = (f"{name}_{end}" for end in (unit, "turn", "angle_deg"))
    return dict(zip(names, (None,) * 3 if top is None else (top.value, top.turn, top.angle), strict=True))


def ends_peak(setup: Setup, released: Snapshot | None) -> surface.Peak | None:
    """That of the ends' turns; None before the release, and of half a turn or less, all of which is its middle."""
    return None if released is None or is_middle(setup).all() else shear_peak(setup, released, ends=True)


def shear_inside(setup: Setup, snapshot: Snapshot) -> tuple[float, float]:
    """Shear stress on the wire's surface at the inside of the coil, MPa, positive as in a compressed spring; its turn.

    The value of largest magnitude in the middle turns; of several that are equal but for rounding, as in a spring whose
    halves are alike, the first.
    """
    values = _shear_inside(setup, snapshot)
    at = _largest(values)
    return float(values[at]), float(setup.section_turns[is_middle(setup)][at])


def shear_inside_median(setup: Setup, snapshot: Snapshot) -> float:
    """The median of the same along the middle turns, MPa."""
    return float(np.median(_shear_inside(setup, snapshot)))


def to_the_end(setup: Setup, snapshot: Snapshot) -> float:
    """By how much `shear_inside` changes up to the end of the middle turns, MPa, on the straight line through the two
    last sections; 0 where a section before the last has the largest value."""
    values, middle = _shear_inside(setup, snapshot), is_middle(setup)
    at, turns, rest = _largest(values), setup.section_turns[middle], -_beyond_middle(setup)[middle]
    apart = np.abs(turns - turns[at])
    others = np.flatnonzero(apart > SAME_TURN)
    if not len(others) or min(turns[at] - turns.min(), turns.max() - turns[at]) > SAME_TURN:
        return 0.0
    near = others[np.argmin(apart[others])]
    return float(abs(values[near] - values[at]) / apart[near] * rest[at])


def jump(setup: Setup, snapshot: Snapshot) -> float:
    """By how much `shear_inside` jumps from one element to the next beside its largest value, MPa.

    In the spring it is continuous; of three borders the largest jump, as that at a plane of symmetry is none.
    """
    values, turns = _shear_inside(setup, snapshot), setup.section_turns[is_middle(setup)]
    borders = np.flatnonzero(np.abs(np.diff(turns)) < SAME_TURN)
    jumps = np.abs(np.diff(values))[borders]
    nearest = np.argsort(np.abs(turns[borders] - turns[_largest(values)]), kind="stable")[:3]
    return float(jumps[nearest].max(initial=0.0))


def change_of_sign(setup: Setup, snapshot: Snapshot, error: float) -> float:
    """By how much `shear_inside` changes, MPa, where the largest value of the other sign replaces it; 0 where that is
    smaller by more than the error of both."""
    values = _shear_inside(setup, snapshot)
    largest = sorted((abs(float(values.min(initial=0.0))), float(values.max(initial=0.0))))
    return sum(largest) if 0.0 < largest[1] < largest[0] + 2.0 * error else 0.0


def _largest(values: np.ndarray) -> int:
    """The first of the values of largest magnitude."""
    size = np.abs(values)
    return int(np.argmax(size >= (1.0 - surface.TIE) * size.max()))


def _shear_inside(setup: Setup, snapshot: Snapshot) -> np.ndarray:
    return setup.inside.shear(snapshot.surface_state, snapshot.components)[is_middle(setup)]


def bending(setup: Setup, prefix: str, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """Stress along the wire on the surface at the inside and the outside of the coil, MPa, positive in tension.

    Of each the value of largest magnitude in the middle turns and the snapshots; None without snapshots.
    """
    found: dict[str, Any] = {}
    for name, angle in (("inside", 0.0), ("outside", math.pi)):
        values = []
        for shot in snapshots:
            along = surface.component(shot.surface_state, shot.components, "s11")[is_middle(setup)]
            place = round((setup.inside.angle + angle) / (2.0 * math.pi) * along.shape[-1]) % along.shape[-1]
            values += [float(along[..., place].min()), float(along[..., place].max())]
        found[f"{prefix}bending_{name}_MPa"] = max(values, key=abs, default=None)
    return found


def beyond_coil(setup: Setup, released: Snapshot | None, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """Stress along the wire of hooks or arms, MPa, positive in tension, and its turn; the residual one at that place.

    The value of largest magnitude on their surface in any snapshot, in tension where compression is not larger by more
    than rounding: straight wire in bending has both. None without hooks or arms.
    """
    names = "tail_stress_max_MPa", "tail_stress_max_turn", "residual_tail_stress_MPa"
    among = (setup.section_turns < 0.0) | (setup.section_turns > setup.spring.turns)
    if not among.any():
        return dict.fromkeys(names)

    def along(shot: Snapshot) -> np.ndarray:
        return surface.component(shot.surface_state, shot.components, "s11")[among]

    stress = max(map(along, snapshots), key=lambda values: float(np.abs(values).max()))
    in_tension = stress.max() >= -(1.0 - surface.TIE) * stress.min()
    at, angle = np.unravel_index(_largest(np.maximum(stress, 0.0) if in_tension else stress), stress.shape)
    residual = None if released is None else float(along(released)[at, angle])
    return dict(zip(names, (float(stress[at, angle]), float(setup.section_turns[among][at]), residual), strict=True))


def peaks(setup: Setup, prefix: str, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """The maximum shear and equivalent stress on the surface in the snapshots; None without snapshots."""
    found: dict[str, Any] = {}
    for name, stress in (("shear", surface.shear), ("equivalent", surface.equivalent)):
        tops = [
            surface.peak(stress(shot.surface_state, shot.components), setup.section_turns, setup.inside)
            for shot in snapshots
        ]
        found |= peak_entries(f"{prefix}{name}_surface_max", max(tops, key=lambda one: one.value, default=None))
    return found


def plastic_work(setup: Setup, result: Result) -> dict[str, Any]:
    """The maximum plastic work b* on the surface, where it is, and up to which the material's constants are valid."""
    tops = [
        surface.peak(surface.component(shot.surface_state, shot.components, "b"), setup.section_turns, setup.inside)
        for shot in result.snapshots
    ]
    top = max(tops, key=lambda one: one.value)
    return {
        **peak_entries("plastic_work_max", top if top.value > 0.0 else None, "N_per_mm2"),
        "plastic_work_max_N_per_mm2": max([top.value, *(step.plastic_work_max_N_per_mm2 for step in result.steps)]),
        "plastic_work_known_to_N_per_mm2": setup.limits.plastic_work,
    }
