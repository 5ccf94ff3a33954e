"""The law of a section point: numba selects it by the type of the argument that represents the law.

A parameter array means the exponential return map, `Parts` the point problem, `OwnPoints` a law of one's own, to whose
loop it holds a pointer. The choice is made when a section's loop is compiled (njit) for one of them: a material of the
first kind has no extra cost for what it does not do, and compiles none of it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload

from coilset.model.material.creep.flow import TIME
from coilset.model.material.creep.rod import without_yield
from coilset.model.material.law.functions import SPIN
from coilset.model.material.law.parts import OwnPoints, Parts
from coilset.model.material.point import rod, solid
from coilset.model.material.point.back_stresses import ROD, SOLID, applies, flow_points
from coilset.model.material.point.increment import advance
from coilset.model.runtime.kernels import KERNEL, njit


def rod_points(
    law: Any,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment of the rod's law at many points, as `rod.return_map_points`, or with another law."""
    raise NotImplementedError("only compiled loops call it")


def solid_points(law: Any, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, count: np.ndarray) -> bool:
    """One increment of the law at many points, as in `solid.return_map_points`, or with another law."""
    raise NotImplementedError("only compiled loops call it")


# strict: would compare annotations, which a lambda has not
@overload(rod_points, strict=False)
def _rod_points(
    law: Any, old: Any, de: Any, new: Any, tangent: Any, with_tangent: Any, count: Any
) -> Callable[..., bool]:
    if not isinstance(law, types.BaseNamedTuple):
        return lambda law, old, de, new, tangent, with_tangent, count: rod.return_map_points(
            law, old, de, new, tangent, with_tangent, count
        )
    if law.instance_class is OwnPoints:
        return lambda law, old, de, new, tangent, with_tangent, count: own_points(law, old, de, new, tangent, count)
    return lambda law, old, de, new, tangent, with_tangent, count: parts_points(law, old, de, new, tangent, count)


@njit(**KERNEL)
def own_points(
    law: OwnPoints, old: np.ndarray, de: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> bool:
    """One increment of a law of one's own at many points."""
    places = old.ctypes, de.ctypes, law.values.ctypes, len(law.values), new.ctypes, tangent.ctypes, count.ctypes
    return law.loop(*places, len(count)) == 1


@njit(**KERNEL)
def parts_points(
    law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> bool:
    """One increment at many points: of those whose back stresses saturate several at a time, else one by one."""
    together = applies(law)
    if together and flow_points(law, ROD, old, de, new, tangent, count):
        return True
    good, c = True, np.empty((3, 3))
    for k in range(old.shape[0]):
        if together and count[k] >= 0:
            continue
        count[k] = rod_map(law, old[k], de[0, k], de[1, k], de[2, k], new[k], c)
        good = good and count[k] >= 0
        for i in range(3):
            for j in range(3):
                tangent[3 * i + j, k] = c[i, j]
    return good


@njit(**KERNEL)
def rod_map(law: Parts, old: np.ndarray, e11: float, g12: float, g13: float, new: np.ndarray, C: np.ndarray) -> int:
    """`increment.advance` of a rod's point, in closed form where it only creeps."""
    count = -1
    if law.viscous[TIME] > 0.0 and law.plastic[SPIN] == 0.0:
        count = without_yield(law, old, (e11, g12, g13), new, C)
    return count if count >= 0 else advance(law, old, np.array([e11, g12, g13]), new, C)


@njit(**KERNEL)
def advance_points(
    law: Any,
    old: np.ndarray,
    strain: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """`rod_points` from Python."""
    return rod_points(law, old, strain, new, tangent, with_tangent, count)


@njit(**KERNEL)
def advance_solids(
    law: Any, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, count: np.ndarray
) -> bool:
    """`solid_points` from Python."""
    return solid_points(law, old, de, new, C, count)


@overload(solid_points, strict=False)
def _solid_points(law: Any, old: Any, de: Any, new: Any, C: Any, count: Any) -> Callable[..., bool]:
    if not isinstance(law, types.BaseNamedTuple):
        return lambda law, old, de, new, C, count: solid.return_map_points(law, old, de, new, C, count)
    return lambda law, old, de, new, C, count: parts_solids(law, old, de, new, C, count)


@njit(**KERNEL)
def parts_solids(
    law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, count: np.ndarray
) -> bool:
    """`parts_points` with all six stresses."""
    together, good = applies(law), True
    if together:
        strain, rows = np.empty((6, len(old))), np.empty((36, len(old)))
        for k in range(len(old)):
            for i in range(6):
                strain[i, k] = de[k, i]
        solved = flow_points(law, SOLID, old, strain, new, rows, count)
        for k in range(len(old)):
            for i in range(6):
                for j in range(6):
                    C[k, i, j] = rows[6 * i + j, k]
        if solved:
            return True
    for k in range(len(old)):
        if not together or count[k] < 0:
            count[k] = advance(law, old[k], de[k], new[k], C[k])
            good = good and count[k] >= 0
    return good
