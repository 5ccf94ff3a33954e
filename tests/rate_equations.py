"""A reference for the law that shares nothing with it: rate equations in 3 × 3 tensors, solved as they stand.

At every instant the linear equations (3.1.2), (3.1.6) to (3.1.8), the consistency condition (3.1.5), the rate of the
temperature and, for the rod, (5.2.32) are put into one matrix and solved; scipy's DOP853 integrates them in time with
rtol 1e-10. The constants of Ck 15 are typed from the thesis, 6.2.2. No formula of (3.1.9) or (3.2.2) is used.
"""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
WEIGHT = np.array([1, 1, 1, 2, 2, 2])
UNIT = np.array([1, 1, 1, 0, 0, 0])
ACCURACY = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-9}
DEVIATOR = np.eye(6) - np.outer(UNIT, UNIT) / 3


def ck15(**change):
    """k², k²′, ζ, κ of Ck 15 as functions of b*, and the elastic constants; `at` a temperature they are the same."""
    c = dict(k0=22480, a1=86664, a2=0.0049, a3=0.0574, b1=80, kinf=160000, a4=0.02675, a5=7.3, a6=0.0135, a7=1.18)
    c |= dict(a=0.0005, G=84000, nu=0.28989) | change
    k1 = c["k0"] + c["a1"] * (1 + c["a2"] * c["b1"] - np.exp(-c["a3"] * c["b1"]))

    def k2(b):
        if b <= c["b1"]:
            return c["k0"] + c["a1"] * (1 + c["a2"] * b - np.exp(-c["a3"] * b))
        return c["kinf"] - (c["kinf"] - k1) * np.exp(-c["a4"] * (b - c["b1"]))

    def slope(b):
        if b <= c["b1"]:
            return c["a1"] * (c["a2"] + c["a3"] * np.exp(-c["a3"] * b))
        return c["a4"] * (c["kinf"] - k1) * np.exp(-c["a4"] * (b - c["b1"]))

    def zeta(b):
        return c["a5"] * (c["a6"] + c["a7"] * np.exp(-c["a7"] * b)) * np.sqrt(6 * k2(b))

    def kappa(b):
        return c["a"] * b**3 / (2 * c["G"])

    material = SimpleNamespace(k2=k2, slope=slope, zeta=zeta, kappa=kappa, G=c["G"], nu=c["nu"])
    material.alpha, material.softening, material.heating, material.start = c.get("alpha", 0), lambda b: 0, 0, 293.15
    material.at = lambda temperature: material
    return material


def table(temperatures, materials, heating=0.0):
    """Functions, E, G and α interpolated linearly between the materials; `heating`: rise of temperature per b*."""

    def at(T):
        i = min(max(np.searchsorted(temperatures, T) - 1, 0), len(temperatures) - 2)
        low, high, step = materials[i], materials[i + 1], temperatures[i + 1] - temperatures[i]
        w = (T - temperatures[i]) / step

        def between(name):
            return lambda b: (1 - w) * getattr(low, name)(b) + w * getattr(high, name)(b)

        G = (1 - w) * low.G + w * high.G
        E = (1 - w) * 2 * low.G * (1 + low.nu) + w * 2 * high.G * (1 + high.nu)
        return SimpleNamespace(
            **{name: between(name) for name in ("k2", "slope", "zeta", "kappa")},
            G=G,
            nu=E / (2 * G) - 1,
            alpha=(1 - w) * low.alpha + w * high.alpha,
            softening=lambda b: (high.k2(b) - low.k2(b)) / step,
        )

    return SimpleNamespace(at=at, heating=heating, start=temperatures[0])


class Reference:
    """Integrates a path of straight strain segments.

    State: σ (6), B (6), b*, T, in the order 11, 22, 33, 12, 13, 23, tensor components. In the rod ε22, ε33 and γ23 are
        free, the objective rates of σ22, σ33, σ23 vanish, and the spin w1j = −½ γ1j turns the rod's six numbers by
        (5.2.33).
    """

    warming = 0.0  # prescribed rate of the temperature

    def __init__(self, material, rod=True, spin=False):
        self.m, self.rod, self.spin = material, rod, spin

    def rates(self, y, D, plastic):
        """State rates; with `plastic` None the loading condition decides."""
        if plastic is None:
            rate, stays = self._solve(y, D, None)
            if not stays > 0:
                return rate
            rate, multiplier = self._solve(y, D, self._kappa(y))
            if multiplier >= 0:
                rate[12] = max(rate[12], 0.0)  # the rod's spin terms can make it negative by a trifle
                return rate
            kappa = brentq(lambda k: self._solve(y, D, k)[1], 0, self._kappa(y), xtol=1e-18, rtol=1e-12)
            return self._solve(y, D, kappa)[0]
        return self._solve(y, D, None)[0]

    def _kappa(self, y):
        return self.m.at(y[13]).kappa(y[12])

    def _solve(self, y, D, kappa):
        """Rates for given κ, and the multiplier μ = 2λ; κ None: elastic, and half the rate of n:n − k²."""
        m = self.m.at(y[13])
        G, nu = m.G, m.nu
        S, B, b = y[:6], y[6:12], y[12]
        n = DEVIATOR @ S - B
        bulk = 2 * G * (1 + nu) / (3 * (1 - 2 * nu))
        elastic = 2 * G * DEVIATOR + bulk * np.outer(UNIT, UNIT)
        spin = self._spin(S, B, D) if self.spin else np.zeros(14)
        spin_n = np.dot(WEIGHT * n, DEVIATOR @ spin[:6] - spin[6:12])
        # Unknowns: D (6), D_pl (6), μ, Ṫ.
        A, r = np.zeros((14, 14)), np.zeros(14)
        for i in range(6):
            if self.rod and i in (1, 2, 5):
                A[i, :6], A[i, 6:12], A[i, 13] = elastic[i], -elastic[i], -m.alpha * elastic[i] @ UNIT  # (5.2.32)
            else:
                A[i, i], r[i] = 1, D[i]
        zeta = m.zeta(b)
        if kappa is None:
            A[6:12, 6:12], A[12, 12] = np.eye(6), 1
        else:
            # (1 + κζ) D_pl − μ n − κ Ť = 0, Ť = 2G dev(D − D_pl)
            stress = 2 * G * DEVIATOR
            A[6:12, :6] = -kappa * stress
            A[6:12, 6:12] = (1 + kappa * zeta) * np.eye(6) + kappa * stress
            A[6:12, 12] = -n
            # 2 n:(Ť − ζ D_pl + spin) = k²′ n:D_pl + ∂k²/∂T Ṫ
            A[12, :6] = 2 * (WEIGHT * n) @ stress
            A[12, 6:12] = -2 * (WEIGHT * n) @ (stress + zeta * np.eye(6)) - m.slope(b) * WEIGHT * n
            A[12, 13] = -m.softening(b)
            r[12] = -2 * spin_n
        A[13, 6:12], A[13, 13], r[13] = -self.m.heating * WEIGHT * n, 1, self.warming
        scale = np.ones(14)
        scale[12] = 1e-6
        x = np.linalg.solve(A * scale, r) * scale
        D, Dp = x[:6], x[6:12]
        rate = spin.copy()
        rate[:6] += elastic @ (D - Dp - m.alpha * x[13] * UNIT)
        rate[6:12] += zeta * Dp
        rate[12:] = np.dot(WEIGHT * n, Dp), x[13]
        if kappa is None:
            return rate, np.dot(WEIGHT * n, DEVIATOR @ rate[:6] - rate[6:12]) - 0.5 * m.softening(b) * x[13]
        return rate, x[12]

    @staticmethod
    def _spin(S, B, D):
        spin = np.zeros(14)
        for j in (3, 4):
            w = -D[j]  # w1j = −½ γ1j
            spin[0] += 2 * w * S[j]
            spin[j] -= w * S[0]
            spin[6] += 2 * w * B[j]
            spin[6 + j] -= w * 1.5 * B[0]
        # B22 = B33 = −½ B11 is what closes the rod's equations.
        spin[7] = spin[8] = -0.5 * spin[6]
        return spin

    def excess(self, y):
        """n:n − k²."""
        n = DEVIATOR @ y[:6] - y[6:12]
        return np.dot(WEIGHT * n, n) - self.k2(y)

    def k2(self, y):
        """k² of a state."""
        return self.m.at(y[13]).k2(y[12])

    def _plastic_rates(self, _, y, D):
        return self.rates(y, D, None)

    def _elastic(self, y, D, k2, marks):
        """Elastic piece up to the yield surface; in short steps, lest a small elastic chord be missed."""

        def leave(_, y, D):
            return self.excess(y) - 1e-12 * k2

        def rates(_, y, D):
            return self.rates(y, D, False)

        leave.terminal, leave.direction = True, 1
        return solve_ivp(rates, (0, 1), y, events=leave, t_eval=marks, max_step=2e-3, args=(D,), **ACCURACY)

    def path(self, segments, checkpoints=1, warming=None):
        """States at equidistant checkpoints of every segment, shape (segments × checkpoints, 14).

        Args:
            segments: strain increments, shape (…, 3) for the rod (ε11, γ12, γ13), (…, 6) else, engineering shear.
            checkpoints: number in each segment.
            warming: prescribed change of temperature in each segment.
        """
        y, states = np.zeros(14), []
        y[13] = self.m.start
        segments = np.atleast_2d(segments)
        for segment, change in zip(segments, warming if warming else np.zeros(len(segments)), strict=True):
            D, self.warming = np.zeros(6), change
            D[[0, 3, 4] if self.rod else range(6)] = segment
            D[3:] /= 2
            t = 0.0
            marks = np.arange(1, checkpoints + 1) / checkpoints
            k2 = self.k2(y)
            if self.excess(y) < -1e-9 * k2 or self._solve(y, D, None)[1] <= 0:
                found = self._elastic(y, D, k2, marks)
                states.extend(np.reshape(found.y, (14, -1)).T)
                if found.status == 0:
                    y = found.y[:, -1]
                    continue
                t, y = found.t_events[0][0], found.y_events[0][0]
            rest = np.append(marks[marks > t], [] if marks[-1] > t else 1.0)
            found = solve_ivp(self._plastic_rates, (t, 1), y, t_eval=rest, max_step=0.05, args=(D,), **ACCURACY)
            assert found.success, found.message
            states.extend(found.y.T)
            y = found.y[:, -1]
            assert abs(self.excess(y)) < 1e-6 * self.k2(y)
        return np.array(states)
