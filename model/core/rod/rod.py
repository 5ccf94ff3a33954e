"""A rod structure, a Body: state of its nodes and section points, and the forms assembled from them."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np
from dolfinx import fem
from petsc4py import PETSc

from coilset.meshes.line import LineMesh
from coilset.meshes.springs.placement import Placement, straight
from coilset.model.core.base.agreement import max_of_ranks, sum_of_ranks
from coilset.model.core.base.compat import geometry_dofs
from coilset.model.core.base.extremes import largest
from coilset.model.core.body.body import Body, Moment
from coilset.model.core.body.state import Field, State, Where
from coilset.model.core.material.law.law import Law
from coilset.model.core.rod import forms
from coilset.model.core.rod.assembly import add_element_vectors
from coilset.model.core.rod.coefficients import Coefficients, timoshenko_factor
from coilset.model.core.rod.compiled import compiled_forms
from coilset.model.core.rod.element_kernel import ElementKernel
from coilset.model.core.rod.elements import THESIS, Element
from coilset.model.core.rod.kinematics import Configuration, StressFree, Triads, displace_nodes, section_strains
from coilset.model.core.rod.numbering import Numbering
from coilset.model.core.rod.prediction import Prediction
from coilset.model.core.rod.section_states import CLOCKS, KEPT, POINTS, SURFACE, SectionStates
from coilset.model.core.rotations.triads import chord_triads
from coilset.model.core.runtime.threads import Threads
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import DiskRule

DIFFERENCE = 1e-4  # of a step, of which the strains' rate is the difference
EPSILON = float(np.finfo(float).eps)
ROUNDING = 2e-13  # axial forces below this part of E A are rounding, whatever came before
FAINT = 1e-6  # axial forces below this part of the largest one so far have no centre and load no turns


class Rod(Body):
    """Straight elasto-plastic rods along a line mesh.

    Args:
        line: LineMesh.
        radius: wire radius of every element in the order of the elements, shape (elements,), mm.
        law: material law (`coilset.model.core.material.library.load`).
        rule: quadrature of the wire's disk, DiskRule.
        placement: Placement of the true sections relative to the chords, in the order of the elements; None for
            straight rods.
        temperature: of the rod, K; at the start, if plastic work heats it. None: the first one of the material.
        kind: of the sections, see `coilset.model.core.section.kinds`, and `degree` of those that warp.
        threads: Threads that advance the sections; None: the calling one alone.
        element: Element; the placement is that of its sections.

    Raises:
        InputError: if the temperature lies outside the material's table.

    Attributes:
        increment: function of the increments since the last equilibrium.
        state: State with `x`, mm, and `R`, rotations since the stress-free state, of the local nodes; `chord`, mm,
            `own`, `strain`, shape (cells, sections, 6), and the arrays of the sections, of the owned cells; of these
            `point_state`, shape (cells, sections, points, n_state), and `surface_state` are always there. Rods of up to
            KEPT elements, whose law is rate-independent, also keep `section_forces` and `section_tangents`.
        points: SectionStates, what evaluations write of the section points.
        numbering: Numbering of the unknowns.
        coefficients: Coefficients of the forms, with the section strains and forces of the trial state.
        chart: tangents of the nodes' trial rotation charts, shape (nodes, 3, 3).
        arms: stations whose unknowns are those of a rigid head, and where they are from its point in the stress-free
            state, shape (3,), mm; `levers`: Levers of those among the local nodes, see `FixedStation`.
    """

    predicts = True
    element_dofs: np.ndarray

    def __init__(
        self,
        line: LineMesh,
        radius: np.ndarray,
        law: Law,
        rule: DiskRule,
        placement: Placement | None = None,
        temperature: float | None = None,
        kind: str = "plane",
        degree: int = 3,
        threads: Threads | None = None,
        element: Element = THESIS,
    ) -> None:
        self.element = element
        self.line, self.law, self.rule = line, law, rule
        mesh, n = line.mesh, line.owned_cells
        self.comm = line.comm
        self.mesh, self.parameters = mesh, law.parameters(temperature)
        self.temperature = law.reference_temperature if temperature is None else temperature
        order = line.element[:n]
        self.radius = np.ascontiguousarray(np.asarray(radius, float)[order])
        sections = len(self.element.abscissae)
        self.placement = straight(n, sections) if placement is None else placement.part(order)
        self.sections = make_sections(
            kind, law, self.parameters, rule, self.radius, self.placement, temperature, degree, threads
        )
        self.in_time = self.sections.law_over_step.in_time

        self.V = fem.functionspace(mesh, forms.rod_element(element))
        self.increment = fem.Function(self.V)
        self.numbering = numbering = Numbering.of(self.V, n)
        self.rotation_dofs, self.element_dofs = numbering.rotations, numbering.elements
        self.cells = np.ascontiguousarray(geometry_dofs(mesh)[:n])
        self._nodes = self.cells.astype(np.int32)
        x = mesh.geometry.x
        chords = x[self.cells[:, 1]] - x[self.cells[:, 0]]
        self.l0, self.E0 = np.linalg.norm(chords, axis=1), chord_triads(chords)

        self.coefficients = Coefficients(element, timoshenko_factor(law.E, law.G, self.radius, self.l0), self.l0)
        self._increment = self.increment.x.array
        self.levers: list[Any] = []
        self.arms: dict[int, np.ndarray] = {}
        self._forms = compiled_forms(self.comm, element)
        self._residual, self._tangent = self._forms.on(vars(self.coefficients), x, self._nodes)
        self.largest_radius = max_of_ranks(self.comm, self.radius.max(initial=0.0))
        self.axial_force = law.E * np.pi * self.largest_radius**2  # E A
        self.extent = float(np.ptp(line.stations, axis=0).max())
        axial, bending = law.E * np.pi * self.radius**2 / self.l0, law.E * np.pi * self.radius**4 / 4.0 / self.l0
        self._constraint_weight = max_of_ranks(self.comm, axial.max(initial=0.0))
        self._bending_stiffness = max_of_ranks(self.comm, bending.max(initial=0.0))
        self._start(x)

    def _start(self, x: np.ndarray) -> None:
        """The stress-free state; the mesh's coordinates are the trial positions, as the forms require."""
        n, state, c, numbering = len(self.cells), State(), self.coefficients, self.numbering
        self._x = state.add("x", x, Where.STATION)
        self._R = state.add("R", np.tile(np.eye(3), (len(x), 1, 1)), Where.STATION)
        self._chord = state.add("chord", x[self.cells[:, 1]] - x[self.cells[:, 0]], Where.ELEMENT)
        self._own = state.add("own", np.zeros((n, self.element.own)), Where.ELEMENT)
        self._strain = state.add("strain", c.e, Where.ELEMENT)
        self.points = SectionStates(self.sections, state, self._strain, self.in_time, self.temperature)
        self._forces: list[Field] = []  # at the last equilibrium; an element's tangents take 576 bytes
        if self.in_time is None and self.mesh.topology.index_map(1).size_global <= KEPT:
            known = {"section_forces": c.s, "section_tangents": c.D}
            self._forces = [state.add(name, values, Where.ELEMENT) for name, values in known.items()]
        self.state, self.chart = state, np.tile(np.eye(3), (len(x), 1, 1))
        fields = self._x, self._R, self._chord, self._own
        start, trial = (Configuration(*(getattr(field, when) for field in fields)) for when in ("equilibrium", "trial"))
        self._of_nodes = numbering, self.cells, start, trial, self.chart, c.T
        unloaded = StressFree(self.E0, self.l0, c.timoshenko_factor)
        self._of_cells = self.cells, trial, unloaded, self.element.at_sections, Triads.of(c), c.reference, c.e
        self.rest()

    def rest(self) -> None:
        """Find the forces at the last equilibrium, which has been given and not found by a step."""
        self.update()
        for field in self._forces:
            np.copyto(field.equilibrium, field.trial)

    # ---- time -----------------------------------------------------------------------------------------------------

    @property
    def clock(self) -> np.ndarray:
        """Hours since the start, temperature (K) and warm hours at the last equilibrium; see Body."""
        clocks = (self.state[name].equilibrium for name in ("clock", "heat_clock") if name in self.state)
        return next(clocks, np.array([0.0, self.temperature, 0.0]))

    @property
    def hottest(self) -> float:
        """Highest temperature along the wire at the last equilibrium, K."""
        return float(self.state["heat_clock"].equilibrium[1]) if "heat_clock" in self.state else float(self.clock[1])

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Set the clocks of the trial state; see Body."""
        if self.in_time is None:
            raise ValueError(f"'{self.law.name}' neither creeps nor depends on the rate, so time has no effect on it")
        start, halfway, on_trial = self.clock, *(self.state[name].trial for name in reversed(CLOCKS))
        halfway[:] = self.in_time.clock(*middle, start)
        on_trial[:] = self.in_time.clock(*end, halfway)

    # ---- trial results ------------------------------------------------------------------------------------------

    @property
    def x(self) -> np.ndarray:
        """Positions of the local nodes in the trial state, shape (nodes, 3), mm."""
        return self._x.trial

    @property
    def point_state(self) -> np.ndarray:
        """State at the section points, MPa: trial, in a long rod committed; (cells, sections, points, n_state)."""
        return self.points[POINTS]

    @property
    def surface_state(self) -> np.ndarray:
        """State of the points on the wire's surface, shape (cells, sections, surface points, n_state), MPa."""
        return self.points[SURFACE]

    # ---- Body ------------------------------------------------------------------------------------------------------

    def update(self) -> bool:
        """Update the trial state to the increments; see Body."""
        self._move()
        return self.points.update(self.coefficients.s, self.coefficients.D)

    def recall(self) -> bool:
        """Forces and tangents of the last equilibrium, unless they change in time; see Body."""
        if self._forces:
            self._move()
        for field in self._forces:
            np.copyto(field.trial, field.equilibrium)
        return bool(self._forces)

    def _move(self) -> None:
        """Bring nodes, frames and strains to the increments."""
        if not self.levers:
            displace_nodes(self._increment, *self._of_nodes)
        else:
            increments = self._increment.copy()
            for lever in self.levers:
                lever.carry(increments, self._R.equilibrium[lever.node])
            displace_nodes(increments, *self._of_nodes)
        section_strains(*self._of_cells)

    def advance(self) -> None:
        """Update the points on the wire's surface to the end of the increment, and those of a long rod; see Body."""
        self.points.follow()
        if self.in_time is not None:  # in the next step no time passes, not even half way, without `pass_time`
            clock, halfway = (self.state[name].trial for name in CLOCKS)
            halfway[:] = clock

    def strain_rate(self, rate: np.ndarray) -> np.ndarray:
        """Of the section strains at the trial state, from that of the local unknowns, for any unit of time."""
        there, strain = self._increment.copy(), self._strain.trial.copy()
        self._increment += DIFFERENCE * rate
        self._move()
        found = (self._strain.trial - strain) / DIFFERENCE
        self._increment[:] = there
        self._move()
        return found

    @cached_property
    def _prediction(self) -> Prediction:
        """Made when it is first needed: its arrays then take the memory that the first factors needed for a moment."""
        return Prediction(self.cells, self.coefficients, self.numbering, self.element)

    @cached_property
    def _predicted_residual(self) -> ElementKernel:
        """The loop of the internal forces over the predicted section forces."""
        fields = vars(self.coefficients) | {"s": self.coefficients.predicted}
        return self._forms.on(fields, self.mesh.geometry.x, self._nodes)[0]

    def predict(self, correction: np.ndarray) -> None:
        """Predict the section forces after a correction, from the trial state; see Body."""
        if self.levers:
            correction = correction.copy()
            for lever in self.levers:
                lever.carry_correction(correction)
        self._prediction.begin(correction)

    def first_order_forces(self, vector: np.ndarray, share: float) -> None:
        """As `internal_forces`, without the contribution of strains of second order in the correction; see Body."""
        self._prediction.without_second_order(share)
        for cells, forces in self._predicted_residual():
            for lever in self.levers:
                lever.carry_forces(cells, forces)
            add_element_vectors(forces, self.element_dofs[cells], vector)

    def internal_forces(self, vector: np.ndarray) -> None:
        """Add ∫ ¹σ : δΔE_l of the owned cells; see Body."""
        for cells, forces in self._residual():
            for lever in self.levers:
                lever.keep_force(cells, forces)
                lever.carry_forces(cells, forces)
            add_element_vectors(forces, self.element_dofs[cells], vector)

    def wrenches_on_first_nodes(self) -> np.ndarray:
        """Forces and moments of the owned cells on their first nodes, shape (cells, 6), N and N mm."""
        found = np.empty((len(self.cells), 6))
        for cells, forces in self._residual():
            found[cells] = -forces[:, :6]
        found[:, 3:] = np.linalg.solve(self.coefficients.T[:, 0].swapaxes(1, 2), found[:, 3:, None])[..., 0]
        return found

    @contextmanager
    def judged(self) -> Iterator[None]:
        """With tangents that hold where κ sets in; see Body."""
        D = self.coefficients.D
        found = D.copy()
        if self.law.data.deviates_from_normality and not self.points.hold_onset(D):
            D[:] = found
        try:
            yield
        finally:
            D[:] = found

    def to_charts(self, values: np.ndarray) -> None:
        """Replace the moments m at the owned nodes by Tᵀ m; see Body."""
        mine = (self.rotation_dofs < self.V.dofmap.index_map.size_local).all(axis=1)
        dofs = self.rotation_dofs[mine]
        values[dofs] = np.einsum("nji,nj->ni", self.chart[mine], values[dofs])

    def create_matrix(self, rows: int) -> PETSc.Mat:
        """A matrix for the unknowns of the rod and the seats; see Body."""
        matrix = PETSc.Mat().create(self.comm)
        matrix.setSizes(((rows, None), (rows, None)))
        matrix.setType(PETSc.Mat.Type.AIJ)
        return matrix

    def element_tangents(self, share: float | None = None) -> Iterator[tuple[slice, np.ndarray]]:
        """The elements' K_l and stiffness of the rotating frame, shape (elements, k, k); see Body."""
        if share is None:
            np.copyto(self.coefficients.predicted, self.coefficients.s)
        else:
            self._prediction.forces_after(share)
        return self._tangent() if not self.levers else self._carried_tangents()

    def _carried_tangents(self) -> Iterator[tuple[slice, np.ndarray]]:
        for cells, tangents in self._tangent():
            for lever in self.levers:
                lever.carry_tangents(cells, tangents)
            yield cells, tangents

    @property
    def constraint_weight(self) -> float:
        """Axial stiffness of the stiffest element, N/mm; see Body."""
        return self._constraint_weight

    def rounding(self, increments: np.ndarray) -> float:
        """The largest of three rounding errors, N; see Body.

        That of the increments, times the axial stiffness of the shortest element. That of the rotation matrices,
        ε = 2.2e-16 whatever the increments are, times the bending stiffness E I/l of an element: a floor of moments,
        which short elements raise. And a strain of the wire of 1e-14, so that a step without any change of load also
        counts as being at rest.
        """
        greatest = max_of_ranks(self.comm, largest(increments))
        greatest = min(greatest, self.extent)  # a diverging body is not at rest
        size = sum_of_ranks(self.comm, len(increments))
        stiffest = max(greatest * self.constraint_weight, self._bending_stiffness)
        return max(EPSILON * math.sqrt(size) * stiffest, 1e-14 * self.axial_force)

    def faint_force(self, greatest_force: float) -> float:
        """Axial force below which it counts as zero, N; `greatest_force` is the magnitude of the largest one so far."""
        return max(FAINT * greatest_force, ROUNDING * self.axial_force)
