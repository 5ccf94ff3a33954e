"""Creep of a rod's point that does not yield: both stages of `increment` in closed form but for one unknown each.

With c = θ σ the equivalent creep strain of a stage, its stress follows from the elastic one s̃ of the whole strain,

    σ11 = s̃11/(1 + E θ),   τ1j = τ̃1j/(1 + 3 G θ),

and θ from θ σ(θ) = c(σ(θ)), see `flow.crept`, χ = 1.5 θ. The compliance of the stage is

    C⁻¹ + ∂x/∂s = diag(1/E + θ, 1/G + 3θ, 1/G + 3θ) + (∂c/∂σ − θ) d dᵀ,   d = ∂σ/∂s,

inverted in closed form, too (Sherman and Morrison). Where a stage's stress lies outside the yield surface, all is left
to `increment.advance`; both give the same numbers.
"""

import math
from collections import namedtuple

import numpy as np

from coilset.model.core.material.law.functions import elasticity, functions
from coilset.model.core.material.law.parts import Parts
from coilset.model.core.material.point.groups import Vector, active, inner, scaled
from coilset.model.core.runtime.kernels import INLINE, KERNEL, njit
from coilset.model.physics.time.creep.flow import POWER, creep_strain, crept, passes
from coilset.model.physics.time.increment import GAMMA

WEIGHTS = (1.0, 3.0, 3.0)  # of σ11, τ12, τ13 in σ²
# A stage's end: stress, its equivalent σ and direction d, θ, the Creep of σ, ∂c/∂σ − θ at constant time; iterations,
# -1 if there is none.
Stage = namedtuple("Stage", "stress sigma d theta of normal count")
# The inverse of C⁻¹ + ∂x/∂s: diag(D) − k v vᵀ.
Inverse = namedtuple("Inverse", "D k v")


@njit(**KERNEL)
def without_yield(law: Parts, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """`increment.advance` if no stage yields; else, or if one finds no end, -1: nothing of what is written counts."""
    q = law.viscous
    h, after = passes(q, old[7])
    before, change = old[7], after - old[7]
    u0 = old[8] ** (1.0 / q[POWER])
    E0, G0, alpha0 = elasticity(law.plastic, before)

    E, G, alpha = elasticity(law.plastic, before + GAMMA * change)
    thermal = 0.5 * (alpha0 + alpha) * GAMMA * change
    trial = (
        old[0] * E / E0 + E * (GAMMA * de[0] - thermal),
        old[1] * G / G0 + G * GAMMA * de[1],
        old[2] * G / G0 + G * GAMMA * de[2],
    )
    one = _stage(q, trial, E, G, u0, GAMMA * h)
    if one.count < 0 or _yields(law.plastic, one.stress, old, before + GAMMA * change):
        return -1
    S = _inverse(one, E, G)

    # creep under the first stage's stress over 1 − γ
    between = creep_strain(q, one.sigma, u0, (1.0 - GAMMA) * h)
    theta = between.strain / one.sigma if one.sigma > 0.0 else 0.0

    E, G, alpha = elasticity(law.plastic, before + change)
    thermal = 0.5 * (alpha0 + alpha) * change
    s = one.stress
    trial = (
        old[0] * E / E0 + E * (de[0] - thermal - theta * s[0]),
        old[1] * G / G0 + G * (de[1] - 3.0 * theta * s[1]),
        old[2] * G / G0 + G * (de[2] - 3.0 * theta * s[2]),
    )
    two = _stage(q, trial, E, G, between.u, GAMMA * h)
    if two.count < 0 or _yields(law.plastic, two.stress, old, before + change):
        return -1
    for i in range(3):
        new[i] = two.stress[i]
    for i in range(3, old.shape[0]):
        new[i] = old[i]
    new[7], new[8] = before + change, two.of.u ** q[POWER]
    own = scaled(two.d, two.of.by_start * between.u_by_stress)
    _tangent(_inverse(two, E, G), S, one.d, (between.by_stress - theta, theta), own, C)
    return one.count + two.count


@njit(**INLINE)
def _equivalent(s: Vector) -> float:
    return math.sqrt(s[0] * s[0] + 3.0 * (s[1] * s[1] + s[2] * s[2]))


@njit(**INLINE)
def _yields(p: np.ndarray, s: Vector, old: np.ndarray, temperature: float) -> bool:
    n = active(s, (old[3], old[4], old[5]))
    return not inner(n, n) <= functions(p, old[6], temperature)[0] * (1.0 + 1e-12)


@njit(**KERNEL)
def _stage(q: np.ndarray, trial: Vector, E: float, G: float, u0: float, h: float) -> Stage:
    """The end of a stage of length h that starts with u0.

    Args:
        trial: stress of the stage's strain without its creep, N/mm².
    """
    squares = (trial[0] * trial[0], 3.0 * (trial[1] * trial[1] + trial[2] * trial[2]))
    chi, count = crept(q, squares, (E / 1.5, 2.0 * G), u0, h)
    theta = chi / 1.5
    a, b = 1.0 / (1.0 + E * theta), 1.0 / (1.0 + 3.0 * G * theta)
    s = (trial[0] * a, trial[1] * b, trial[2] * b)
    sigma = _equivalent(s)
    of = creep_strain(q, sigma, u0, h)
    return Stage(s, sigma, _direction(s, sigma), theta, of, of.by_stress - theta if chi > 0.0 else 0.0, count)


@njit(**INLINE)
def _direction(s: Vector, sigma: float) -> Vector:
    """∂σ/∂s."""
    f = 1.0 / sigma if sigma > 0.0 else 0.0
    return (s[0] * f, 3.0 * s[1] * f, 3.0 * s[2] * f)


@njit(**INLINE)
def _inverse(stage: Stage, E: float, G: float) -> Inverse:
    """The inverse of C⁻¹ + ∂x/∂s at the end of a stage."""
    d, theta = stage.d, stage.theta
    shear = G / (1.0 + 3.0 * G * theta)
    D = (E / (1.0 + E * theta), shear, shear)
    v = (D[0] * d[0], D[1] * d[1], D[2] * d[2])
    k = stage.normal / (1.0 + stage.normal * (d[0] * v[0] + d[1] * v[1] + d[2] * v[2]))
    return Inverse(D, k, v)


@njit(**INLINE)
def _tangent(
    two: Inverse, one: Inverse, d: Vector, by_stress: tuple[float, float], by_start: Vector, C: np.ndarray
) -> None:
    """Write S₂ (1 − A S₁), with S₁ = γ (C⁻¹ + ∂x/∂s)⁻¹ of the first stage and A = ∂(x of the rest)/∂σ₁.

    Args:
        two, one: the stages' inverses.
        d: direction of the first stage's stress.
        by_stress: normal and tangential part of the creep strain over 1 − γ, A = normal d dᵀ + θ diag(1, 3, 3).
        by_start: what u at its start does to the second stage's creep strain, along d.
    """
    normal, theta = by_stress
    shrink = GAMMA - GAMMA * one.k * (d[0] * one.v[0] + d[1] * one.v[1] + d[2] * one.v[2])
    r = (shrink * one.v[0], shrink * one.v[1], shrink * one.v[2])  # S₁ d
    left = (normal * d[0] + by_start[0], normal * d[1] + by_start[1], normal * d[2] + by_start[2])
    for j in range(3):
        along = 0.0
        for i in range(3):  # column j of 1 − A S₁, kept in C
            S = GAMMA * ((one.D[i] if i == j else 0.0) - one.k * one.v[i] * one.v[j])
            C[i, j] = (1.0 if i == j else 0.0) - left[i] * r[j] - theta * WEIGHTS[i] * S
            along += two.v[i] * C[i, j]
        for i in range(3):
            C[i, j] = two.D[i] * C[i, j] - two.k * two.v[i] * along
