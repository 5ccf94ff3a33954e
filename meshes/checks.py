"""What a spring maker would object to: errors that forbid a spring and warnings, each with its numbers."""

from dataclasses import dataclass

import numpy as np

from coilset.meshes.ends import touching_pitch
from coilset.meshes.steel import STEEL
from coilset.model.errors import InputError

INDEX_LEAST = 3.0
INDEX_USUAL = (4.0, 20.0)  # EN 15800, table 1: cold coiled springs
ACTIVE_LEAST = 2.0  # EN 13906-1: number of active coils
TIP_LEAST = 0.25
TOUCH = 0.01  # of a wire's diameter: what tables and the pitch of closed ends leave of exact touching
SEATING = 0.5  # EN 13906-1: seating coefficient ν of ends guided by parallel seats


@dataclass(frozen=True)
class Finding:
    """One objection: whether it forbids the spring, the entry it is about, and the text."""

    fatal: bool
    place: str
    text: str


def objections(spring):
    """All findings about a spring, the fatal ones first."""
    found = [finding for check in (_index, _coils, _block, _active, _ground, _buckling) for finding in check(spring)]
    return sorted(found, key=lambda finding: not finding.fatal)


def refuse(spring, place=None, file=""):
    """Raise `InputError` for the first fatal finding; return the spring if there is none.

    Args:
        spring: `Spring`.
        place: said in the place of the finding's own, for a spring that was not drawn.
        file: the file that the spring came from.
    """
    for finding in objections(spring):
        if finding.fatal:
            raise InputError(finding.text, finding.place if place is None else place, file)
    return spring


def coil_distances(spring):
    """Distance of the centre lines of neighbouring coils in the plane through the axis.

    Returns:
        Turns t, the distances between the turns t and t + 1, and the sums of the wire's radii there, mm; each of shape
        (n,), empty if the spring has less than one turn.
    """
    low = spring.breaks[spring.breaks <= spring.turns - 1]
    if spring.turns > 1:
        low = np.append(low, spring.turns - 1)
    up = low + 1
    distance = np.hypot(spring.mean_radius(up) - spring.mean_radius(low), spring.height(up) - spring.height(low))
    return low, distance, 0.5 * (spring.wire_diameter(up) + spring.wire_diameter(low))


def buckling_travel(spring, modulus_ratio=STEEL.shear_modulus / STEEL.young_modulus, seating=SEATING):
    """Travel at which a spring buckles, after EN 13906-1, mm; infinite if it never does.

    Args:
        spring: `Spring`; its least mean diameter counts.
        modulus_ratio: G/E.
        seating: ν of the standard, 0.5 for ends on parallel guided seats, 2 for one free end.
    """
    length, diameter = spring.free_length, 2 * np.min(spring.mean_radius(spring.breaks))
    γ = 1 - modulus_ratio
    under_root = 1 - γ / (0.5 + modulus_ratio) * (np.pi * diameter / (seating * length)) ** 2
    return length * 0.5 / γ * (1 - np.sqrt(under_root)) if under_root >= 0 else np.inf


def _index(spring):
    t = spring.breaks
    index = 2 * spring.mean_radius(t) / spring.wire_diameter(t)
    i = np.argmin(index) if index.min() < INDEX_USUAL[0] else np.argmax(index)
    if index[i] < INDEX_LEAST:
        yield Finding(
            True,
            "spring.mean_diameter",
            "the wire is thicker than the coil allows: "
            f"D/d = {index[i]:.3g} at turn {t[i]:.3g}, must be at least {INDEX_LEAST:g}",
        )
    elif not INDEX_USUAL[0] <= index[i] <= INDEX_USUAL[1]:
        yield Finding(
            False,
            "spring.mean_diameter",
            f"D/d = {index[i]:.3g} at turn {t[i]:.3g} is outside of the "
            f"{INDEX_USUAL[0]:g} to {INDEX_USUAL[1]:g} usual in cold coiling (EN 15800)",
        )


def _coils(spring):
    turn, distance, wire = coil_distances(spring)
    if len(turn) == 0:
        return
    gap = distance - wire
    i = np.argmin(gap / wire)
    if gap[i] < -TOUCH * wire[i]:
        yield Finding(
            True,
            "spring",
            f"coils overlap: between the turns {turn[i]:.3g} and {turn[i] + 1:.3g} the "
            f"centres of the wire are {distance[i]:.3g} mm apart, must be at least {wire[i]:.3g} mm",
        )
        return
    t = spring.breaks
    body = (t >= spring.bottom.end_turns + spring.bottom.transition_turns) & (
        t <= spring.turns - spring.top.end_turns - spring.top.transition_turns
    )
    play = spring.pitch(t) - touching_pitch(spring.wire_diameter(t), spring.slope(t))
    solid = t[body & (play < TOUCH * spring.wire_diameter(t))]
    if len(solid) > 1:
        yield Finding(
            False,
            "spring.pitch",
            f"coils of the body are solid before any load, between the turns "
            f"{solid[0]:.3g} and {solid[-1]:.3g}; their pitch is {spring.pitch(solid).min():.4g} mm",
        )


def _block(spring):
    travel = spring.free_length - spring.block_height
    if travel <= TOUCH * np.max(spring.wire_diameter(spring.breaks)):
        yield Finding(
            True,
            "spring",
            f"there is no travel: the free length is {spring.free_length:.4g} mm, the block "
            f"length {spring.block_height:.4g} mm",
        )


def _active(spring):
    if spring.active_turns < ACTIVE_LEAST:
        yield Finding(
            False,
            "spring.turns",
            f"only {spring.active_turns:.3g} active turns; formulas for rate and "
            f"stress need {ACTIVE_LEAST:g} or more (EN 13906-1)",
        )


def _ground(spring):
    for end, name, turn in ((spring.bottom, "bottom", 0.0), (spring.top, "top", spring.turns)):
        if end.tip_thickness < TIP_LEAST:
            d = spring.wire_diameter(turn)
            yield Finding(
                False,
                "spring.end_coils",
                f"the ground {name} end is {end.tip_thickness * d:.3g} mm thin at "
                f"its tip, less than a quarter of the wire ({TIP_LEAST * d:.3g} mm)",
            )
        flat = spring.flat_turns(name)
        if flat > end.end_turns + 1e-9:
            yield Finding(
                False,
                "spring.end_coils",
                f"the flat of the {name} end runs over {flat:.3g} turns and cuts "
                f"into the transition; its end turns are {end.end_turns:.3g}",
            )


def _buckling(spring):
    travel, limit = spring.free_length - spring.block_height, buckling_travel(spring)
    if limit < travel:
        slender = spring.free_length / (2 * np.min(spring.mean_radius(spring.breaks)))
        yield Finding(
            False,
            "spring.free_length",
            f"slender, L0/D = {slender:.3g}: unguided it buckles at "
            f"{limit:.3g} mm of travel on parallel seats, before its block at {travel:.3g} mm (EN 13906-1)",
        )
