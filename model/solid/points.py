"""The material law at the integration points of the solid."""

from typing import Any

import numpy as np
from numba import njit

from coilset.model.material.law.law import Law
from coilset.model.material.point_law import solid_point
from coilset.model.material.points import initial_state


@njit(cache=True)
def update_points(p: Any, old: np.ndarray, strain: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """Integrate the law over the increment at all points.

    Args:
        p: parameters of the law, or a BackStresses.
        old, new: point states, shape (points, n_state); `new` is written.
        strain: increment ln U, components 11, 22, 33, 12, 13, 23 with doubled shear, shape (points, 6).
        C: written, dσ/dε for strain components with doubled shear, shape (points, 6, 6), MPa.

    Returns:
        0, or -1 if the law found no solution at some point.
    """
    for i in range(len(strain)):
        if solid_point(p, old[i], strain[i], new[i], C[i]) < 0:
            return -1
    return 0


class MaterialPoints:
    """A law of the material library at the points of a solid.

    Args:
        law: `coilset.model.material.law.law.Law`.
        temperature: K; default is the law's reference temperature.
    """

    def __init__(self, law: Law, temperature: float | None = None) -> None:
        self.law, self.temperature = law, temperature
        self._parameters = law.point_law(temperature)

    def initial_state(self, points: int) -> np.ndarray:
        """States of unstressed points, shape (points, n_state); stress and back stress come first, 6 entries each."""
        return initial_state(self.law, points, 6, self.temperature)

    def update(self, old: np.ndarray, strain: np.ndarray, new: np.ndarray, C: np.ndarray) -> bool:
        """Write new point states and moduli, see `update_points`; returns False if the law found no solution."""
        return update_points(self._parameters, old, strain, new, C) == 0
