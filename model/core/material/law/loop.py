"""A law as the kernels take it: a pointer to a compiled loop over points, and the numbers that the loop reads.

Kernels do not contain the law: they are compiled once for all laws, and a law once for all kernels.
"""

from collections import namedtuple
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from coilset.model.core.material.law.parts import Parts
from coilset.model.core.runtime.kernels import INLINE, njit

# Address of the loop, and its Parts.
PointLaw = namedtuple("PointLaw", "address parts")
Rows = np.ndarray
# A law before it has its loop, see `point.loops.with_loop`, or with it.
AnyLaw = np.ndarray | Parts | PointLaw
PARTS = types.NamedTuple((types.float64[::1], types.float64[:, :, ::1], types.float64[::1]), Parts)
ROWS = types.float64[:, ::1]
# Of a loop, see `flow_points`.
LOOP = types.boolean(PARTS, types.intp, ROWS, ROWS, ROWS, ROWS, types.boolean, types.int64[::1])


@intrinsic
def _call(
    _: Any, address: Any, parts: Any, n: Any, old: Any, strain: Any, new: Any, tangent: Any, wanted: Any, count: Any
) -> Any:
    """Call the loop at an address, by the calling convention of numba's `cfunc`."""

    def call(context: Any, builder: Any, _: Any, arguments: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in LOOP.args]
        loop = ir.FunctionType(context.get_value_type(LOOP.return_type), kinds).as_pointer()
        return builder.call(builder.inttoptr(arguments[0], loop), arguments[1:])

    return LOOP.return_type(types.intp, *LOOP.args), call


@njit(**INLINE)
def flow_points(
    law: PointLaw, n: int, old: Rows, strain: Rows, new: Rows, tangent: Rows, wanted: bool, count: Rows
) -> bool:
    """One increment of a law at many points.

    Args:
        law: whose loop is for points of so many stresses.
        n: stresses of a point: 3 of the rod's, or all 6, in the order of `point.groups`.
        old: states at the start, shape (points, 2 n + 1 or more); not written.
        strain: increments, engineering shear strains, shape (3, points) or (points, 6).
        new: states at the end; written.
        tangent: dσ/dε by rows, shape (9, points) or (points, 36), N/mm²; written, of some laws only if `wanted`.
        wanted: is the tangent needed?
        count: local iterations of each point, 0 if it stayed elastic, -1 if there was no convergence, -2 if it heated
            itself out of the material's table, shape (points,); written.

    Returns:
        Whether the law found a solution at all points.
    """
    return _call(law.address, law.parts, n, old, strain, new, tangent, wanted, count)
