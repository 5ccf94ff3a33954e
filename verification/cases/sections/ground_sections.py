"""Sections of a ground end, segments of a disk: torsion, elastic coils and plastic ones against solved fields

Torsion constant: of half a disk, Prandtl's stress function as a Fourier series in the angle gives
J = 8/π Σ 1/(n² (n + 2)²) r⁴ over odd n = (π/2 − 4/π) r⁴. Of other segments, the stress function is solved by finite
elements; J from it is a lower bound, and that of the section's warping an upper one.

A coil whose wire is such a segment all along is one slice of finite elements (`coilset.model.physics.slice`), in three
dimensions, which knows nothing of the sections. Its flat faces a seat, as that of an end does. Compared are the rates
of turns without pitch that are pulled apart, with ends free to turn; and turns that are pulled by five times the travel
at which a round wire yields, and let go.

Tolerance: 0.2 % of the torsion constants and of the rates. In plastic flow the section warps as an elastic one: 2 % of
the force, 6 % of the set of a turn.
"""

import numpy as np
import ufl
from dolfinx import default_scalar_type, fem
from dolfinx.fem.petsc import LinearProblem

from coilset.meshes.sections.mesh import SectionMesh, section_mesh
from coilset.meshes.sections.shapes import Curve
from coilset.meshes.springs.placement import straight
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import polar
from coilset.model.physics.outlines.outlined_section import Segment
from coilset.model.physics.slice.problem import SliceProblem
from coilset.model.physics.slice.slice import Coil, Slice
from coilset.model.physics.slice.watch import Watch
from coilset.verification.study import Study

RADIUS = 2.5  # mm
LEVELS = (0.9, 0.5, 0.0, -0.5)  # of the flat, in wire radii from the axis; a usual tip ends at −0.5
OUTLINE = 240  # sides of the arc
STEPS = 8


def run(study: Study) -> None:
    """Torsion, rates, and a plastic coil."""
    half = Segment(0.0, (0.0, 1.0)).warping()
    study.check(
        "half a disk, J/r⁴", half.torsion, 0.5 * np.pi - 4.0 / np.pi, "Fourier series of the stress function", 2e-3
    )
    for level in LEVELS:
        lower = torsion_constant(section(level, 16.0)) / RADIUS**4
        ours = Segment(level, (0.0, 1.0)).warping().torsion
        study.check(f"flat at {level:g} r, J/r⁴", ours, lower, "stress function, finite elements", 2e-3)
    law = library.load("elastic")
    for index in (8.0, 4.0):
        for level in LEVELS:
            exact = slice_rate(law, level, index)
            study.check(
                f"D/d = {index:g}, flat at {level:g} r: rate, N/mm",
                CutCoil(law, level, index).rate(),
                exact,
                "slice",
                2e-3,
            )
    for level in (0.5, -0.5):
        plastic(study, library.load("linear_isotropic"), level)


def outline(level: float) -> Curve:
    """What is left of the wire, the flat below, mm."""
    last = np.arccos(-level)
    angle = np.linspace(last, -last, OUTLINE + 1)
    return Curve(RADIUS * np.stack([np.sin(angle), np.cos(angle)], axis=1))


def section(level: float, across: float) -> SectionMesh:
    """Its mesh."""
    return section_mesh(outline(level), across, 2)


def torsion_constant(mesh: SectionMesh) -> float:
    """J = 2 ∫ φ dA with −Δφ = 2 and φ = 0 on the surface, mm⁴."""
    V = fem.functionspace(mesh.mesh, ("Lagrange", 2))
    φ, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    edge = fem.locate_dofs_topological(V, 1, mesh.facets)
    held = fem.dirichletbc(default_scalar_type(0), edge, V)
    options = {"ksp_type": "preonly", "pc_type": "lu"}
    problem = LinearProblem(
        ufl.inner(ufl.grad(φ), ufl.grad(v)) * ufl.dx, 2.0 * v * ufl.dx, [held], petsc_options=options
    )
    return 2.0 * float(fem.assemble_scalar(fem.form(problem.solve() * ufl.dx)))


class CutCoil:
    """A coil without pitch of the ground section, its ends free to turn.

    Args:
        law: material.
        level: of the flat.
        index: D/d.
        kind: of the section.
    """

    def __init__(self, law: Law, level: float, index: float, kind: str = "curved") -> None:
        R = 2.0 * RADIUS * index / 2.0
        place = straight(1)._replace(curvature=np.full((1, 2), 1.0 / R), flat=np.tile([level, 0.0, 1.0], (1, 2, 1)))
        self.sections = make_sections(kind, law, law.parameters(), polar(), np.array([RADIUS]), place)
        self.start = self.sections.initial_state() | {"strain": np.zeros((1, 2, 6))}
        self.load = np.array([0.0, 0.0, 1.0, R, 0.0, 0.0])  # resultants of a force of 1 N along the coil's axis
        self.turn = 2.0 * np.pi * R  # mm

    def update(self, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Resultants and tangent at the section strains `e`."""
        s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
        self.trial = self.sections.initial_state()
        assert self.sections.update(np.tile(e, (1, 2, 1)), self.start, self.trial, s, D)
        return s[0, 0], D[0, 0]

    def rate(self) -> float:
        """Force over the travel of a turn, elastic, N/mm."""
        return 1.0 / float(self.turn * self.load @ np.linalg.solve(self.update(np.zeros(6))[1], self.load))

    def go_to(self, travel: float | None, force: float = 0.0) -> tuple[float, float]:
        """Travel of a turn, mm, and force, N, at a given travel or, if that is None, under a given force."""
        e = self.start["strain"][0, 0].copy()
        for _ in range(50):
            s, D = self.update(e)
            if travel is not None:
                to_load = np.linalg.solve(D, np.stack([s, self.load], axis=1))
                force = float((travel / self.turn - self.load @ (e - to_load[:, 0])) / (self.load @ to_load[:, 1]))
            out = force * self.load - s
            if np.abs(out).max() < 1e-8 * np.abs(self.load).max():
                self.start = self.trial | {"strain": np.tile(e, (1, 2, 1))}
                return self.turn * float(self.load @ e), force
            e = e + np.linalg.solve(D, out)
        raise AssertionError("no equilibrium of the section")


def slice_rate(law: Law, level: float, index: float) -> float:
    """The same rate of the slice, N/mm."""
    body = Slice(section(level, 9.0), Coil(RADIUS * index, 0.0), law)
    rise = 1e-7 * RADIUS * index
    watch = Watch(body, np.array([[0.0, 0.8 * RADIUS]]))
    return SliceProblem(body, free_ends=True).probe(-rise, watch)[0] / (2.0 * np.pi * rise)


def plastic(study: Study, law: Law, level: float, index: float = 8.0) -> None:
    """Pull apart and release."""
    R = RADIUS * index
    body = Slice(section(level, 7.0), Coil(R, 0.0), law)
    problem, ours = SliceProblem(body, free_ends=True), CutCoil(law, level, index)
    yields = law.yield_stress / np.sqrt(3.0) / law.G * 2.0 * np.pi * R**2 / RADIUS  # travel of a turn of round wire, mm
    for travel in 5.0 * yields * np.arange(1, STEPS + 1) / STEPS:
        problem.go_to_rise(travel / (2.0 * np.pi))
        _, force = ours.go_to(travel)
    name = f"flat at {level:g} r, pulled by {travel:.4g} mm a turn"
    study.check(f"{name}: force, N", force, -problem.force, "slice", 2e-2)
    problem.go_to_force(0.0)
    study.check(f"{name}, released: set, mm", ours.go_to(None)[0], 2.0 * np.pi * body.rise, "slice", 6e-2)
