"""Values at the points of a section, carried to as many places as a picture needs."""

import numpy as np

ROUND = 96  # points of a ring in a picture


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
