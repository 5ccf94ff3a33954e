"""The rate equations of a point as they stand, in six tensor components, by scipy's stiff integrators.

An independent check of the point problem: (3.1.2) and (3.1.6) to (3.1.8) with the rates that creep, overstress and
several back stresses add are one linear system at every instant; rows of the rod's free stresses replace those of its
given strains. Flow begins and ends at events, the yield surface reached and the multiplier zero, so that no step of the
integrator lies across one. Nothing here is shared with the kernels but the constants of the material file.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from coilset.model.core.material.law.law import Law

UNIT = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
WEIGHT = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # of components 11, 22, 33, 12, 13, 23 in a:b
DEVIATOR = np.eye(6) - np.outer(UNIT, UNIT) / 3.0
ROD, FREE = [0, 3, 4], [1, 2, 5]
GAS_CONSTANT = 8.31446261815324  # J/(mol K)
ACCURACY = {"rtol": 1e-7, "atol": 1e-8}
NEAR = 1e-9  # of k², within which a state is on the yield surface


@dataclass(frozen=True)
class Segment:
    """A straight piece of a path.

    Attributes:
        strain: increments of ε11, γ12, γ13, or of all six, engineering shear strains.
        seconds: that it takes.
        warming: prescribed change of temperature, K, linear in time.
    """

    strain: np.ndarray
    seconds: float = 1.0
    warming: float = 0.0


class PointRates:
    """A point of a material without spin.

    Args:
        law: the material; its file's constants are used, and its functions of b*.
        rod: three stresses, or all six.

    Attributes:
        y: σ, the Bᵢ (6 each), b*, u = c^(1/p) and the temperature, K.
    """

    def __init__(self, law: Law, rod: bool, temperature: float, crept: float = 0.0) -> None:
        self.law, self.rod, self.creep, self.rate = law, rod, law.data.creep, law.data.rate
        self.known = np.array(law.temperatures)
        self.terms = max(law.n_terms, 1)
        self.y = np.zeros(6 * (1 + self.terms) + 3)
        self.y[-1], self.hours = temperature, 0.0
        self.y[-2] = crept ** (1.0 / self.creep.time_exponent) if self.creep else 0.0

    @property
    def stress(self) -> np.ndarray:
        """Stresses of the rod, or all six, MPa."""
        return self.y[:6][ROD] if self.rod else self.y[:6]

    def follow(self, segment: Segment) -> None:
        """Go on along a segment; time within it runs from 0 to 1."""
        D = np.zeros(6)
        D[ROD if self.rod else slice(None)] = segment.strain
        D[3:] /= 2.0
        t, flows = 0.0, self.rate is None and self._starts(D, segment)
        while t < 1.0:

            def rates(t: float, y: np.ndarray, flows: bool = flows) -> np.ndarray:
                return self._rates(t, y, D, segment, flows)[0]

            def turn(t: float, y: np.ndarray, flows: bool = flows) -> float:
                return self._rates(t, y, D, segment, True)[1] if flows else self._excess(y) / self._k2(y) - NEAR

            turn.terminal, turn.direction = True, -1.0 if flows else 1.0  # type: ignore[attr-defined]
            events = turn if self.rate is None and np.isfinite(self._k2(self.y)) else None
            found = solve_ivp(rates, (t, 1.0), self.y, "LSODA", events=events, max_step=0.05, **ACCURACY)
            if not found.success:
                raise ArithmeticError(found.message)
            t, self.y, flows = found.t[-1], found.y[:, -1], not flows
        self.hours += segment.seconds / 3600.0

    # ---- the material ----------------------------------------------------------------------------------------------

    def _at(self, y: np.ndarray) -> tuple[float, ...]:
        """k², ∂k²/∂b*, ∂k²/∂T, ζ, κ."""
        b, T = y[-3], float(np.clip(y[-1], self.known[0], self.known[-1]))
        k2, slope, zeta, _, kappa, _ = (float(one) for one in self.law.functions(b, T))
        softening = 0.0
        if len(self.known) > 1 and np.isfinite(k2):
            first = max(int(np.searchsorted(self.known, T)) - 1, 0)
            low, high = (float(self.law.functions(b, self.known[first + i])[0]) for i in (0, 1))
            softening = (high - low) / (self.known[first + 1] - self.known[first])
        return k2, slope, softening, zeta, kappa

    def _k2(self, y: np.ndarray) -> float:
        return self._at(y)[0]

    def _n(self, y: np.ndarray) -> np.ndarray:
        return DEVIATOR @ y[:6] - y[6:-3].reshape(-1, 6).sum(axis=0)

    def _excess(self, y: np.ndarray) -> float:
        n = self._n(y)
        return float(WEIGHT @ (n * n)) - self._k2(y)

    def _starts(self, D: np.ndarray, segment: Segment) -> bool:
        k2 = self._k2(self.y)
        return self._excess(self.y) > -10 * NEAR * k2 and self._rates(1e-12, self.y, D, segment, True)[1] > 0.0

    def _moduli(self, T: float) -> np.ndarray:
        E, G = (float(one) for one in self.law.moduli(T))
        bulk = E * G / (3.0 * (3.0 * G - E))
        return 2.0 * G * DEVIATOR + bulk * np.outer(UNIT, UNIT)

    def _kinematic(self, T: float, zeta: float) -> np.ndarray:
        """ζᵢ and γᵢ, shape (terms, 2)."""
        if not self.law.n_terms:
            return np.array([[zeta, 0.0]])
        given = np.array([[(2.0 / 3.0 * one.C, one.gamma) for one in at.terms] for at in self.law.data.temperatures])
        return np.array([[np.interp(T, self.known, given[:, i, j]) for j in (0, 1)] for i in range(self.terms)])

    def _creep(self, t: float, y: np.ndarray, segment: Segment) -> tuple[np.ndarray, float]:
        """Creep's rates of strain and of u over the segment."""
        k, S = self.creep, DEVIATOR @ y[:6]
        size = np.sqrt(1.5 * WEIGHT @ (S * S))
        if k is None or size == 0.0:
            return np.zeros(6), 0.0
        x, p = size / k.stress, k.time_exponent
        phi = k.strain * (np.sinh(x) if k.form == "garofalo" else x) ** k.exponent
        worth = np.exp(-k.activation_energy / GAS_CONSTANT * (1.0 / y[-1] - 1.0 / k.temperature))
        hours = segment.seconds / 3600.0 * worth
        if k.hardening == "time":
            c = phi * p * ((self.hours + t * segment.seconds / 3600.0) * worth) ** (p - 1.0) * hours
            return 1.5 * c * S / size, c
        u = phi ** (1.0 / p) * hours
        return 1.5 * p * max(y[-2], 1e-300) ** (p - 1.0) * u * S / size, u

    # ---- the rates -------------------------------------------------------------------------------------------------

    def _rates(
        self, t: float, y: np.ndarray, D: np.ndarray, segment: Segment, flows: bool
    ) -> tuple[np.ndarray, float, float]:
        """As `_linear`, with the multiplier and the length that belong together."""
        k2, _, _, _, kappa = self._at(y)
        n = self._n(y)
        if self.rate:
            v = np.sqrt(WEIGHT @ (n * n) / k2)
            p = segment.seconds * self.rate.reference_rate * max(v - 1.0, 0.0) ** self.rate.exponent
            if p == 0.0:
                return self._linear(t, y, D, segment, None, 0.0)

            def short(multiplier: float) -> float:
                return self._linear(t, y, D, segment, multiplier, p)[2] - p

            if kappa == 0.0:
                return self._linear(t, y, D, segment, p / np.sqrt(2.0 / 3.0 * WEIGHT @ (n * n)), p)
            high = 4.0 * p / np.sqrt(2.0 / 3.0 * WEIGHT @ (n * n)) + 1e-12
            while short(high) < 0.0:
                high *= 4.0
            return self._linear(t, y, D, segment, brentq(short, 0.0, high, rtol=1e-12), p)
        if not flows:
            return self._linear(t, y, D, segment, None, 0.0)
        p = 0.0  # its own length, by Newton's method: to a p that is put in belongs a length
        for _ in range(30):
            found, other = (self._linear(t, y, D, segment, np.nan, p + more) for more in (0.0, 1e-6))
            step = (found[2] - p) / (1.0 - (other[2] - found[2]) / 1e-6)
            p += step
            if abs(step) <= 1e-13 * abs(p) + 1e-18:
                break
        return self._linear(t, y, D, segment, np.nan, p)

    def _linear(
        self, t: float, y: np.ndarray, D: np.ndarray, segment: Segment, multiplier: float | None, p: float
    ) -> tuple[np.ndarray, float, float]:
        """Rates, multiplier, and √⅔ |D_pl|, where γᵢ Bᵢ take p; None: no flow, nan: by consistency."""
        T = y[-1]
        _, slope, softening, zeta, kappa = self._at(y)
        n, C = self._n(y), self._moduli(T)
        back = y[6:-3].reshape(-1, 6)
        zetas, gammas = self._kinematic(T, zeta).T
        fading = (gammas * p) @ back
        flow, u = self._creep(t, y, segment)
        alpha = float(np.interp(T, self.known, [at.elasticity.alpha for at in self.law.data.temperatures]))
        driven = segment.warming
        follows = np.zeros(6)
        if self.creep and driven:
            follows = (self._moduli(T + 0.5) - self._moduli(T - 0.5)) @ np.linalg.solve(C, y[:6]) * driven
        total, B0 = zetas.sum(), DEVIATOR @ C
        # unknowns: D (6), D_pl (6), μ, Ṫ; σ̇ = C (D − D_pl − D_c − α Ṫ 1) + Ċ C⁻¹ σ
        A, r = np.zeros((14, 14)), np.zeros(14)
        for i in range(6):
            if self.rod and i in FREE:
                A[i, :6], A[i, 6:12], A[i, 13], r[i] = C[i], -C[i], -alpha * C[i] @ UNIT, C[i] @ flow - follows[i]
            else:
                A[i, i], r[i] = 1.0, D[i]
        if multiplier is None:
            A[6:12, 6:12], A[12, 12] = np.eye(6), 1.0
        else:
            # D_pl = μ n + κ ṅ, ṅ = dev σ̇ − Σζ D_pl + fading
            A[6:12, :6], A[6:12, 6:12] = -kappa * B0, np.eye(6) + kappa * (B0 + total * np.eye(6))
            A[6:12, 12] = -n
            r[6:12] = kappa * (fading - B0 @ flow + DEVIATOR @ follows)
            if np.isnan(multiplier):
                A[12, :6], A[12, 6:12] = 2 * (WEIGHT * n) @ B0, -2 * (WEIGHT * n) @ (B0 + total * np.eye(6))
                A[12, 6:12] -= slope * WEIGHT * n
                A[12, 13], r[12] = -softening, -2 * (WEIGHT * n) @ (fading - B0 @ flow + DEVIATOR @ follows)
            else:
                A[12, 12], r[12] = 1.0, multiplier
        A[13, 6:12], A[13, 13], r[13] = -self.law.heating * WEIGHT * n, 1.0, driven
        scale = np.ones(14)
        scale[12] = 1e-6
        x = np.linalg.solve(A * scale, r) * scale
        plastic = x[6:12]
        rate = np.zeros_like(y)
        rate[:6] = C @ (x[:6] - plastic - flow - alpha * x[13] * UNIT) + follows
        rate[6:-3] = (np.outer(zetas, plastic) - (gammas * p)[:, None] * back).ravel()
        rate[-3:] = WEIGHT @ (n * plastic), u, x[13]
        return rate, float(x[12]), float(np.sqrt(2.0 / 3.0 * WEIGHT @ (plastic * plastic)))
