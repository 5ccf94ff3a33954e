"""The contacts of a spring: coil on coil, and its seats."""

import numpy as np

from coilset.model.contact.centreline import CentreLine
from coilset.model.contact.coils import Coils
from coilset.model.contact.gap import Gaps
from coilset.model.contact.seat import Seat

SOFTNESS = 40.0  # default bedding is E/40: a wire of steel sinks in by some thousandths of its diameter at block
ONSET = 1e-3  # way over which contact sets in, in wire diameters


def build_contacts(spec, ends, spring, turns, stations, E):
    """Contacts of a spring.

    Args:
        spec: ContactSpec.
        ends: `seats` or `clamped`.
        spring: Spring.
        turns: of the stations, shape (n,).
        stations: positions, shape (n, 3), mm.
        E: Young's modulus, for the default bedding, MPa.

    Returns:
        List of Contacts.
    """
    bedding = spec.bedding or E / SOFTNESS
    radius, lengths = 0.5 * spring.wire_diameter(turns), np.diff(spring.arc_length(turns))
    onset = ONSET * 2.0 * float(radius.min())
    points = CentreLine(turns, radius, lengths).points()
    if spec.coils == "closest":
        contacts = [Coils(points, stations, bedding, onset)]
    else:
        contacts = [gaps_one_turn_apart(turns, radius, lengths, bedding, onset)]
    if ends == "seats":
        for end, level in (("bottom", 0.0), ("top", spring.free_length)):
            reach = spring.seat_distance(points.turns, end)
            contacts.append(Seat(end, points, reach, stations, level, bedding, onset))
    return contacts


def gaps_one_turn_apart(turns, radius, lengths, bedding, onset):
    """The thesis's gap elements between stations that lie above each other."""
    share = bedding * 0.5 * (np.append(lengths, 0.0) + np.append(0.0, lengths))  # of each station
    lower = np.flatnonzero(turns <= turns[-1] - 1.0 + 1e-9)
    upper = np.searchsorted(turns, turns[lower] + 1.0 - 1e-9)
    return Gaps(np.stack([lower, upper], axis=1), radius[lower] + radius[upper], share[lower], onset)
