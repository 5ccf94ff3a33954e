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
from coilset.model.material.point import back_stresses, return_map
from coilset.model.material.point.groups import ROD, Components
from coilset.model.material.point.increment import advance
from coilset.model.runtime.kernels import KERNEL, njit


def flow_points(
    law: Any,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment at many points, as `return_map.flow_points`, or with another law."""
    raise NotImplementedError("only compiled loops call it")


# strict: would compare the names of arguments, of which one is the kind of law
@overload(flow_points, strict=False, jit_options={name: KERNEL[name] for name in ("error_model", "fastmath")})
def _flow_points(
    law: Any, components: Any, old: Any, de: Any, new: Any, tangent: Any, with_tangent: Any, count: Any
) -> Callable[..., bool]:
    if not isinstance(law, types.BaseNamedTuple):
        return return_map.flow_points
    return own_points if law.instance_class is OwnPoints else parts_points


def own_points(
    law: OwnPoints,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment of a law of one's own at many points of a rod."""
    places = old.ctypes, de.ctypes, law.values.ctypes, len(law.values), new.ctypes, tangent.ctypes, count.ctypes
    return law.loop(*places, len(count)) == 1


def parts_points(
    law: Parts,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """One increment at many points: of those whose back stresses saturate several at a time, else one by one."""
    together, n = back_stresses.applies(law), len(components)
    if together and back_stresses.flow_points(law, components, old, de, new, tangent, True, count):
        return True
    good, e, C = True, np.empty(n), np.empty((n, n))
    for k in range(old.shape[0]):
        if together and count[k] >= 0:
            continue
        for i in range(n):
            e[i] = de[i, k]
        count[k] = point_map(law, old[k], e, new[k], C)
        good = good and count[k] >= 0
        for i in range(n * n):
            tangent[i, k] = C[i // n, i % n]
    return good


@njit(**KERNEL)
def point_map(law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """`increment.advance` of a point, in closed form where one of the rod only creeps."""
    count = -1
    if len(de) == len(ROD) and law.viscous[TIME] > 0.0 and law.plastic[SPIN] == 0.0:
        count = without_yield(law, old, de, new, C)
    return count if count >= 0 else advance(law, old, de, new, C)


@njit(**KERNEL)
def advance_points(
    law: Any,
    components: Components,
    old: np.ndarray,
    de: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    with_tangent: bool,
    count: np.ndarray,
) -> bool:
    """`flow_points` from Python."""
    return flow_points(law, components, old, de, new, tangent, with_tangent, count)
