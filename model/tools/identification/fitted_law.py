"""The law as a function of the variables that are fitted: positive numbers, changed by their logarithms.

The two branches of k² meet at b1* with the same slope, as with the thesis's constants: k1² and a4 follow from the
others.
"""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from coilset.model.core.material.law import functions as fn
from coilset.model.core.material.law.loop import PointLaw, flow_points
from coilset.model.core.material.law.parts import simple
from coilset.model.core.material.point.loops import with_loop
from coilset.model.core.runtime.kernels import njit
from coilset.model.tools.identification.experiments import COMPONENTS, Test

SUBSTEP = 1e-3  # maximum strain increment of the simulation
LARGE = 1e3  # residual of a law that cannot follow a test
# The variables. gain: k∞² − k1²; start, rest: a5 a7 and a5 a6, ζ over sqrt(6 k²) at b* = 0 and for large b*.
HARDENING, KINEMATIC, NORMALITY = ("k0", "a1", "a2", "a3", "b1", "gain"), ("start", "rest", "a7"), ("a",)

Variables = Mapping[str, float]


@njit(**fn.KERNEL)
def _simulate(law: PointLaw, strain: np.ndarray, stress: np.ndarray) -> float:
    """Stress along a strain path, in sub-steps of fixed size, smooth in the constants.

    Returns:
        b* at the end, -1 if the law cannot follow the path.
    """
    y, new, d, C, count = np.zeros((1, 7)), np.zeros((1, 7)), np.zeros((3, 1)), np.empty((9, 1)), np.zeros(1, np.int64)
    e = g = 0.0
    for i in range(strain.shape[0]):
        de, dg = strain[i, 0] - e, strain[i, 1] - g
        e, g = strain[i, 0], strain[i, 1]
        n = max(1, math.ceil(max(abs(de), abs(dg)) / SUBSTEP))
        d[0, 0], d[1, 0] = de / n, dg / n
        for _ in range(n):
            if not flow_points(law, 3, y, d, new, C, True, count):
                return -1.0
            for j in range(7):
                y[0, j] = new[0, j]
        stress[i, 0], stress[i, 1] = y[0, 0], y[0, 1]
    return y[0, 6]


class FittedLaw:
    """The law as a function of the fit's variables.

    Args:
        G, nu: elastic constants, N/mm².
        saturates: whether k² has its second branch.
        isotropic: whether there is only k², without back stress and with normality.

    Attributes:
        hardening, names: names of the variables of k², and of all.
    """

    def __init__(self, G: float, nu: float, saturates: bool, isotropic: bool = False) -> None:
        self.G, self.nu, self.isotropic = G, nu, isotropic
        self.hardening = [name for name in HARDENING if saturates or name not in ("b1", "gain")]
        self.names = [*self.hardening] if isotropic else [*self.hardening, *KINEMATIC, *NORMALITY]

    def row(self, values: Variables) -> np.ndarray:
        """A row of the parameter array, and k1², a4."""
        v = {"b1": math.inf, "gain": math.inf, "start": 0.0, "rest": 0.0, "a7": 1.0, "a": 0.0} | dict(values)
        row = np.zeros(fn.ROW_LENGTH)
        row[[fn.ROW_T, fn.YOUNG, fn.SHEAR]] = 293.15, 2 * self.G * (1 + self.nu), self.G
        row[[fn.K0, fn.A1, fn.A2, fn.A3, fn.B1]] = v["k0"], v["a1"], v["a2"], v["a3"], v["b1"]
        if math.isfinite(v["b1"]):
            fading = math.exp(-v["a3"] * v["b1"])
            k1 = v["k0"] + v["a1"] * (1 + v["a2"] * v["b1"] - fading)
            slope = v["a1"] * (v["a2"] + v["a3"] * fading)
            row[[fn.K1, fn.KINF, fn.A4]] = k1, k1 + v["gain"], slope / v["gain"]
        row[[fn.A5, fn.A6, fn.A7]] = v["start"] / v["a7"], v["rest"] * v["a7"] / max(v["start"], 1e-12), v["a7"]
        row[fn.KAPPA] = v["a"] / (2 * self.G)
        return row

    def parameters(self, values: Variables) -> np.ndarray:
        """Parameter array of the kernels."""
        head = np.zeros(fn.ROWS_START)
        head[[fn.SPIN, fn.TEMPERATURE, fn.N_ROWS]] = 1, 293.15, 1
        return np.concatenate([head, self.row(values)])

    def follow(self, values: Variables, test: Test) -> tuple[np.ndarray, float]:
        """Stress along a test, infinite if the law cannot follow it, and b* at its end."""
        stress = np.zeros_like(test.stress)
        work = _simulate(with_loop(simple(self.parameters(values)), 3), test.strain, stress)
        if work < 0:
            stress[:] = np.inf
        return stress, work

    def residual(self, values: Variables, tests: Iterable[Test]) -> np.ndarray:
        """Difference of stress to the tests over the maximum stress of each, all in one vector."""
        parts = [(self.follow(values, test)[0] - test.stress) / np.abs(test.stress).max() for test in tests]
        # A tension test's zero shear stress carries no information; a torsion test's axial one depends on κ, of step 3.
        used = [part[:, COMPONENTS[test.kind]] for part, test in zip(parts, tests, strict=True)]
        return np.nan_to_num(np.concatenate([part.ravel() for part in used]), nan=LARGE, posinf=LARGE, neginf=-LARGE)


def moved_by(start: Variables, x: np.ndarray) -> dict[str, float]:
    """Variables of which the logarithms changed by `x`."""
    return {name: value * math.exp(change) for (name, value), change in zip(start.items(), x, strict=True)}
