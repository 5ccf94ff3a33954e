"""Values at the points of a section, interpolated to the places of a picture."""

import numpy as np

from coilset.model.core.results.surface import Inside, directions

ROUND = 96  # points of a ring in a picture


class FilledSection:
    """A section in a picture: its rings of points, filled up, and the wire's surface.

    Args:
        points: of the section, in wire radii, shape (n, 2).
        corners: closed outline of a wire that is not round, in wire radii, shape (m + 1, 2).

    Attributes:
        places: those of the picture, in wire radii, shape (m, 2); the last ones are on the surface.
    """

    def __init__(self, points: np.ndarray, corners: np.ndarray | None = None) -> None:
        inner, self._carry = rings(points)
        self._angles = None if corners is None else np.arctan2(*corners[:-1].T[::-1]) % (2.0 * np.pi)
        self.places = np.concatenate([inner, np.stack(directions(ROUND), axis=-1) if corners is None else corners[:-1]])

    def values(self, at_points: np.ndarray, on_surface: np.ndarray) -> np.ndarray:
        """Values at the places, shape (m,), from those at the points and at equal angles on the surface."""
        if self._angles is None:
            return np.concatenate([self._carry @ at_points, refined(on_surface, ROUND)])
        even = 2.0 * np.pi * np.arange(len(on_surface) + 1) / len(on_surface)
        around = np.interp(self._angles, even, np.append(on_surface, on_surface[:1]))
        return np.concatenate([self._carry @ at_points, around])

    def shear_around(self, t12: np.ndarray, t13: np.ndarray, inside: Inside) -> np.ndarray:
        """Shear stress about the wire's axis, positive as in a compressed spring, from `values` of both components."""
        y, z = self.places.T
        return inside.sign * np.cos(inside.angle) * (t13 * y - t12 * z) / np.maximum(np.hypot(y, z), 1e-12)


def rings(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rings of a rule's points, shape (n, 2), filled up to `ROUND` points each.

    Returns:
        The places, shape (m, 2), and the matrix (m, n) that carries values at the points to them: of rings of equal
        angles by the trigonometric polynomial; other points stay as they are.
    """
    radius, angle = np.round(np.hypot(*points.T), 9), np.arctan2(points[:, 1], points[:, 0])
    places, carried = [], []
    for one in np.unique(radius):
        ring = np.flatnonzero(radius == one)
        ring = ring[np.argsort(angle[ring])]
        unit = np.eye(len(points))[ring]
        even = len(ring) > 2 and np.allclose(np.diff(angle[ring]), 2.0 * np.pi / len(ring))
        if even:
            around = angle[ring[0]] + 2.0 * np.pi * np.arange(ROUND) / ROUND
            places.append(one * np.stack([np.cos(around), np.sin(around)], axis=-1))
            carried.append(np.stack([refined(column, ROUND) for column in unit.T], axis=-1))
        else:
            places.append(points[ring])
            carried.append(unit)
    return np.concatenate(places), np.concatenate(carried)


def refined(values: np.ndarray, points: int) -> np.ndarray:
    """Values at equal angles of a circle, shape (n,), at more such angles, by the trigonometric polynomial."""
    waves = np.fft.rfft(values)
    if len(values) % 2 == 0:
        waves[-1] *= 0.5  # its half of the highest wave
    return np.fft.irfft(waves, points) * points / len(values)
