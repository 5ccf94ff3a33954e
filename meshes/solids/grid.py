"""The structured mesh of a straight wire in gmsh: an O-grid in the disk, or rings in a tube, extruded in layers."""

from dataclasses import dataclass

import gmsh
import numpy as np

from coilset.model.core.base.errors import InputError


@dataclass(frozen=True)
class SectionGrid:
    """Elements of a wire's cross-section: a square core or a hole in the middle, and rings from there to the surface.

    Attributes:
        core: elements along a side of the core; there are 4 · core elements around the surface.
        rings: elements from the core to the surface.
        hole: its radius over that of the wire; 0 if there is a core.
    """

    core: int = 4
    rings: int = 3
    hole: float = 0.0

    def __post_init__(self) -> None:
        """Reject values that do not define a grid."""
        if self.core < 1 or self.rings < 1:
            raise InputError(f"core {self.core} and rings {self.rings} must be at least 1", "grid")
        if not 0.0 <= self.hole < 1.0:
            raise InputError(f"hole {self.hole:g} is not possible; give 0, or a part of the wire less than 1", "grid")

    @property
    def cells(self) -> int:
        """Quadrilaterals in the cross-section."""
        return (0 if self.hole else self.core * self.core) + 4 * self.core * self.rings


CORE = 0.5  # distance of the core's corners from the centre, over the wire radius
# The sides of the core bulge outwards by this fraction of their length, which evens out the angles at its corners.
BULGE = 0.08


def gmsh_disk(radius: float, grid: SectionGrid) -> list[int]:
    """Draw the grid of a disk or a ring in the plane z = 0 of the current gmsh model.

    Args:
        radius: of the wire, mm.
        grid: SectionGrid.

    Returns:
        Tags of the surfaces: the core, if there is one, and the four around it.
    """
    occ, mesh = gmsh.model.occ, gmsh.model.mesh
    angle = np.pi / 4 + np.pi / 2 * np.arange(4)
    ring = [occ.addPoint(radius * np.cos(φ), radius * np.sin(φ), 0) for φ in angle]
    inner = (grid.hole or CORE) * radius
    core = [occ.addPoint(inner * np.cos(φ), inner * np.sin(φ), 0) for φ in angle]
    half = inner / np.sqrt(2)
    sagitta = 2 * half * BULGE
    behind = (half**2 - sagitta**2) / (2 * sagitta) - half  # centre of a side's arc, beyond the opposite side
    centre = occ.addPoint(0, 0, 0)
    arcs, sides, rays = [], [], []
    for i, φ in enumerate(angle):
        j = (i + 1) % 4
        arcs.append(occ.addCircleArc(ring[i], centre, ring[j]))
        middle = φ + np.pi / 4
        away = occ.addPoint(-behind * np.cos(middle), -behind * np.sin(middle), 0)
        sides.append(occ.addCircleArc(core[i], centre if grid.hole else away, core[j]))
        rays.append(occ.addLine(core[i], ring[i]))
    surfaces = [] if grid.hole else [occ.addPlaneSurface([occ.addCurveLoop(sides)])]
    for i in range(4):
        j = (i + 1) % 4
        surfaces.append(occ.addPlaneSurface([occ.addCurveLoop([rays[i], arcs[i], -rays[j], -sides[i]])]))
    occ.synchronize()
    for curve in (*arcs, *sides):
        mesh.setTransfiniteCurve(curve, grid.core + 1)
    for curve in rays:
        mesh.setTransfiniteCurve(curve, grid.rings + 1)
    for surface in surfaces:
        mesh.setTransfiniteSurface(surface)
        mesh.setRecombine(2, surface)
    return surfaces


def gmsh_cylinder(radius: float, length: float, layers: int, grid: SectionGrid) -> dict[str, int]:
    """Mesh a straight wire along z in the current gmsh model with second-order elements.

    Args:
        radius, length: mm.
        layers: elements along the wire.
        grid: SectionGrid.

    Returns:
        Tags of the named groups of facets: ``bottom``, ``top``, ``surface``.
    """
    gmsh.model.add("wire")
    bottom = gmsh_disk(radius, grid)
    extruded = gmsh.model.occ.extrude([(2, tag) for tag in bottom], 0, 0, length, [layers], recombine=True)
    gmsh.model.occ.synchronize()
    volumes = [tag for dim, tag in extruded if dim == 3]
    skin = [tag for _, tag in gmsh.model.getBoundary([(3, tag) for tag in volumes], oriented=False)]
    top = [tag for tag in skin if abs(gmsh.model.occ.getCenterOfMass(2, tag)[2] - length) < 1e-6 * length]
    surface = sorted(set(skin) - set(bottom) - set(top))
    gmsh.model.addPhysicalGroup(3, volumes, name="wire")
    groups = {
        name: gmsh.model.addPhysicalGroup(2, tags, name=name)
        for name, tags in (("bottom", bottom), ("top", top), ("surface", surface))
    }
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    return groups
