"""Natural frequencies and modes of small vibrations about an equilibrium, K φ = ω² M φ, by SLEPc.

K is the symmetric part of the tangent with the section forces as they are, so that load, large displacements and
contacts change the frequencies, but with the elastic moduli of the sections: a small vibration about a state that has
yielded only unloads and loads again. Contacts that are closed stay closed and those that are open stay open; coils that
touch may also be glued to each other.
"""

from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc
from slepc4py import SLEPc

from coilset.model.core.base.errors import SolveError
from coilset.model.core.case.material import case_elastic
from coilset.model.core.contact.base import Contribution
from coilset.model.core.equilibrium.system.factors import lu
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.matrix import TangentMatrix
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.rod.rod import Rod
from coilset.model.physics.vibration.at_rest import AtRest
from coilset.model.physics.vibration.mass import TONNE, Mass

TOLERANCE = 1e-10  # of K φ − λ M φ, relative to λ
BELOW = 1e-4  # the shift is so far below zero, in (wave speed over length of the wire)²: K may be singular


@dataclass(frozen=True)
class Modes:
    """Modes in ascending order of λ = ω².

    Attributes:
        eigenvalues: λ, shape (modes,), 1/s²; negative where the equilibrium is unstable.
        shapes: displacements, mm, and rotations, rad, of the stations, shape (modes, stations, 6); the greatest
            displacement is 1 mm.
        masses: effective masses along x, y, z and inertia about z, shape (modes, 4), kg and kg mm²: the part of the
            moving mass that a motion of both heads in that direction excites.
        total: all of the mass and inertia, shape (4,).
    """

    eigenvalues: np.ndarray
    shapes: np.ndarray
    masses: np.ndarray
    total: np.ndarray

    @property
    def frequencies(self) -> np.ndarray:
        """Hz, shape (modes,); negative for the rate of growth over 2π where the equilibrium is unstable."""
        return np.sign(self.eigenvalues) * np.sqrt(np.abs(self.eigenvalues)) / (2.0 * np.pi)


def natural_modes(system: System, load: Load, density: float, count: int = 10, glued: bool = False) -> Modes:
    """The modes nearest to zero at the last equilibrium; collective.

    Args:
        system: System of a rod.
        load: what is held, see `Load`.
        density: kg/mm³.
        count: of modes.
        glued: whether coils that touch cannot slide on each other.

    Raises:
        SolveError: if SLEPc does not find so many.
    """
    layout = system.line
    system.restore()
    mass = Mass(layout, density).matrix()
    stiffness, ordering = elastic_stiffness(system, load, glued)
    moving = mass.copy()
    moving.zeroRowsColumns((load.held + layout.start).astype(PETSc.IntType), diag=0.0)
    rod = layout.rod
    scale = rod.law.G * TONNE**-1 / density / float(system.comm.allreduce(rod.l0.sum())) ** 2
    solver = SLEPc.EPS().create(system.comm)
    solver.setOperators(stiffness, moving)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setDimensions(count)
    solver.setTolerances(TOLERANCE, 200)
    solver.setTarget(-BELOW * scale)
    solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    transform = solver.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    transform.getKSP().setType(PETSc.KSP.Type.PREONLY)
    transform.getKSP().setPC(lu(stiffness, ordering))
    solver.solve()
    if solver.getConverged() < count:
        raise SolveError(f"SLEPc found {solver.getConverged()} of {count} modes")
    values = np.array([solver.getEigenvalue(k).real for k in range(solver.getConverged())])
    vectors = []
    for k in np.argsort(values)[:count]:
        vectors.append(layout.vector())
        solver.getEigenvector(int(k), vectors[-1])
    masses, total = _effective(layout, mass, vectors)
    shapes = [_shape(layout, vector) for vector in vectors]
    return Modes(np.sort(values)[:count], np.array(shapes), masses, total)


def loaded_modes(analysis: AtRest, count: int = 10, glued: bool = False) -> Modes:
    """Modes of a spring at its last equilibrium; collective.

    Args:
        analysis: of the spring.
        count, glued: as for `natural_modes`.

    Raises:
        SolveError: too few modes were found.
    """
    density = case_elastic(analysis.case, analysis.law).density
    load = analysis.control.to_height(analysis.control.height)
    return natural_modes(analysis.system, load, density, count, glued)


def elastic_stiffness(system: System, load: Load, glued: bool = False) -> tuple[PETSc.Mat, str]:
    """K at the last equilibrium, where the system has just been restored, and an order of elimination; collective."""
    rod, tangent = system.line.rod, TangentMatrix(system.body, system.layout)
    if glued:
        stuck = [_glued(part, len(system.line.station_dofs)) for part in system.last.contributions]
        system.last = system.last._replace(contributions=stuck)
    np.copyto(rod.coefficients.D, _elastic_moduli(rod))
    system.last_tangent(load, tangent, at_step_start=True)
    system.expire()
    transposed = tangent.mat.copy()
    transposed.transpose()
    tangent.mat.axpy(1.0, transposed)
    tangent.mat.scale(0.5)
    held = (load.held + system.layout.start).astype(PETSc.IntType)
    tangent.mat.zeroRowsColumns(held, diag=rod.constraint_weight)
    return tangent.mat, tangent.ordering


def _elastic_moduli(rod: Rod) -> np.ndarray:
    """Tangents of the sections where nothing has yielded, shape (cells, sections, 6, 6)."""
    rest = rod.sections.initial_state() | {"strain": rod.coefficients.e}
    trial = {name: values.copy() for name, values in rest.items()}
    forces, moduli = np.empty_like(rod.coefficients.s), np.empty_like(rod.coefficients.D)
    rod.sections.update(rod.coefficients.e, rest, trial, forces, moduli)
    return moduli


def _glued(part: Contribution, stations: int) -> Contribution:
    """A contribution whose closed pairs of coils resist sliding as stiffly as they resist penetration.

    A pair with the weights w of its stations and the normal n has the forces −f w n; it gets k (1 − n nᵀ) w wᵀ, where
    k w wᵀ n nᵀ is its stiffness.
    """
    m, size = part.dofs.shape
    if not m or size % 3 or (part.dofs >= 3 * stations).any():
        return part
    forces = part.forces.reshape(m, size // 3, 3)
    on_point = forces[:, : size // 6].sum(axis=1)
    pressed = part.bears & (np.linalg.norm(on_point, axis=1) > 0.0)
    if not pressed.any():
        return part
    n = on_point[pressed] / np.linalg.norm(on_point[pressed], axis=1, keepdims=True)
    w = np.einsum("maj,mj->ma", forces[pressed], n) / np.linalg.norm(on_point[pressed], axis=1)[:, None]
    g = np.einsum("ma,mj->maj", w, n).reshape(-1, size)
    k = np.einsum("mi,mij,mj->m", g, part.stiffness[pressed], g) / np.einsum("mi,mi->m", g, g) ** 2
    across = np.eye(3) - n[:, :, None] * n[:, None, :]
    stiffness = part.stiffness.copy()
    stiffness[pressed] += np.einsum("m,ma,mb,mij->maibj", k, w, w, across).reshape(-1, size, size)
    return replace(part, stiffness=stiffness)


def _shape(layout: LineLayout, vector: PETSc.Vec) -> np.ndarray:
    n = len(layout.station_dofs)
    shape = layout.to_order(vector.getArray(readonly=True))[: 6 * n].reshape(n, 6)
    greatest = shape[np.linalg.norm(shape[:, :3], axis=1).argmax(), :3]
    return shape / (np.linalg.norm(greatest) * np.sign(greatest[np.abs(greatest).argmax()]))


def _effective(layout: LineLayout, mass: PETSc.Mat, vectors: list[PETSc.Vec]) -> tuple[np.ndarray, np.ndarray]:
    """Effective masses of modes and the whole ones, see `Modes`."""
    n, x = len(layout.station_dofs), layout.gather(layout.rod.x).copy()
    for station, arm in layout.rod.arms.items():  # its unknowns are those of the head's point
        x[station] -= layout.gather(layout.rod.state["R"].equilibrium)[station] @ arm
    rigid = np.zeros((4, n, 6))
    rigid[[0, 1, 2], :, [0, 1, 2]] = 1.0
    rigid[3, :, 0], rigid[3, :, 1], rigid[3, :, 5] = -x[:, 1], x[:, 0], 1.0
    masses, total = np.empty((len(vectors), 4)), np.empty(4)
    for axis in range(4):
        natural = np.zeros(layout.size)
        natural[: 6 * n] = rigid[axis].ravel()
        along = mass * layout.vector(layout.from_order(natural).copy())
        total[axis] = along.dot(layout.vector(layout.from_order(natural).copy()))
        for k, vector in enumerate(vectors):
            masses[k, axis] = vector.dot(along) ** 2 / vector.dot(mass * vector)
    return masses / TONNE, total / TONNE
