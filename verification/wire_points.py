"""The points of wires in frames, as contact sees them."""

import numpy as np

from coilset.model.core.contact.curve import CentreLine, WirePoints


def wire_points(stations: np.ndarray, radius: float | np.ndarray, turns: np.ndarray | None = None) -> WirePoints:
    """Points of the bedding of a wire through `stations`.

    Args:
        stations: positions, shape (n, 3), mm.
        radius: of the wire, or at each station, mm.
        turns: of the stations, shape (n,); places less than half a turn apart never touch each other. Default: 0.4
            turns by length.

    Returns:
        WirePoints.
    """
    lengths = np.linalg.norm(np.diff(stations, axis=0), axis=1)
    if turns is None:
        along = np.append(0.0, np.cumsum(lengths))
        turns = 0.4 * along / along[-1]
    return CentreLine(turns, np.broadcast_to(radius, len(stations)), lengths).points()
