"""Stress at selected points of the section, including its surface: the law is integrated there as well.

The strain increments at such a point are obtained from the integration points by a quadratic least-squares polynomial
through the nearest ones (patches of points after Zienkiewicz and Zhu, IJNME 33 (1992) 1331); strains are smooth even
where plastic flow begins, stresses are not. The law then gives the stress from the point's own history, so no yield
condition is violated there.
"""

import numpy as np
from scipy.spatial import cKDTree

from coilset.model.core.base.errors import SolveError
from coilset.model.core.body.state import Where
from coilset.model.physics.slice.slice import Slice
from coilset.model.physics.solid.continuum import tensors
from coilset.model.physics.solid.points import respond

NEIGHBOURS = 20  # integration points per patch


class Watch:
    """Points of a slice, followed as material points; create it before the first step.

    Args:
        body: Slice, which evaluates its watches before every new equilibrium.
        places: ξ, η, shape (n, 2), mm.

    Attributes:
        places: as given.
    """

    def __init__(self, body: Slice, places: np.ndarray):
        self.body, self.places = body, np.atleast_2d(np.asarray(places, float))
        self._weights = patch_weights(body.places, self.places)
        self._rows = body.state.add(
            f"watch_{len(body.followers)}", body.points.initial_state(len(self.places)), Where.CELL
        )
        body.followers.append(self.evaluate)

    @property
    def state(self) -> np.ndarray:
        """Point states at the last equilibrium, shape (n, n_state), in space."""
        return self._rows.equilibrium

    def evaluate(self) -> np.ndarray:
        """Point states at the body's increment, shape (n, n_state); a view, overwritten by the next call.

        Raises:
            SolveError: if the law finds no solution at some point.
        """
        n, gradient = len(self.places), np.einsum("np,pij->nij", self._weights, self.body.gradient)
        rows, unused = (self._rows.equilibrium, self._rows.trial), (np.empty((n, 6)), np.empty((n, 6, 6)))
        if not respond(self.body.points, gradient, rows, unused):
            raise SolveError("the law finds no stress at an output point of the section; use smaller steps")
        return self._rows.trial

    def section_stress(self, state: np.ndarray | None = None) -> np.ndarray:
        """Stress in the current axes of the section: 1 along the wire, 2 outward, 3 upward.

        Args:
            state: point states; default are those at the last equilibrium.

        Returns:
            σ11, σ22, σ33, τ12, τ13, τ23, shape (n, 6), MPa.
        """
        σ, axes = tensors((self.state if state is None else state)[:, :6]), self.body.axes()
        turned = np.einsum("ia,nij,jb->nab", axes, σ, axes)
        return turned[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def shear(stress: np.ndarray) -> np.ndarray:
    """Magnitude of the shear stress in the section, √(τ12² + τ13²), of components (..., 6), MPa."""
    return np.hypot(stress[..., 3], stress[..., 4])


def patch_weights(points: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Weights that map values at points to samples, exact for quadratic polynomials, shape (samples, points).

    Args:
        points, samples: positions in the plane, shapes (m, 2) and (n, 2).
    """
    size = min(NEIGHBOURS, len(points))
    distance, nearest = cKDTree(points).query(samples, k=size)
    reach = distance[:, -1:]
    weight = np.exp(-2.0 * (distance / reach) ** 2)
    y, z = np.moveaxis((points[nearest] - samples[:, None]) / reach[:, :, None], 2, 0)
    basis = np.stack([np.ones_like(y), y, z, y * y, y * z, z * z], axis=2)
    found = np.linalg.pinv(basis * weight[:, :, None])[:, 0] * weight
    weights = np.zeros((len(samples), len(points)))
    np.put_along_axis(weights, nearest, found, axis=1)
    return weights
