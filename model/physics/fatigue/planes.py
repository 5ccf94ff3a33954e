"""Planes through a point: the one on which a function of its normal is greatest."""

from collections.abc import Callable

import numpy as np

COARSE = 12  # normals on a quarter of a meridian
FINER = 4  # times the spacing is divided by about 4 around the best normal
BATCH = 2_000  # points whose planes are in memory at a time

OnPlanes = Callable[[np.ndarray, slice], np.ndarray]
"""Values on planes: their unit normals, shape (points, planes, 3), of a slice of the points → (points, planes)."""


def greatest(on_planes: OnPlanes, points: int) -> np.ndarray:
    """Greatest value over all planes through each point, shape (points,).

    A grid over the half sphere of normals, then ever finer ones around the best of it. The last spacing is 0.03°, so
    that what is missed of a smooth maximum is below 1e-6 of it.
    """
    found = np.empty(points)
    for first in range(0, points, BATCH):
        found[first : first + BATCH] = _batch(on_planes, first, min(first + BATCH, points))
    return found


def _batch(on_planes: OnPlanes, first: int, last: int) -> np.ndarray:
    of, count = slice(first, last), last - first
    grid = np.broadcast_to(half_sphere(COARSE), (count, *half_sphere(COARSE).shape))
    best = np.full(count, -np.inf)
    normal = np.zeros((count, 3))
    spacing, rows = 0.5 * np.pi / COARSE, np.arange(count)
    for _ in range(FINER + 1):
        values = on_planes(grid, of)
        at = np.argmax(values, axis=1)
        better = values[rows, at] > best
        best = np.where(better, values[rows, at], best)
        normal = np.where(better[:, None], grid[rows, at], normal)
        grid, spacing = _around(normal, spacing), spacing / 4.0
    return best


def half_sphere(steps: int) -> np.ndarray:
    """Unit normals at about equal distances over a half sphere, `steps` of them on a quarter meridian, shape (n, 3)."""
    found = [np.array([[0.0, 0.0, 1.0]])]
    for polar in np.linspace(0.0, 0.5 * np.pi, steps + 1)[1:]:
        count = max(4, round(4 * steps * np.sin(polar)))
        around = 2.0 * np.pi * np.arange(count) / count
        found.append(
            np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar) + 0 * around], 1)
        )
    return np.concatenate(found)


def _around(normal: np.ndarray, spacing: float) -> np.ndarray:
    """Normals within a spacing around each, 9 × 9 of them, shape (points, 81, 3)."""
    helper = np.where(np.abs(normal[:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = np.cross(normal, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normal, first)
    step = spacing * np.linspace(-1.0, 1.0, 9)
    a, b = (values.ravel()[None, :, None] for values in np.meshgrid(step, step))
    moved = normal[:, None] + a * first[:, None] + b * second[:, None]
    return moved / np.linalg.norm(moved, axis=2, keepdims=True)


def normal_stress(stress: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """n·S n on planes, shape (points, planes); `stress` (points, 3, 3), `normals` (points, planes, 3)."""
    return np.einsum("pki,pij,pkj->pk", normals, stress, normals, optimize=True)


def shear_stress(stress: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Magnitude of the shear stress on planes, √(|S n|² − (n·S n)²)."""
    traction = np.einsum("pij,pkj->pki", stress, normals, optimize=True)
    normal = np.einsum("pki,pki->pk", traction, normals)
    return np.sqrt(np.maximum(np.sum(traction**2, axis=2) - normal**2, 0.0))
