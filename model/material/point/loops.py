"""The laws of section points as compiled loops, each for the rod's three stresses and for all six."""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import cfunc

from coilset.model.material.creep.flow import TIME
from coilset.model.material.creep.rod import without_yield
from coilset.model.material.law.functions import SPIN
from coilset.model.material.law.loop import LOOP, AnyLaw, PointLaw, Rows, flow_points
from coilset.model.material.law.parts import Parts, simple
from coilset.model.material.point import back_stresses, return_map
from coilset.model.material.point.groups import ROD, SOLID
from coilset.model.material.point.increment import advance
from coilset.model.material.point.stage import ROOM
from coilset.model.runtime.kernels import KERNEL, PASTED, njit

Loop = Callable[..., bool]


def with_loop(law: AnyLaw, components: int) -> PointLaw:
    """A law with its loop, which is compiled when it is first needed.

    Args:
        law: a parameter array: the exponential return map; Parts: the point problem; or one that has its loop.
        components: stresses of a point, 3 or 6.
    """
    if isinstance(law, PointLaw):
        return law
    if isinstance(law, Parts):
        return PointLaw(_compiled(_point_problem).address, law)
    return PointLaw(_compiled(_return_map if components == len(ROD) else _return_map_of_six).address, simple(law))


@functools.cache
def _compiled(loop: Loop) -> Any:
    return cfunc(LOOP, cache=True, **{name: KERNEL[name] for name in ("error_model", "fastmath")})(loop)


def _return_map(
    law: Parts, n: int, old: Rows, strain: Rows, new: Rows, tangent: Rows, wanted: bool, count: Rows
) -> bool:
    return return_map.flow_points(law.plastic, ROD, old, strain, new, tangent, wanted, count)


def _return_map_of_six(
    law: Parts, n: int, old: Rows, strain: Rows, new: Rows, tangent: Rows, wanted: bool, count: Rows
) -> bool:
    return return_map.flow_points(law.plastic, SOLID, old, strain.T, new, tangent.T, wanted, count)


def _point_problem(
    law: Parts, n: int, old: Rows, strain: Rows, new: Rows, tangent: Rows, wanted: bool, count: Rows
) -> bool:
    """Points whose back stresses saturate are integrated several at a time, others one by one."""
    together, rod = back_stresses.applies(law), n == len(ROD)
    if together:
        if rod:
            done = back_stresses.flow_points(law, ROD, old, strain, new, tangent, True, count)
        else:
            done = back_stresses.flow_points(law, SOLID, old, strain.T, new, tangent.T, True, count)
        if done:
            return True
    good, e, C, room = True, np.empty(n), np.empty((n, n)), np.empty(1, ROOM)
    for k in range(old.shape[0]):
        if together and count[k] >= 0:
            continue
        for i in range(n):
            e[i] = strain[i, k] if rod else strain[k, i]
        count[k] = _point(law, old[k], e, new[k], C, room)
        good = good and count[k] >= 0
        for i in range(n * n):
            if rod:
                tangent[i, k] = C[i // n, i % n]
            else:
                tangent[k, i] = C[i // n, i % n]
    return good


@njit(**PASTED)
def _point(law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, room: np.ndarray) -> int:
    """`increment.advance` of a point, in closed form where one of the rod only creeps."""
    count = -1
    if len(de) == len(ROD) and law.viscous[TIME] > 0.0 and law.plastic[SPIN] == 0.0:
        count = without_yield(law, old, de, new, C)
    return count if count >= 0 else advance(law, old, de, new, C, room)


@njit(**KERNEL)
def advance_points(
    law: PointLaw, n: int, old: Rows, strain: Rows, new: Rows, tangent: Rows, wanted: bool, count: Rows
) -> bool:
    """`flow_points` from Python."""
    return flow_points(law, n, old, strain, new, tangent, wanted, count)


def follow(law: AnyLaw, old: np.ndarray, increments: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One increment of a law at many points.

    Args:
        law: as in `with_loop`.
        old: states at the start, shape (points, columns).
        increments: of the strains, shape (points, 3 or 6).

    Returns:
        States at the end, tangents dσ/dε of shape (points, 3, 3) or (points, 6, 6), N/mm², and counts as in
        `flow_points`.
    """
    many, n = increments.shape
    new, count = np.empty_like(old), np.empty(many, np.int64)
    strain, rows = increments, np.empty((many, n * n))
    if n == len(ROD):
        strain, rows = increments.T.copy(), np.empty((n * n, many))
    advance_points(with_loop(law, n), n, old, strain, new, rows, True, count)
    return new, (rows.T if n == len(ROD) else rows).reshape(many, n, n), count
