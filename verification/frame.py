"""Small frames of rods, driven step by step: used to compute the tables of the thesis."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from coilset.model.core.contact.base import Contact
from coilset.model.core.equilibrium.newton.contact_limit import ContactLimit
from coilset.model.core.equilibrium.newton.methods import rod_method
from coilset.model.core.equilibrium.newton.newton import Newton, Start
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.system.layout import SEATS, LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.material.law.law import Law
from coilset.model.core.rod.rod import Rod
from coilset.model.core.section.rules import DiskRule
from coilset.verification.frame_mesh import frame_mesh

FREE_PENETRATION = 0.02  # wire diameters that a correction may press, as for springs
FAR = 0.5  # rad
KEEP = {"snes_lag_jacobian": 1_000_000}  # the matrix is kept over the whole step, as in the thesis (4.4.5)


class Frame:
    """Rods between nodes, with held dofs, driven by displacements or forces.

    Args:
        nodes: shape (n, 3), mm.
        pairs: node numbers of the elements, shape (m, 2).
        radius: of all rods, or of each, shape (m,), mm.
        law: material law.
        rule: DiskRule.
        held: (node, components) pairs that stay fixed; components are 0-2 for x, y, z, 3-5 for rotations.
        method, options: of `equilibrium/newton/methods.py`, and further PETSc options; the tolerance is the
            thesis's 1e-7.
        contacts: kinds of contact.
        of_rod: further arguments of Rod, such as `placement` and `element`; default: the thesis's.

    Attributes:
        load: Load of the last step, which knows what is held.
    """

    def __init__(
        self,
        nodes: np.ndarray,
        pairs: Sequence[tuple[int, int]] | np.ndarray,
        radius: float | np.ndarray,
        law: Law,
        rule: DiskRule,
        held: Iterable[tuple[int, Iterable[int]]],
        method: str = "newton",
        options: Mapping[str, Any] | None = None,
        contacts: Sequence[Contact] = (),
        **of_rod: Any,
    ) -> None:
        line = frame_mesh(nodes, np.asarray(pairs), MPI.COMM_SELF)
        radii = np.broadcast_to(np.asarray(radius, float), len(pairs))
        self.rod = Rod(line, radii, law, rule, **of_rod)
        self.layout = LineLayout(self.rod)
        self.system = System(self.rod, self.layout, contacts, np.zeros(SEATS))
        # an arc by which every node moves by about the wire's radius
        arc = self.rod.largest_radius * np.sqrt(len(self.layout.station_dofs))
        limit = ContactLimit(self.system, FREE_PENETRATION * 2.0 * self.rod.largest_radius)
        self.continuation = Continuation(Newton(self.system, rod_method(method, 1, options, arc), 1e-7, limit=limit))
        self.held = {int(dof): 0.0 for dof in self.layout.seat_dofs}
        self.held |= {self.dof(node, component): 0.0 for node, components in held for component in components}
        self._stepped, self.load = False, Load.of(self.layout, self.held, {})

    def dof(self, node: int, component: int) -> int:
        """Number of a node's dof in the system."""
        return int(self.layout.station_dofs[node, component])

    def step(
        self,
        moves: Mapping[int, float] | None = None,
        forces: Mapping[int, float] | None = None,
        predictor_scale: float | None = None,
    ) -> Outcome:
        """One load step.

        Args:
            moves: dof → displacement added in this step, mm or rad.
            forces: dof → force at the end of the step, N or N mm.
            predictor_scale: this step's size over the last one's, to start from the last step's increments; None: from
                rest, as after steps that have rotated a node far.

        Returns:
            Outcome; where it has not converged, the frame is back at the last equilibrium.
        """
        self.load = load = Load.of(self.layout, {**self.held, **(moves or {})}, forces or {})
        start = Start()
        if predictor_scale is not None and self._stepped and not self._has_turned_far():
            start = Start(self.continuation.guess.scaled_last(predictor_scale))
        outcome = self.continuation.attempt(load, [start])
        self._stepped = self._stepped or outcome.converged
        return outcome

    def _has_turned_far(self) -> bool:
        """Did a node rotate by more than FAR in the last step? Its increments then point elsewhere than the next."""
        increments = self.layout.to_order(self.system.state["increments"].equilibrium)
        nodes = len(self.layout.station_dofs)
        turns = increments[: 6 * nodes].reshape(nodes, 6)[:, 3:]
        return bool(np.linalg.norm(turns, axis=1).max() > FAR)

    def moved(self, node: int) -> np.ndarray:
        """Displacement of a node since the start, mm."""
        return self.layout.gather(self.rod.x)[node] - self.rod.line.stations[node]

    def rotation(self, node: int) -> np.ndarray:
        """Rotation vector of a node since the start, up to a full turn, rad."""
        return Rotation.from_matrix(self.layout.gather(self.system.state["R"].trial)[node]).as_rotvec()

    def force(self, dof: int) -> float:
        """Internal force at a dof, N or N mm; a support's reaction has the same sign."""
        return float(self.layout.values(self.system.internal, np.array(dof)))

    @property
    def resultants(self) -> np.ndarray:
        """N, Q2, Q3, Mt, M2, M3 at the sections, in the order of the elements, shape (m, sections, 6), N and N mm."""
        out = np.empty_like(self.rod.coefficients.s)
        out[self.rod.line.element] = self.rod.coefficients.s
        return out
