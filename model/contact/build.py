"""The contacts of a spring: coil on coil, and its seats."""

import numpy as np

from coilset.model.contact.coils import Coils
from coilset.model.contact.gap import Gaps
from coilset.model.contact.seat import ABSCISSAE, Seats

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
    lengths = np.linalg.norm(np.diff(stations, axis=0), axis=1)
    share = bedding * 0.5 * (np.append(lengths, 0.0) + np.append(0.0, lengths))  # of each station
    radius = 0.5 * spring.wire_diameter(turns)
    onset = ONSET * 2.0 * float(radius.min())
    if spec.coils == "closest":
        contacts = [Coils(turns, radius, share, onset)]
    else:
        contacts = [gaps_one_turn_apart(turns, radius, share, onset)]
    if ends == "seats":
        inside = turns[:-1, None] + np.diff(turns)[:, None] * ABSCISSAE
        tips, along = (
            np.stack([spring.seat_distance(where, end) for end in ("bottom", "top")])
            for where in (turns[[0, -1]], inside)
        )
        contacts.append(Seats(lengths, (np.diagonal(tips).copy(), along), bedding, 2.0 * float(radius.min()), onset))
    return contacts


def gaps_one_turn_apart(turns, radius, share, onset):
    """The thesis's gap elements between stations that lie above each other."""
    lower = np.flatnonzero(turns <= turns[-1] - 1.0 + 1e-9)
    upper = np.searchsorted(turns, turns[lower] + 1.0 - 1e-9)
    return Gaps(np.stack([lower, upper], axis=1), radius[lower] + radius[upper], share[lower], onset)
