"""A uniform coil of any wire: the rod's section in the kinematics of `physics/uniform_coil/rod.py`, no mesh."""

import numpy as np

from coilset.meshes.springs.placement import straight
from coilset.model.core.base.errors import SolveError
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.surface import component
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import DiskRule
from coilset.model.physics.uniform_coil.section import RISE, Coil, derivatives, strains

STRAINS = np.array([0, 2, 3, 5])  # Γ₁, Γ₃, K₁, K₃ among ε, γ12, γ13, φ′, κ2, κ3
FREE = slice(0, 2)  # R̄ and ϑ
ITERATIONS = 30
LARGEST = 0.1  # change of R̄ in an iteration, over R̄: beyond, it leads to a coil that is turned inside out
HALVINGS = 5  # of a travel


class OutlinedCoil:
    """A coil whose ends cannot turn; its section is symmetric about the plane across the coil's axis.

    Args:
        law: material.
        kind: of the section.
        rule: its points.
        height: of the wire, mm.
        mean_diameter, pitch: of the coil, mm.
        degree: of the polynomials of a section that warps.

    Attributes:
        trial: state of the points.
        force: along the axis, compression positive, N.
    """

    def __init__(
        self, law: Law, kind: str, rule: DiskRule, height: float, mean_diameter: float, pitch: float, degree: int = 3
    ) -> None:
        R, h = 0.5 * mean_diameter, pitch / (2.0 * np.pi)
        j = float(np.hypot(R, h))
        place = straight(1)._replace(curvature=np.full((1, 2), R / j**2), torsion=np.full((1, 2), h / j**2))
        self.sections = make_sections(kind, law, law.parameters(), rule, np.array([0.5 * height]), place, degree=degree)
        none = np.empty(0)
        self._coil = Coil(none, R, h, j, none, none, none, R / j**2, none, none, False, False)
        self.start = self.sections.initial_state() | {"strain": np.zeros((1, 2, 6))}
        self.trial = self.sections.initial_state()
        self.q, self.rise, self.force = np.array([R, np.arctan2(h, R), h, 1.0]), h, 0.0

    @property
    def travel(self) -> float:
        """Shortening of a turn, mm."""
        return float(2.0 * np.pi * (self.rise - self.q[RISE]))

    def _evaluate(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """∂W/∂q per radian and its derivative at the coordinates q."""
        E, e = np.empty(4), np.zeros((1, 2, 6))
        strains(self._coil, q, E)
        e[..., STRAINS] = E
        s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
        if not self.sections.update(e, self.start, self.trial, s, D):
            raise SolveError("the section finds no stress")
        self._strain = e
        S, T = s[0, 0, STRAINS], D[0, 0][np.ix_(STRAINS, STRAINS)]
        B, H = np.empty((4, 4)), np.empty((4, 4))
        derivatives(self._coil, q, S, B, H)
        return self._coil.j * B.T @ S, self._coil.j * B.T @ T @ B + self._coil.j * H

    def go_to(self, travel: float | None, halvings: int = HALVINGS) -> None:
        """To a travel of a turn, mm, in parts if need be, or, if that is None, to no force.

        Raises:
            SolveError: if no equilibrium was found.
        """
        try:
            self._step_to(travel)
        except SolveError:
            if travel is None or halvings == 0:
                raise
            self.go_to(0.5 * (self.travel + travel), halvings - 1)
            self.go_to(travel, halvings - 1)

    def _step_to(self, travel: float | None) -> None:
        q, n = self.q.copy(), 2 if travel is not None else 3
        if travel is not None:
            _, K = self._evaluate(q)
            step = self.rise - travel / (2.0 * np.pi) - q[RISE]
            q[RISE] += step
            q[FREE] -= np.linalg.solve(K[FREE, FREE], K[FREE, RISE] * step)
        for _ in range(ITERATIONS):
            f, K = self._evaluate(q)
            if np.abs(f[:n]).max() <= 1e-9 * np.abs(K[RISE, RISE]) * self.rise:
                break
            change = np.linalg.solve(K[:n, :n], f[:n])
            if not abs(change[0]) < LARGEST * self.q[0]:
                raise SolveError("the coil's radius jumps")
            q[:n] -= change
        else:
            raise SolveError("no equilibrium of the coil")
        self.sections.update_surface(self._strain, self.start, self.trial)
        self.q, self.force = q, -float(f[RISE])
        self.start = {name: array.copy() for name, array in self.trial.items()} | {"strain": self._strain}
        self.trial = {name: array.copy() for name, array in self.trial.items()}

    def shear_around(self) -> np.ndarray:
        """Magnitude of the shear on the surface at equal angles from the inside of the coil, MPa."""
        state, names = self.start["surface_state"][0, 0], self.sections.components
        return np.hypot(component(state, names, "t12"), component(state, names, "t13"))

    def inside_shear(self) -> float:
        """τ13 on the surface at the inside of the coil, MPa."""
        return float(component(self.start["surface_state"][0, 0, 0], self.sections.components, "t13"))
