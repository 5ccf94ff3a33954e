"""The room between two coaxial springs: how near the wire of the inner one comes to that of the outer one."""

import numpy as np

from coilset.meshes.springs.geometry import Spring


def outside(spring: Spring, turns: np.ndarray, x: np.ndarray) -> float:
    """The largest distance of the wire's surface from the axis, mm.

    Args:
        spring: whose wire it is.
        turns: of the stations, shape (n,).
        x: their positions, shape (n, 3), mm.
    """
    return float((np.hypot(x[:, 0], x[:, 1]) + 0.5 * spring.wire_diameter(turns)).max())


def inside(spring: Spring, turns: np.ndarray, x: np.ndarray) -> float:
    """The least distance of the wire's surface from the axis, mm; arguments as in `outside`."""
    return float((np.hypot(x[:, 0], x[:, 1]) - 0.5 * spring.wire_diameter(turns)).min())
