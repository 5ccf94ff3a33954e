"""The law of a section point, whichever it is: numba chooses by the type of what is handed down as the law.

A parameter array means the return mapping, a `Creeping` creep beside it. The choice is made when a section's loop is
compiled (njit) for the one or the other: a material that does not creep pays nothing for it and compiles nothing of it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit, types
from numba.extending import overload

from coilset.model.material import creep, solid
from coilset.model.material.kernel import KERNEL
from coilset.model.material.rod_points import return_map_points


def rod_points(
    law: Any,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment of the rod's law at many points, as `rod_points.return_map_points`, or with a Creeping."""
    raise NotImplementedError("only compiled loops call it")


def solid_point(law: Any, old: np.ndarray, dD: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of the law for the full stress state, as in `solid.return_map`, or with a Creeping."""
    raise NotImplementedError("only compiled loops call it")


# strict: would compare annotations, which a lambda has not
@overload(rod_points, strict=False)
def _rod_points(
    law: Any, old: Any, de: Any, new: Any, tangent: Any, with_tangent: Any, count: Any
) -> Callable[..., bool]:
    if not isinstance(law, types.BaseNamedTuple):
        return lambda law, old, de, new, tangent, with_tangent, count: return_map_points(
            law, old, de, new, tangent, with_tangent, count
        )
    return lambda law, old, de, new, tangent, with_tangent, count: creep_points(law, old, de, new, tangent, count)


@njit(**KERNEL)
def creep_points(
    law: creep.Creeping, old: np.ndarray, de: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> bool:
    """One increment over time at many points, one after the other."""
    good, c = True, np.empty((3, 3))
    for k in range(old.shape[0]):
        count[k] = creep.rod_map(law, old[k], de[0, k], de[1, k], de[2, k], new[k], c)
        good = good and count[k] >= 0
        for i in range(3):
            for j in range(3):
                tangent[3 * i + j, k] = c[i, j]
    return good


@overload(solid_point, strict=False, inline="always")
def _solid_point(law: Any, old: Any, dD: Any, new: Any, C: Any) -> Callable[..., int]:
    if not isinstance(law, types.BaseNamedTuple):
        return lambda law, old, dD, new, C: solid.return_map(law, old, dD, new, C)
    return lambda law, old, dD, new, C: creep.creep_map(law, old, dD, new, C)
