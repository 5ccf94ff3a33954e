"""Solid meshes of a wire: a structured straight cylinder from gmsh, mapped onto the helix of a coil section."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import dolfinx.mesh
import gmsh
import numpy as np
from mpi4py import MPI

from coilset.meshes.solids.grid import SectionGrid, gmsh_cylinder
from coilset.model.core.base.compat import mesh_from_gmsh, unghosted
from coilset.model.core.base.errors import InputError

GRID = SectionGrid()  # default for a wire


@dataclass(frozen=True)
class Helix:
    """The centre line of a coil with constant diameter and pitch about the z axis, and the wire's frame along it.

    Attributes:
        mean_diameter: D, mm.
        pitch: p, rise per turn, mm; 0 is a split ring.
        degrees: how far the wire goes round.
    """

    mean_diameter: float
    pitch: float
    degrees: float

    @property
    def slope(self) -> float:
        """Pitch angle α, rad: tan α = p / (π D)."""
        return np.arctan2(self.pitch, np.pi * self.mean_diameter)

    @property
    def length(self) -> float:
        """Length of the centre line, mm."""
        return 0.5 * self.mean_diameter * np.radians(self.degrees) / np.cos(self.slope)

    def frame(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Centre and axes (outward radius, t × radius, tangent t) at the arc lengths, each of shape (..., 3).

        The axes are right-handed; the second one points down the axis of a rising coil.
        """
        s = np.asarray(s, dtype=float)
        R, α = 0.5 * self.mean_diameter, self.slope
        θ = s * np.cos(α) / R
        c, σ, o = np.cos(θ), np.sin(θ), np.zeros_like(θ)
        centre = np.stack([R * c, R * σ, s * np.sin(α)], axis=-1)
        outward = np.stack([c, σ, o], axis=-1)
        tangent = np.stack([-σ * np.cos(α), c * np.cos(α), o + np.sin(α)], axis=-1)
        return centre, outward, np.cross(tangent, outward), tangent

    def place(self, straight: np.ndarray) -> np.ndarray:
        """Map points (y, z, s) of the straight wire onto the coil, shape (n, 3); sections stay plane and normal."""
        centre, outward, second, _ = self.frame(straight[:, 2])
        return centre + straight[:, :1] * outward + straight[:, 1:2] * second


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """A distributed solid mesh of a wire with named groups.

    Attributes:
        mesh: DOLFINx mesh of 27-node hexahedra, mm.
        facet_tags: tags of the facets.
        groups: tag of each group of facets: ``bottom``, ``top`` (the two heads) and ``surface``.
        wire_diameter: d, mm.
        length: length of the centre line, mm.
        straight: position (y, z, s) of each geometry node of this rank in the straight wire, shape (nodes, 3), mm.
        place: maps points (y, z, s) of the straight wire, shape (n, 3), to their positions in the mesh, shape (n, 3).
    """

    mesh: dolfinx.mesh.Mesh
    facet_tags: dolfinx.mesh.MeshTags
    groups: dict[str, int]
    wire_diameter: float
    length: float
    straight: np.ndarray
    place: Callable[[np.ndarray], np.ndarray]

    def facets(self, group: str) -> np.ndarray:
        """Facets of a group on this rank."""
        return self.facet_tags.find(self.groups[group])


def straight_wire(diameter: float, length: float, layers: int, comm: MPI.Comm, grid: SectionGrid = GRID) -> SolidMesh:
    """Mesh a straight wire along z; its bottom head is centred at the origin.

    Args:
        diameter: d, mm.
        length: mm.
        layers: number of elements along the wire.
        comm: MPI communicator.
        grid: SectionGrid, the elements of the cross-section.

    Returns:
        SolidMesh.

    Raises:
        InputError: a length that is not positive, or no layers.
    """
    for name, value in (("diameter", diameter), ("length", length)):
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"{value} mm is not possible; give a positive length", name)
    if layers < 1:
        raise InputError(f"{layers} layers of elements are not possible; give at least 1", "layers")
    gmsh.initialize(["coilset", "-v", "1"], readConfigFiles=False, interruptible=False)
    try:
        groups = gmsh_cylinder(0.5 * diameter, length, layers, grid) if comm.rank == 0 else None
        groups = comm.bcast(groups)
        mesh, _, facet_tags = mesh_from_gmsh(gmsh.model, comm, partitioner=unghosted())
    finally:
        gmsh.finalize()
    return SolidMesh(mesh, facet_tags, groups, diameter, length, mesh.geometry.x.copy(), lambda straight: straight)


def coil_section(
    wire_diameter: float,
    mean_diameter: float,
    pitch: float,
    degrees: float,
    layers: int,
    comm: MPI.Comm,
    grid: SectionGrid = GRID,
) -> SolidMesh:
    """Mesh a section of a coil about the z axis: the straight mesh, every node mapped onto the helix.

    Args:
        wire_diameter: d, mm.
        mean_diameter: D, mm, greater than d.
        pitch: rise of the centre line per turn, mm.
        degrees: how far the wire goes round, any positive number; it begins at the x axis.
        layers: number of elements along the wire.
        comm: MPI communicator.
        grid: SectionGrid, the elements of the cross-section.

    Returns:
        SolidMesh.

    Raises:
        InputError: sizes that do not define a coil.
    """
    if not mean_diameter > wire_diameter:
        raise InputError(f"{mean_diameter} mm is not more than the wire's {wire_diameter} mm", "mean_diameter")
    if not np.isfinite(pitch):
        raise InputError(f"{pitch} mm is not possible; give a rise per turn", "pitch")
    if not 0 < degrees < np.inf:
        raise InputError(f"{degrees}° is not possible; give a positive angle", "degrees")
    helix = Helix(mean_diameter, pitch, degrees)
    wire = straight_wire(wire_diameter, helix.length, layers, comm, grid)
    wire.mesh.geometry.x[:] = helix.place(wire.straight)
    return replace(wire, place=helix.place)
