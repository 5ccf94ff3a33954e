"""The contacts of a spring: coil on coil, and its seats."""

import numpy as np

from coilset.model.contact.base import ENDS, LEVEL, SEAT_DOFS
from coilset.model.contact.centreline import CentreLine
from coilset.model.contact.coils import Coils
from coilset.model.contact.friction import CoilFriction, SeatFriction
from coilset.model.contact.gap import Gaps
from coilset.model.contact.hold import Groove, Mount
from coilset.model.contact.seat import Seat
from coilset.model.errors import InputError

SOFTNESS = 40.0  # default bedding is E/40: a wire of steel sinks in by some thousandths of its diameter at block
SOFT = 1e-7  # stiffness of a joint that is free to tilt, against that of the coil's bedding, b r³
ONSET = 1e-3  # way over which contact sets in, in wire diameters


def build_contacts(case, spring, turns, stations, E):
    """Contacts of a spring.

    Args:
        case: Case, of which `contact`, `ends` and `seats` are asked for.
        spring: Spring.
        turns: of the stations, shape (n,).
        stations: positions, shape (n, 3), mm.
        E: Young's modulus, for the default bedding, MPa.

    Returns:
        List of Contacts.
    """
    spec, bedding = case.contact, case.contact.bedding or E / SOFTNESS
    radius, lengths = 0.5 * spring.wire_diameter(turns), np.diff(spring.arc_length(turns))
    onset = ONSET * 2.0 * float(radius.min())
    points = CentreLine(turns, radius, lengths).points()
    if spec.coils == "closest":
        contacts = [Coils(points, stations, bedding, onset)]
    else:
        contacts = [gaps_one_turn_apart(turns, radius, lengths, bedding, onset)]
    if case.ends == "seats":
        for end in ENDS:
            contacts += build_seat(end, getattr(case.seats, end), case.seats, spring, points, stations, bedding, onset)
    return contacts + frictions(spec.friction, contacts, stations, seats_at(spring.free_length))


def seats_at(level):
    """Both seats as they just touch the stress-free spring, shape (12,), mm and rad."""
    start = np.zeros(2 * SEAT_DOFS)
    start[SEAT_DOFS + LEVEL] = level
    return start


def frictions(spec, contacts, stations, seats):
    """The frictions of contacts, where there are any."""
    kinds = ((Seat, SeatFriction, spec.seats), (Coils, CoilFriction, spec.coils))
    return [
        friction(contact, mu, stations, seats)
        for contact in contacts
        for kind, friction, mu in kinds
        if isinstance(contact, kind) and mu
    ]


def build_seat(end, one, both, spring, points, stations, bedding, onset):
    """The seat of an end, with its groove and the springs on which it stands.

    Args:
        end: `bottom` or `top`.
        one, both: SeatSpec of this seat and SeatsSpec.
        spring: Spring.
        points: WirePoints.
        stations: positions, shape (n, 3), mm.
        bedding: N/mm per mm.
        onset: mm.

    Raises:
        InputError: if its step is longer than the wire.
    """
    start = seats_at(spring.free_length)
    for turns, place in ((one.turns, f"seats.{end}.turns"), (both.groove, "seats.groove")):
        if turns is not None and turns > spring.turns:
            raise InputError(f"{turns:g}: the spring has {spring.turns:g} turns only", place)
    reach = spring.seat_distance(points.turns, end)
    contacts = [Seat(end, points, reach, stations, start, bedding, onset, one.slope, one.turns or 0.0, one.moves)]
    if both.hold == "groove":
        contacts.append(Groove(end, points, both.groove_turns, stations, bedding, start))
    if one.moves:
        stiffness = np.zeros(SEAT_DOFS)
        if one.tilt == "free":
            stiffness[3:5] = SOFT * bedding * float(spring.mean_radius(points.turns).mean()) ** 3
        for dof, k in one.springs().items():
            stiffness[dof] = k
        contacts.append(Mount(end, len(stations), stiffness, start))
    return contacts


def gaps_one_turn_apart(turns, radius, lengths, bedding, onset):
    """The thesis's gap elements between stations that lie above each other."""
    share = bedding * 0.5 * (np.append(lengths, 0.0) + np.append(0.0, lengths))  # of each station
    lower = np.flatnonzero(turns <= turns[-1] - 1.0 + 1e-9)
    upper = np.searchsorted(turns, turns[lower] + 1.0 - 1e-9)
    return Gaps(np.stack([lower, upper], axis=1), radius[lower] + radius[upper], share[lower], onset)
