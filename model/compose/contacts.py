"""The contacts of a spring: coil on coil, and its seats."""

from collections.abc import Collection
from typing import Any

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.package import package
from coilset.model.core.contact.base import ENDS, LEVEL, SEAT_DOFS, Contact
from coilset.model.core.contact.coils import Coils
from coilset.model.core.contact.curve import CentreLine, WirePoints
from coilset.model.core.contact.seat import Seat

# Default bedding is E/4: wires that flatten where they touch along a line have E/7.5 to E/4.9 (docs/contact.md).
MODULUS_OF_BEDDING = 4.0
FREE_TILT_OF_BEDDING = 1e-8  # stiffness of a joint that is free to tilt, relative to that of the coil's bedding, b r³
GUIDES = "arbor", "sleeve"
ONSET_OF_DIAMETER = 1e-3  # distance over which contact sets in, in wire diameters
# The doors to contacts that not every spring has.
FACES, FRICTION, GAPS, HOLD = (
    f"coilset.model.physics.{name}"
    for name in ("outlines.faces", "friction.friction", "guides.thesis_gaps", "guides.hold")
)


def build_contacts(
    contact: Any,
    seats: Any,
    spring: Spring,
    turns: np.ndarray,
    stations: np.ndarray,
    E: float,
    moving: Collection[str] = (),
) -> list[Contact]:
    """Contacts of a spring.

    Args:
        contact: the `contact` section of a case: kind and stiffness of the contact, friction.
        seats: the `seats` section of a case, or None between clamped ends.
        turns: of the stations, shape (n,).
        stations: positions, shape (n, 3), mm.
        E: Young's modulus, for the default bedding, MPa.
        moving: ends whose seats a load program moves otherwise than along the axis.

    Returns:
        List of Contacts.

    Raises:
        InputError: if a seat or a gap element does not fit to the wire or its mesh.
    """
    bedding = bedding_of(contact, E)
    radius, lengths = 0.5 * spring.wire_diameter(turns), np.diff(spring.arc_length(turns))
    onset = ONSET_OF_DIAMETER * 2.0 * float(radius.min())
    points = CentreLine(turns, radius, lengths).points()
    contacts: list[Contact] = []
    if contact.coils == "gaps":
        gaps = package(GAPS, "a gap element", "contact.coils")
        contacts.append(gaps.gaps_one_turn_apart(turns, radius, lengths, bedding, onset))
    elif spring.section is None:
        contacts.append(Coils(points, stations, bedding, onset))
    else:
        faces = package(FACES, "wire that is not round", "spring.wire")
        contacts.append(faces.FacedCoils(points, stations, bedding, onset, spring.section))
    if seats is not None:
        for end in ENDS:
            contacts += build_seat(end, seats, spring, points, stations, (bedding, onset), end in moving)
    for end, tail, x in zip(ENDS, spring.tails, stations[[0, -1]], strict=True):
        if tail is not None and tail.on_point:
            along = tail.along(tail.marks[-1:], 1)[0]
            support = package(HOLD, "an arm that a point holds", "spring.arms").Support
            contacts.append(support(end, points, stations, bedding, np.tile([0.0, 0.0, x[2], 0.0, 0.0, 0.0], 2), along))
    for name in GUIDES:
        diameter = getattr(contact, name)
        if diameter is not None:
            refuse_overlap(name, diameter, stations, radius)
            guide = package(HOLD, "an arbor or a sleeve", f"contact.{name}").Guide
            contacts.append(guide(name, points, 0.5 * diameter, bedding, onset))
    friction = contact.friction
    if friction.seats or friction.coils or friction.guides:
        frictions = package(FRICTION, "friction", "contact.friction").frictions
        contacts += frictions(friction, contacts, stations, seats_at(spring.free_length))
    return contacts


def bedding_of(contact: Any, E: float) -> float:
    """Stiffness of the bedding, N/mm per mm, that the `contact` section of a case gives, or by default; E in MPa."""
    return float(contact.bedding or E / MODULUS_OF_BEDDING)


def refuse_overlap(name: str, diameter: float, stations: np.ndarray, radius: np.ndarray) -> None:
    """Reject an arbor or sleeve that does not fit to the unloaded coils.

    Raises:
        InputError: with the diameter at which it does.
    """
    away = np.hypot(stations[:, 0], stations[:, 1])
    inside, outside = 2.0 * float((away - radius).min()), 2.0 * float((away + radius).max())
    if name == "arbor" and diameter > inside:
        raise InputError(f"{diameter:g} mm do not fit into coils of {inside:.4g} mm inside", "contact.arbor")
    if name == "sleeve" and diameter < outside:
        raise InputError(f"{diameter:g} mm do not fit around coils of {outside:.4g} mm", "contact.sleeve")


def seats_at(level: float) -> np.ndarray:
    """Both seats as they just touch the stress-free spring, shape (12,), mm and rad."""
    start = np.zeros(2 * SEAT_DOFS)
    start[SEAT_DOFS + LEVEL] = level
    return start


def build_seat(
    end: str,
    seats: Any,
    spring: Spring,
    points: WirePoints,
    stations: np.ndarray,
    stiffness: tuple[float, float],
    driven: bool = False,
) -> list[Contact]:
    """The seat of an end, with its groove and the springs that support it.

    Args:
        end: `bottom` or `top`.
        seats: the `seats` section of a case.
        stations: positions, shape (n, 3), mm.
        stiffness: of the bedding, N/mm per mm, and its onset, mm.
        driven: whether a load program moves the seat otherwise than along the axis.

    Raises:
        InputError: if a seat's step is longer than the wire.
    """
    side, start = getattr(seats, end), seats_at(spring.free_length)
    bedding, onset = stiffness
    for turns, entry in ((side.turns, f"seats.{end}.turns"), (seats.groove, "seats.groove")):
        if turns is not None and turns > spring.turns:
            raise InputError(f"{turns:g}: the spring has {spring.turns:g} turns only", entry)
    reach, step, moves = spring.seat_distance(points.turns, end), side.turns or 0.0, side.moves or driven
    if spring.section is None or side.slope or moves:
        contacts: list[Contact] = [
            Seat(end, points, reach, stations, start, bedding, onset, side.slope, step, moves),
        ]
    else:
        faces = package(FACES, "wire that is not round", "spring.wire")
        arms = faces.seat_arms(spring.section, reach, points.radius, 1.0 if end == "bottom" else -1.0)
        contacts = [faces.FacedSeat(end, points, reach, stations, start, bedding, onset, arms, step)]
    if seats.hold == "groove":
        groove = package(HOLD, "a groove", "seats.hold").Groove
        contacts.append(groove(end, points, seats.groove_turns, stations, bedding, start))
    if side.moves:
        mount = np.zeros(SEAT_DOFS)
        if side.tilt == "free":
            mount[3:5] = FREE_TILT_OF_BEDDING * bedding * float(spring.mean_radius(points.turns).mean()) ** 3
        for dof, k in side.springs().items():
            mount[dof] = k
        contacts.append(package(HOLD, "a seat that moves", f"seats.{end}").Mount(end, len(stations), mount, start))
    return contacts
