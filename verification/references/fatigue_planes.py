"""Criteria of fatigue by brute force: every plane, every moment of the cycle, vectors only."""

import numpy as np


def planes(step_deg: float) -> np.ndarray:
    """Unit normals over the half sphere by polar and azimuth angle, shape (n, 3)."""
    polar, azimuth = np.radians(np.arange(0.0, 90.0 + step_deg, step_deg)), np.radians(np.arange(0.0, 360.0, step_deg))
    p, a = (values.ravel() for values in np.meshgrid(polar, azimuth))
    return np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], axis=1)


def path(mean: np.ndarray, amplitude: np.ndarray, moments: int = 41) -> np.ndarray:
    """Stress at moments of a harmonic cycle, shape (moments, 3, 3)."""
    phase = np.cos(np.linspace(0.0, np.pi, moments))
    return mean + phase[:, None, None] * amplitude


def on_planes(stress: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normal stress, shape (moments, planes), and shear vectors, shape (moments, planes, 3)."""
    traction = np.einsum("tij,nj->tni", stress, normals)
    normal = np.einsum("tni,ni->tn", traction, normals)
    return normal, traction - normal[..., None] * normals


def findley(stress: np.ndarray, k: float, normals: np.ndarray) -> float:
    """max of half the longest distance on the shear path + k times the greatest normal stress."""
    normal, shear = on_planes(stress, normals)
    half = 0.5 * np.linalg.norm(shear[:, None] - shear[None], axis=-1).max(axis=(0, 1))
    return float((half + k * normal.max(axis=0)).max())


def dang_van(stress: np.ndarray, a: float, normals: np.ndarray) -> float:
    """max over planes and moments of the shear from the middle of its extremes + a σ_H(t)."""
    _, shear = on_planes(stress, normals)
    centre = 0.5 * (shear[0] + shear[-1])
    hydrostatic = np.trace(stress, axis1=1, axis2=2) / 3.0
    return float((np.linalg.norm(shear - centre, axis=-1) + a * hydrostatic[:, None]).max())


def smith_watson_topper(stress: np.ndarray, poisson: float, normals: np.ndarray) -> float:
    """Root of the max of half the range of E times the normal strain (Hooke) times the greatest normal stress."""
    sums = np.trace(stress, axis1=1, axis2=2)[:, None, None]
    strain, _ = on_planes((1.0 + poisson) * stress - poisson * sums * np.eye(3), normals)
    normal, _ = on_planes(stress, normals)
    return float(np.sqrt(np.max(0.5 * np.ptp(strain, axis=0) * np.maximum(normal.max(axis=0), 0.0))))
