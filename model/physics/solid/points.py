"""The material law at the integration points of the solid."""

from collections.abc import Mapping

import numpy as np

from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point.loops import advance_points
from coilset.model.core.material.point.over_step import law_over_step
from coilset.model.physics.solid.kinematics import push_forward, stretches

COMPONENTS = 6


class MaterialPoints:
    """A law of the material library at the points of a solid.

    Args:
        law: `coilset.model.core.material.law.law.Law`.
        temperature: K; default is the law's reference temperature.

    Attributes:
        in_time: the law in time, which has clocks; None for a material that does not depend on it.
    """

    def __init__(self, law: Law, temperature: float | None = None) -> None:
        self.law = law
        self.temperature = law.reference_temperature if temperature is None else temperature
        self._over_time = law_over_step(law, law.parameters(temperature), temperature, COMPONENTS)
        self.in_time = self._over_time.in_time
        self.pass_time({}, {})

    def initial_state(self, points: int) -> np.ndarray:
        """States of unstressed points, shape (points, n_state); stress and back stress come first, 6 entries each."""
        return np.tile(self._over_time.unstressed(), (points, 1))

    def pass_time(self, start: Mapping[str, np.ndarray], end: Mapping[str, np.ndarray]) -> None:
        """Let increments from now on lead from one state to another, with the times in their `clock` entries."""
        self._point_law = self._over_time.over(start, end)

    def update(self, old: np.ndarray, strain: np.ndarray, new: np.ndarray, C: np.ndarray) -> bool:
        """Write new point states and moduli; returns False if the law found no solution at some point.

        Args:
            old, new: point states, shape (points, n_state).
            strain: increment ln U, components 11, 22, 33, 12, 13, 23 with doubled shear, shape (points, 6).
            C: dσ/dε for strain components with doubled shear, shape (points, 6, 6), MPa.
        """
        rows, count = C.reshape(-1, COMPONENTS**2), np.empty(len(strain), np.int64)
        return bool(advance_points(self._point_law, COMPONENTS, old, strain, new, rows, True, count))


def respond(
    points: MaterialPoints,
    gradient: np.ndarray,
    rows: tuple[np.ndarray, np.ndarray],
    out: tuple[np.ndarray, np.ndarray],
    symmetric: bool = False,
) -> bool:
    """Stresses and moduli in space after increments of the motion.

    Args:
        points: the law.
        gradient: of the increments in their final configuration, shape (points, 3, 3).
        rows: old and new point states, shape (points, n_state); the new ones are written.
        out: stresses and moduli, written, see `push_forward`.
        symmetric: keep only the symmetric part of the moduli.

    Returns:
        False if the material is inverted at some point, or the law found no solution.
    """
    n, (old, new) = len(gradient), rows
    strain, log_stretch = np.empty((n, 6)), np.empty((n, 3))
    axes, rotation, C = np.empty((n, 3, 3)), np.empty((n, 3, 3)), np.empty((n, 6, 6))
    if stretches(gradient, strain, axes, rotation, log_stretch) != 0 or not points.update(old, strain, new, C):
        return False
    push_forward(new, C, axes, rotation, log_stretch, *out, symmetric)
    return True
