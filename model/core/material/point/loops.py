"""The laws of section points as compiled loops, each for the rod's three stresses and for all six."""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import cfunc

from coilset.model.core.base.package import package
from coilset.model.core.material.law.loop import LOOP, AnyLaw, PointLaw, Rows, flow_points
from coilset.model.core.material.law.parts import Parts, simple
from coilset.model.core.material.point import return_map
from coilset.model.core.material.point.groups import ROD, SOLID
from coilset.model.core.runtime.kernels import KERNEL, njit

Loop = Callable[..., bool]
PROBLEM = "coilset.model.physics.time.problem"  # the door to laws that are more than the return map


def with_loop(law: AnyLaw, components: int) -> PointLaw:
    """A law with its loop, which is compiled when it is first needed.

    Args:
        law: a parameter array: the exponential return map; Parts: the point problem; or one that has its loop.
        components: stresses of a point, 3 or 6.
    """
    if isinstance(law, PointLaw):
        return law
    if isinstance(law, Parts):
        problem = package(PROBLEM, "a law with back stresses, creep or overstress").point_problem
        return PointLaw(_compiled(problem).address, law)
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
