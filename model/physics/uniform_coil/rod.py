"""The uniform rod: a cylindrical coil whose state is the same all along the wire, in two unknowns.

A helix of radius R and rise h per radian becomes one of radius R̄, rise h̄ and turn λ per radian whose section is
inclined by ϑ. With j = √(R² + h²), x′ = (λR̄ e_θ + h̄ e_z)/j along the wire, d₁ = cos ϑ e_θ + sin ϑ e_z and
d₃ = −sin ϑ e_θ + cos ϑ e_z the strains of the section, E = (Γ₁, Γ₃, K₁, K₃), are

    Γ₁ = x′·d₁ − 1,   Γ₃ = x′·d₃,   K₁ = λ sin ϑ/j − h/j²,   K₃ = λ cos ϑ/j − R/j²,

those of its points (y outward, z along d₃, κ = R/j², m = 1 + κ y, weight of the area m)

    ε₁₁ = ln(1 + (Γ₁ + K₃ y)/m),   γ₁₂ = (K₁ z − κ w)/m + ∂w/∂y,   γ₁₃ = (Γ₃ − K₁ y)/m + ∂w/∂z

with the warping w = −3/7 Γ₃ z (ρ² − 2/3) of `coilset.model.core.section.shape`, ρ = 1 on the surface.

Equilibrium is ∂W/∂R̄ = ∂W/∂ϑ = 0 of the work W per radian; ∂W/∂h̄ = N sin ϑ + Q₃ cos ϑ is the axial force and ∂W/∂λ
the torque. It serves plans, inverse design and start values; docs/slice.md quantifies its deviation from the slice.
"""

import math
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import PointLaw
from coilset.model.core.material.point.loops import with_loop
from coilset.model.core.material.point.over_step import law_over_step
from coilset.model.core.runtime.kernels import njit
from coilset.model.core.section.rules import DiskRule, polar, upper_half
from coilset.model.physics.time.creep.in_time import law_in_time
from coilset.model.physics.uniform_coil.section import RISE, Coil, force_shear, step

SMALLEST_PART = 2.0**-8  # of a step, below which the step is abandoned


@dataclass
class UniformState:
    """Coils at an equilibrium, one per row.

    Attributes:
        coils: wire diameter, mean diameter, pitch (mm) and number of turns, shape (n, 4).
        q: R̄ (mm), ϑ (rad), h̄ (mm/rad), λ, shape (n, 4).
        points: σ₁₁, τ₁₂, τ₁₃, B₁₁, B₁₂, B₁₃, b* of the section points, shape (n, points, n_state), MPa.
        force: axial force, compression positive, shape (n,), N; torque: about the axis, shape (n,), N mm.
        sections: N, Q₃, Mt, M₃, shape (n, 4), N and N mm; tangents: their derivatives by E, shape (n, 4, 4).
    """

    coils: np.ndarray
    q: np.ndarray
    points: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    sections: np.ndarray
    tangents: np.ndarray

    @property
    def travel(self) -> np.ndarray:
        """Shortening of all turns, shape (n,), mm."""
        return self.coils[:, 3] * (self.coils[:, 2] - 2.0 * np.pi * self.q[:, RISE])

    def copy(self) -> "UniformState":
        """An independent copy of the state."""
        return UniformState(*(getattr(self, name).copy() for name in self.__dataclass_fields__))


def unloaded(coils: np.ndarray, law: Law, rule: DiskRule, temperature: float | None = None) -> UniformState:
    """Coils at rest.

    Args:
        coils: wire diameter, mean diameter, pitch in mm, number of turns, shape (n, 4) or (4,).
        law, rule: material and quadrature of the wire's disk.
        temperature: K; default is the law's reference temperature.
    """
    coils = np.atleast_2d(np.asarray(coils, float)).copy()
    n = len(coils)
    radius, rise = 0.5 * coils[:, 1], coils[:, 2] / (2.0 * np.pi)
    q = np.stack([radius, np.arctan2(rise, radius), rise, np.ones(n)], axis=1)
    row = law_over_step(law, law.parameters(temperature), temperature, 3).unstressed()
    points = np.tile(row, (n, len(rule), 1))
    return UniformState(coils, q, points, np.zeros(n), np.zeros(n), np.zeros((n, 4)), np.zeros((n, 4, 4)))


def press(
    coils: np.ndarray | UniformState,
    law: Law,
    travels: np.ndarray | None = None,
    forces: np.ndarray | None = None,
    rule: DiskRule | None = None,
    free_ends: bool = False,
    temperature: float | None = None,
    plain: bool = False,
) -> tuple[np.ndarray, UniformState]:
    """Take coils through prescribed travels or forces, step by step.

    Args:
        coils: as in `unloaded`, or the state in which an earlier call left them, which is not modified.
        law: material; its rod form with σ₁₁, τ₁₂, τ₁₃.
        travels: shortening of all turns since the unloaded coil, shape (steps,) for all coils or (n, steps), mm.
        forces: axial forces, compression positive, in the same shapes, N; give one of the two.
        rule: points of the wire's disk, the same in all calls; default is the upper half of 6 rings of 16, 48 points:
            ε₁₁ and γ₁₃ are symmetric about the coil's plane, and γ₁₂ is antisymmetric.
        free_ends: the ends may turn about the coil's axis (no torque); otherwise their turn λ stays as it is.
        temperature: K; default is the law's reference temperature.
        plain: the section of the thesis, m = 1 and w = 0; for comparisons.

    Returns:
        The quantity that was not given, forces (N) or travels (mm), shape (n, steps), and the UniformState at the end.

    Raises:
        SolveError: if no equilibrium is found for some coil.
        ValueError: if both or neither of `travels` and `forces` are given.
    """
    if (travels is None) == (forces is None):
        raise ValueError("give either travels or forces")
    rule = upper_half(polar(6, 16, staggered=False)) if rule is None else rule
    state = coils.copy() if isinstance(coils, UniformState) else unloaded(coils, law, rule, temperature)
    by_force = travels is None
    targets = np.atleast_1d(np.asarray(forces if by_force else travels, float))
    targets = np.ascontiguousarray(np.broadcast_to(targets, (len(state.coils), targets.shape[-1])))
    found = np.empty(targets.shape)
    y, z = np.ascontiguousarray(rule.points.T)
    lost = _press(
        with_loop(law.point_law(temperature), 3),
        y,
        z,
        rule.weights,
        state.coils,
        targets,
        by_force,
        free_ends,
        plain,
        state.q,
        state.points,
        state.force,
        state.torque,
        state.sections,
        state.tangents,
        found,
    )
    if lost >= 0:
        raise _lost(state.coils[lost])
    return found, state


def hold(
    state: UniformState,
    law: Law,
    hours: np.ndarray,
    rule: DiskRule,
    free_ends: bool = False,
    temperature: float | None = None,
) -> tuple[np.ndarray, UniformState]:
    """Keep coils at their heights while time passes.

    Args:
        state: that in which `press` left the coils, with the same rule; it is not modified.
        law: material that depends on time.
        hours: since the start of the hold, ascending, shape (steps,).
        rule, free_ends, temperature: as in `press`.

    Returns:
        Forces at these times, shape (n, steps), N, and the UniformState at the end.

    Raises:
        SolveError: if no equilibrium is found for some coil.
        ValueError: if the material does not depend on time.
    """
    in_time, state = law_in_time(law, law.parameters(temperature)), state.copy()
    if in_time is None:
        raise ValueError("the material does not depend on time")
    clock = in_time.clock(0.0, law.reference_temperature if temperature is None else temperature)
    y, z = np.ascontiguousarray(rule.points.T)
    found, new = np.empty((len(state.coils), len(hours))), np.empty_like(state.points[0])
    for k, hour in enumerate(hours):
        after = in_time.clock(float(hour), float(clock[1]), clock)
        over, clock = in_time.over(clock, after), after
        for i, one in enumerate(state.coils):
            coil, q = _coil(with_loop(over, 3), y, z, rule.weights, one, False, free_ends, False), state.q[i]
            good, state.force[i], state.torque[i] = step(
                coil, q[RISE], True, q, state.points[i], new, state.sections[i], state.tangents[i]
            )
            if not good:
                raise _lost(one)
        found[:, k] = state.force
    return found, state


def _lost(coil: np.ndarray) -> SolveError:
    d, D, pitch = coil[:3]
    return SolveError(f"no equilibrium of the uniform coil of wire {d:g} mm, diameter {D:g} mm, pitch {pitch:g} mm")


@njit(cache=True)
def _coil(
    law: PointLaw, y: np.ndarray, z: np.ndarray, w: np.ndarray, one: np.ndarray, by_force: bool, free: bool, plain: bool
) -> Coil:
    """One coil and how it is driven."""
    d, D, pitch, _ = one
    R, h = 0.5 * D, pitch / (2.0 * math.pi)
    j, area, bend = math.hypot(R, h), 0.25 * math.pi * d * d * w, 0.0 if plain else R / (R * R + h * h)
    across, along = np.zeros_like(y), np.ones_like(y)
    if not plain:
        across, along = force_shear(0.5 * d, 0.5 * d * y, 0.5 * d * z, bend)
    return Coil(law, R, h, j, 0.5 * d * y, 0.5 * d * z, area, bend, across, along, by_force, free)


@njit(cache=True)
def _press(
    law: PointLaw,
    y: np.ndarray,
    z: np.ndarray,
    w: np.ndarray,
    coils: np.ndarray,
    targets: np.ndarray,
    by_force: bool,
    free: bool,
    plain: np.ndarray,
    q: np.ndarray,
    points: np.ndarray,
    force: np.ndarray,
    torque: np.ndarray,
    sections: np.ndarray,
    tangents: np.ndarray,
    found: np.ndarray,
) -> int:
    """Take all coils through their targets; returns the number of the first one without an equilibrium, or -1."""
    new = np.empty_like(points[0])
    for i in range(len(coils)):
        pitch, turns = coils[i, 2:]
        coil, last = _coil(law, y, z, w, coils[i], by_force, free, plain), 0.0
        h = coil.h
        for k in range(targets.shape[1]):
            start, end = force[i], targets[i, k]
            if not by_force:
                start, end = q[i, RISE], h - targets[i, k] / (2.0 * math.pi * turns)
            direction = 1.0 if end > start else -1.0
            done, part = 0.0, 1.0
            while done < 1.0:
                value = end if done + part >= 1.0 else start + (done + part) * (end - start)
                elastic = direction != last  # when the load reverses, and when continuing from a given state
                good, axial, about = step(coil, value, elastic, q[i], points[i], new, sections[i], tangents[i])
                if good:
                    force[i], torque[i] = axial, about
                    done, last = done + part, direction
                else:
                    part, last = 0.5 * part, 0.0
                    if part < SMALLEST_PART:
                        return i
            found[i, k] = turns * (pitch - 2.0 * math.pi * q[i, RISE]) if by_force else force[i]
    return -1
