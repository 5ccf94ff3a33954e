"""Stress at selected material points of a cross-section, in the current frame of the section.

The stresses of these elements are most accurate at their integration points. They are carried to a sample point, the
wire's surface included, by a quadratic least-squares polynomial through the nearest ones (superconvergent patch
recovery, Zienkiewicz and Zhu, IJNME 33 (1992) 1331, with patches of points).
"""

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from coilset.meshes.solids.solid import SolidMesh
from coilset.model.core.base.compat import geometry_dofs
from coilset.model.physics.solid.continuum import tensors
from coilset.model.physics.solid.solid import Solid

Patches = tuple[np.ndarray, np.ndarray]  # points of each patch and their weights
NEIGHBOURS = 4 * 16  # integration points of a patch, in the four planes of points about the section


class SectionSample:
    """Points of one cross-section of a wire, followed as material points.

    Args:
        section: arc length of the section, mm.
        y, z: positions in the section, outward and along t × outward, shape (n,), mm.

    Attributes:
        y, z: as given.
    """

    def __init__(self, solid: Solid, section: float, y: ArrayLike, z: ArrayLike) -> None:
        self.solid, self.y, self.z = solid, np.asarray(y, float), np.asarray(z, float)
        mesh, n = solid.wire.mesh, solid.n_cells
        straight = solid.wire.straight[geometry_dofs(mesh)[:n]]
        thickness = np.ptp(straight[:, :, 2], axis=1)
        middle = straight[:, :, 2].mean(axis=1)
        self._cells = np.flatnonzero(np.abs(middle - section) < 1.02 * thickness)
        element = mesh.ufl_domain().ufl_coordinate_element().basix_element
        places = np.einsum("qb,cbi->cqi", element.tabulate(0, solid.forms.points)[0, :, :, 0], straight[self._cells])
        self._shape = solid.V.element.basix_element.tabulate(0, solid.forms.points)[0, :, :, 0]
        places = self._gather(places) - [0.0, 0.0, section]
        ring = np.stack(disk_grid(0.4 * solid.wire.wire_diameter, 2, 8), axis=1)  # shows the section's orientation
        self._patches = _patches(places, np.stack([self.y, self.z], axis=1))
        self._ring = _patches(places, ring)
        self._start, self._axes = self._positions(self._ring), _axes(solid.wire, section)

    def _gather(self, values: np.ndarray) -> np.ndarray:
        """Values at the integration points of the cells around the section, from all ranks, shape (points, …)."""
        return np.concatenate(self.solid.comm.allgather(values.reshape(-1, *values.shape[2:])))

    def _recover(self, values: np.ndarray, patches: Patches) -> np.ndarray:
        """Recover values at this rank's integration points in patches, shape (cells, points, …) → (n, …)."""
        points, weights = patches
        return np.einsum("nk,nk...->n...", weights, self._gather(values)[points])

    def _positions(self, patches: Patches) -> np.ndarray:
        blocks = self.solid.V.dofmap.list[self._cells]
        return self._recover(np.einsum("qb,cbi->cqi", self._shape, self.solid.x[blocks]), patches)

    def positions(self) -> np.ndarray:
        """Current positions of the sample points, shape (n, 3), mm."""
        return self._positions(self._patches)

    def frame(self) -> tuple[np.ndarray, np.ndarray]:
        """Current centre of the section, mm, and its current axes t, outward, t × outward as columns.

        The section's rotation since the start is the one that best fits rings of its points.
        """
        now = self._positions(self._ring)
        a, b = self._start - self._start.mean(axis=0), now - now.mean(axis=0)
        U, _, Vt = np.linalg.svd(b.T @ a)
        R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
        return now.mean(axis=0), R @ self._axes

    def stress(self) -> np.ndarray:
        """σ11, τ12, τ13 at the last equilibrium with 1 = t, 2 = outward, 3 = t × outward, shape (n, 3), MPa."""
        σ = tensors(self._recover(self.solid.point_state[self._cells, :, :6], self._patches))
        axes = self.frame()[1]
        return np.einsum("nij,i,jk->nk", σ, axes[:, 0], axes)


def disk_grid(radius: float, rings: int = 8, spokes: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Positions y, z of a polar grid on the wire's disk, centre first, surface included, each of shape (n,), mm."""
    r = radius * np.arange(1, rings + 1) / rings
    φ = 2 * np.pi * np.arange(spokes) / spokes
    y, z = np.outer(r, np.cos(φ)).ravel(), np.outer(r, np.sin(φ)).ravel()
    return np.concatenate([[0.0], y]), np.concatenate([[0.0], z])


def _axes(wire: SolidMesh, section: float) -> np.ndarray:
    """Axes t, outward, t × outward of a section at the start as columns, from differences of the wire's map."""
    step = 1e-3 * wire.wire_diameter
    places = np.array([[0.0, 0, section], [step, 0, section], [0, step, section]])
    centre, outward, second = wire.place(places)
    outward, second = (outward - centre) / step, (second - centre) / step
    return np.stack([np.cross(outward, second), outward, second], axis=1)


def _patches(places: np.ndarray, samples: np.ndarray) -> Patches:
    """Nearest points of each sample in the section's plane, and their weights in the sample's least-squares value.

    Args:
        places: y, z, s of the points, s measured from the section, shape (points, 3), mm.
        samples: y, z, shape (n, 2), mm.

    Returns:
        Indices and weights, each of shape (n, 2 NEIGHBOURS); the weights are 0 outside of the patch, which has more
        than NEIGHBOURS points if several are equally far as the last one.
    """
    distance, points = cKDTree(places[:, :2]).query(samples, k=min(2 * NEIGHBOURS, len(places)))
    reach = distance[:, NEIGHBOURS - 1 : NEIGHBOURS]
    # all that are equally far as the last one belong to the patch: which one comes first depends on the partition
    weight = np.where(distance < (1 + 1e-6) * reach, np.exp(-2 * (distance / reach) ** 2), 0.0)
    y, z = np.moveaxis((places[points, :2] - samples[:, None]) / reach[:, :, None], 2, 0)
    s = places[points, 2] / np.abs(places[:, 2]).max()
    basis = np.stack([np.ones_like(y), y, z, s, y * y, z * z, s * s, y * z, s * y, s * z], axis=2)
    return points, np.linalg.pinv(basis * weight[:, :, None])[:, 0] * weight
