"""The loop over points of a law with several back stresses, creep or overstress: one residual for all of its parts."""

import numpy as np

from coilset.model.core.material.law.functions import SPIN
from coilset.model.core.material.law.loop import Rows
from coilset.model.core.material.law.parts import Parts
from coilset.model.core.material.point.groups import ROD, SOLID
from coilset.model.core.runtime.kernels import PASTED, njit
from coilset.model.physics.back_stresses import back_stresses
from coilset.model.physics.time.creep.flow import TIME
from coilset.model.physics.time.creep.rod import without_yield
from coilset.model.physics.time.increment import advance
from coilset.model.physics.time.stage import ROOM


def point_problem(
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
