"""Criteria of fatigue: each gives the stress amplitude of a fully reversed test that damages as a cycle does.

Divided into the fatigue limit of that test it is the safety factor. S̄ is the mean stress, Ŝ its amplitude, n the normal
of a plane, τ̂(n) the amplitude of the shear stress on it, σ(n) the normal stress.
"""

import math

import numpy as np

from coilset.model.physics.fatigue.cycle import Cycle
from coilset.model.physics.fatigue.planes import greatest, normal_stress, shear_stress

SAME = 1e-6  # relative distance of principal amplitudes below which every plane between them has the same shear
AROUND = 32  # such planes that are compared


def haigh(cycle: Cycle, sensitivity: float) -> np.ndarray:
    """Amplitude of fully reversed shear by the mean-stress sensitivity M (Schütz 1967), in von Mises' measure.

    τ̂ = √J₂(Ŝ) and τ̄ = √J₂(S̄), positive where it has the sense of the amplitude or the opposite one: a mean shear stress
    damages alike in both senses. The line has the slope −M up to τ̄ = τ̂ (R = 0) and −M/3 beyond it, as the
    FKM guideline draws it for R between 0 and 0.5, with no further bend:

        τ̄ ≤ τ̂:  τ̂ + M τ̄,     τ̄ > τ̂:  τ̂ (1 + M) (1 + M τ̄/(3 τ̂))/(1 + M/3).

    Args:
        cycle: Cycle.
        sensitivity: M, of shear amplitudes to mean shear.
    """
    amplitude, mean = (np.sqrt(_second_invariant(part)) for part in (cycle.amplitude, cycle.mean))
    M = sensitivity
    below = amplitude + M * mean
    beyond = (1.0 + M) * (amplitude + M / 3.0 * mean) / (1.0 + M / 3.0)
    return np.where(mean <= amplitude, below, beyond)


def smith_watson_topper(cycle: Cycle, poisson: float) -> np.ndarray:
    """max over planes of √(E ε̂(n) σ_max(n)) (Smith, Watson and Topper 1970; Bannantine and Socie 1991).

    Elastic: E ε̂ = |(1 + ν) n·Ŝ n − ν tr Ŝ|. Compression does not damage (σ_max ≥ 0). Socie (1987) takes the plane of
    the greatest ε̂ alone: of the two at ±45° to a spring's wire, which a little bending sets apart, that may be the one
    in compression, and tension on the other one would not count. An amplitude of normal stress.
    """
    flat = cycle.flat()
    trace = np.trace(flat.amplitude, axis1=1, axis2=2)[:, None]

    def on_planes(normals: np.ndarray, of: slice) -> np.ndarray:
        swing = normal_stress(flat.amplitude[of], normals)
        strain = np.abs((1.0 + poisson) * swing - poisson * trace[of])
        return strain * np.maximum(normal_stress(flat.mean[of], normals) + np.abs(swing), 0.0)

    return np.sqrt(greatest(on_planes, len(flat.mean))).reshape(cycle.shape)


def findley(cycle: Cycle, k: float) -> np.ndarray:
    """max over planes of τ̂(n) + k σ_max(n), over √(1 + k²) (Findley 1959): f = τ_W √(1 + k²) in reversed torsion."""
    flat = cycle.flat()

    def on_planes(normals: np.ndarray, of: slice) -> np.ndarray:
        mean, amplitude = flat.mean[of], flat.amplitude[of]
        tension = normal_stress(mean, normals) + np.abs(normal_stress(amplitude, normals))
        return shear_stress(amplitude, normals) + k * tension

    return greatest(on_planes, len(flat.mean)).reshape(cycle.shape) / math.sqrt(1.0 + k * k)


def dang_van(cycle: Cycle, a: float) -> np.ndarray:
    """max over planes and time of τ(n, t) + a σ_H(t) (Dang Van 1973), an amplitude of reversed torsion.

    τ(n, t) is the shear about the centre of its path, of a straight one its middle. The greatest over the planes is
    half the difference of the largest and the least principal value of λ Ŝ, at an end of the path, λ = ±1.
    """
    values = np.linalg.eigvalsh(cycle.amplitude)
    hydrostatic = (np.trace(part, axis1=-2, axis2=-1) / 3.0 for part in (cycle.mean, cycle.amplitude))
    mean, amplitude = hydrostatic
    return 0.5 * (values[..., 2] - values[..., 0]) + a * (mean + np.abs(amplitude))


def fatemi_socie(cycle: Cycle, k: float, yield_stress: float) -> np.ndarray:
    """τ̂ (1 + k σ_max/σ_y) on the plane of the greatest shear strain amplitude (Fatemi and Socie 1988), elastic.

    Of the planes with the same amplitude the one with the greatest σ_max; compression does not reduce damage
    (σ_max ≥ 0). An amplitude of reversed torsion, whose planes carry no normal stress.
    """
    values, vectors = np.linalg.eigh(cycle.amplitude)
    shear = 0.5 * (values[..., 2] - values[..., 0])
    scale = np.maximum(np.abs(values).max(axis=-1), 1e-300)
    tension = np.zeros(cycle.shape)
    for end, other in ((2, 0), (0, 2)):  # n = (e_end + across)/√2, across from e_other towards the middle one
        several = np.abs(values[..., 1] - values[..., other]) <= SAME * scale
        for number in range(AROUND):
            angle = 2.0 * math.pi * number / AROUND
            across = math.cos(angle) * vectors[..., other] + math.sin(angle) * vectors[..., 1]
            n = (vectors[..., end] + across) / math.sqrt(2.0)
            mean, swing = (np.einsum("...i,...ij,...j->...", n, part, n) for part in (cycle.mean, cycle.amplitude))
            counts = several | (number % (AROUND // 2) == 0)
            tension = np.where(counts, np.maximum(tension, mean + np.abs(swing)), tension)
    return shear * (1.0 + k * tension / yield_stress)


def _second_invariant(stress: np.ndarray) -> np.ndarray:
    """J₂ = ½ s:s of the deviator."""
    mean = np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3.0
    deviator = stress - mean * np.eye(3)
    return 0.5 * np.sum(deviator**2, axis=(-2, -1))
