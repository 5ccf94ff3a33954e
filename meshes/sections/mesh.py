"""Meshes of a wire's cross-section: curved triangles of the plane (ξ, η), made by gmsh."""

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass

import dolfinx.mesh
import gmsh
import numpy as np
from mpi4py import MPI

from coilset.meshes.sections.shapes import Outline
from coilset.model.core.base.compat import mesh_from_gmsh
from coilset.model.core.base.errors import InputError

MOST_ACROSS = 100  # triangles across a section: 140,000 unknowns with sides of degree 2
SAMPLES = 4001  # points on each curve in the search for the section's extent
ON = 1e-12  # |η| at which a point counts as one of η = 0, over its curve's size


@dataclass(frozen=True, eq=False)
class SectionMesh:
    """A section's mesh, complete on this rank.

    Attributes:
        mesh: DOLFINx mesh of triangles with sides of degree `degree`, coordinates (ξ, η), mm.
        facets: facets on the section's surface.
        degree: of the sides and of the displacements.
        area: mm².
        size: requested length of the triangles' sides, mm.
        extent: minimum and maximum ξ, minimum and maximum η of the section, mm.
        middle: minimum and maximum ξ of the section at η = 0, mm; None if it does not reach there.
    """

    mesh: dolfinx.mesh.Mesh
    facets: np.ndarray
    degree: int
    area: float
    size: float
    extent: tuple[float, float, float, float]
    middle: tuple[float, float] | None

    def sides(self) -> Iterator[tuple[int, int]]:
        """Cell of each facet on the surface, and the facet's number in it."""
        topology = self.mesh.topology
        topology.create_connectivity(1, 2)
        topology.create_connectivity(2, 1)
        to_cell, to_facet = topology.connectivity(1, 2), topology.connectivity(2, 1)
        for facet in self.facets:
            cell = to_cell.links(facet)[0]
            yield cell, list(to_facet.links(cell)).index(facet)

    @property
    def equivalent_diameter(self) -> float:
        """Diameter of the round section of the same area, mm."""
        return 2.0 * np.sqrt(self.area / np.pi)


def section_mesh(outline: Outline, across: float = 5.0, degree: int = 3, inside: float = 1.0) -> SectionMesh:
    """Mesh a section.

    Args:
        outline: `Outline`, see `section_shapes`; with its `hole`, if it has one.
        across: triangles across the round section of the same area, up to MOST_ACROSS.
        degree: of the triangles' sides and of the displacements, 2 or 3.
        inside: how much finer the triangles are at the inside of the coil, where stress is highest and varies most:
            from the point of minimum ξ to the middle their size grows in proportion to the distance.

    Returns:
        SectionMesh.

    Raises:
        InputError: values that do not define a mesh, or an outline that gmsh cannot fill.
    """
    if not 1 <= across <= MOST_ACROSS:
        raise InputError(
            f"{across:g} is not possible; give 1 to {MOST_ACROSS} triangles across the section", "section.across"
        )
    if degree not in (2, 3):
        raise InputError(f"{degree} is not possible; give 2 or 3", "section.degree")
    with _drawn(outline) as curves:
        face = gmsh.model.occ.addPlaneSurface([gmsh.model.occ.addCurveLoop(curves)])
        area, hole = gmsh.model.occ.getMass(2, face), getattr(outline, "hole", 0.0)
        if hole:  # OpenCASCADE's integral over what is left is 0.2 % off
            area *= 1.0 - hole**2
            inner = gmsh.model.occ.copy([(2, face)])
            gmsh.model.occ.dilate(inner, 0, 0, 0, hole, hole, hole)
            ((_, face),), _ = gmsh.model.occ.cut([(2, face)], inner)
        gmsh.model.occ.synchronize()
        outer = gmsh.model.getBoundary([(2, face)], oriented=False)
        if not area > 0.0:
            raise InputError("the curve crosses itself between its points; give more of them", "section.points")
        size = 2.0 * np.sqrt(area / np.pi) / across
        along = [_samples(tag) for _, tag in outer]
        extent = _extent(np.concatenate(along))
        _sizes(size, inside, extent)
        gmsh.model.addPhysicalGroup(2, [face], name="section")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(degree)
        mesh = mesh_from_gmsh(gmsh.model, MPI.COMM_SELF, gdim=2)[0]
    mesh.topology.create_connectivity(1, 2)
    facets = dolfinx.mesh.exterior_facet_indices(mesh.topology)
    return SectionMesh(mesh, facets, degree, area, size, extent, _middle(along))


def drawn_pieces(outline: Outline, knots: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Points at equal steps of the parameter t, 0 … 1, of each piece of an outline, in the order of these.

    Returns:
        Points b(t) and their derivatives b′(t) of each piece, shape (knots, 2), mm.
    """
    with _drawn(outline) as curves:
        gmsh.model.occ.synchronize()
        pieces = []
        for curve in curves:
            (start,), (end,) = gmsh.model.getParametrizationBounds(1, curve)
            t = np.linspace(start, end, knots)
            points, slopes = gmsh.model.getValue(1, curve, t), gmsh.model.getDerivative(1, curve, t)
            pieces.append((points.reshape(-1, 3)[:, :2], (end - start) * slopes.reshape(-1, 3)[:, :2]))
    return pieces


@contextlib.contextmanager
def _drawn(outline: Outline) -> Iterator[list[int]]:
    """Context of a gmsh model with an outline's curves; a failure of gmsh, a plain `Exception`, is the outline's."""
    gmsh.initialize(["coilset", "-v", "1"], readConfigFiles=False, interruptible=False)
    try:
        gmsh.model.add("section")
        yield outline.draw()
    except Exception as error:
        if type(error) is not Exception:
            raise
        problem = f"the curve cannot be filled with triangles ({error}); does it touch or cross itself?"
        raise InputError(problem, "section.points") from None
    finally:
        gmsh.finalize()


def _samples(curve: int) -> np.ndarray:
    """Points on a curve of the current gmsh model, in order along it, shape (SAMPLES, 2), mm."""
    (start,), (end,) = gmsh.model.getParametrizationBounds(1, curve)
    return gmsh.model.getValue(1, curve, np.linspace(start, end, SAMPLES)).reshape(-1, 3)[:, :2]


def _extent(points: np.ndarray) -> tuple[float, float, float, float]:
    """Minimum and maximum ξ and η of points on a section's outline."""
    return (*np.sort(points[:, 0])[[0, -1]].tolist(), *np.sort(points[:, 1])[[0, -1]].tolist())


def _middle(along: list[np.ndarray]) -> tuple[float, float] | None:
    """Minimum and maximum ξ at which curves, given by points along each, reach or cross η = 0; None if they do not."""
    found = []
    for points in along:
        above = points[:, 1] >= 0.0
        first = np.flatnonzero(above[1:] != above[:-1])
        (ξ, η), (to_ξ, to_η) = points[first].T, points[first + 1].T
        found += [ξ + (to_ξ - ξ) * η / (η - to_η), points[np.abs(points[:, 1]) <= ON * np.abs(points).max(), 0]]
    reached = np.concatenate(found)
    return (float(reached.min()), float(reached.max())) if len(reached) else None


def _sizes(size: float, inside: float, extent: tuple[float, float, float, float]) -> None:
    """Set the triangle size in the current gmsh model: size/inside at the inside."""
    for name in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.{name}", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal Delaunay: even triangles
    left, right, low, high = extent

    def nearer(dimension: int, tag: int, ξ: float, η: float, zero: float, asked: float) -> float:
        away = np.hypot(ξ - left, η - 0.5 * (low + high)) / (0.5 * (right - left))
        return min(asked, size * (1.0 / inside + (1.0 - 1.0 / inside) * away))

    gmsh.model.mesh.setSizeCallback(nearer)
