"""Identification of the law's constants from tests, in the order of the thesis (6.2.2).

1. Tension gives the hardening k²(b*): plastic work is integrated from the test itself, and without back stress the
   yield condition (3.1.4) makes k² = ⅔σ².
2. Torsion with reversal parts it into isotropic and kinematic hardening, ζ(b*).
3. Tension-torsion with an abrupt change gives the deviation from normality, κ(b*).
Last, all constants are adjusted together to all tests, from several bends b1* of k²; the uncertainties are those of
this step.

The two branches of k² meet at b1* with the same slope, as with the thesis's constants: k1² and a4 follow from the
others.
"""

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from scipy.optimize import least_squares
from scipy.stats import norm

from coilset.model.errors import InputError, SolveError
from coilset.model.material import functions as fn
from coilset.model.material.heun import ROD_METRIC, integrate
from coilset.model.material.identification.experiments import Test

SUBSTEP = 1e-3  # greatest strain increment of the simulation
STEP = 1e-4  # of the logarithms of the variables, for derivatives
LARGE = 1e3  # residual of a law that cannot follow a test
CONFIDENCE = 0.95
# The variables. gain: k∞² − k1²; start, rest: a5 a7 and a5 a6, ζ over sqrt(6 k²) at b* = 0 and for large b*.
HARDENING, KINEMATIC, NORMALITY = ("k0", "a1", "a2", "a3", "b1", "gain"), ("start", "rest", "a7"), ("a",)
COLUMNS_USED = {"tension": [0], "torsion": [1], "combined": [0, 1]}
NO_BACK_STRESS = {"start": 0.0, "rest": 0.0, "a7": 1.0}


@njit(**fn.KERNEL)
def _simulate(p, strain, stress):
    """Stress along a strain path, by Heun's method with sub-steps of fixed size, smooth in the constants.

    Returns:
        b* at the end, -1 if the law cannot follow the path.
    """
    y, d, w = np.zeros(9), np.zeros(3), np.array(ROD_METRIC)
    e = g = 0.0
    for i in range(strain.shape[0]):
        de, dg = strain[i, 0] - e, strain[i, 1] - g
        e, g = strain[i, 0], strain[i, 1]
        n = max(1, math.ceil(max(abs(de), abs(dg)) / SUBSTEP))
        d[0], d[1] = de / n, 0.5 * dg / n
        for _ in range(n):
            if integrate(p, y, w, d, 0.0, (0.0, 0.0))[0] < 0:
                return -1.0
        stress[i, 0], stress[i, 1] = 1.5 * y[0], y[1]
    return y[6]


class _Model:
    """The law as a function of the fit's variables."""

    def __init__(self, G, nu, saturates):
        self.G, self.nu = G, nu
        self.hardening = [name for name in HARDENING if saturates or name not in ("b1", "gain")]
        self.names = [*self.hardening, *KINEMATIC, *NORMALITY]

    def row(self, values):
        """A row of the parameter array, and k1², a4."""
        v = {"b1": math.inf, "gain": math.inf, "start": 0.0, "rest": 0.0, "a7": 1.0, "a": 0.0} | values
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

    def parameters(self, values):
        """Parameter array of the kernels."""
        head = np.zeros(fn.ROWS_START)
        head[[fn.SPIN, fn.TEMPERATURE, fn.TOLERANCE, fn.N_ROWS]] = 1, 293.15, np.inf, 1
        return np.concatenate([head, self.row(values)])

    def follow(self, values, test):
        """Stress along a test, infinite if the law cannot follow it, and b* at its end."""
        stress = np.zeros_like(test.stress)
        work = _simulate(self.parameters(values), test.strain, stress)
        if work < 0:
            stress[:] = np.inf
        return stress, work

    def residual(self, values, tests):
        """Difference of stress to the tests over the greatest stress of each, all in one vector."""
        parts = [(self.follow(values, test)[0] - test.stress) / np.abs(test.stress).max() for test in tests]
        # A tension test says nothing by its vanishing shear stress; a torsion test's axial one depends on κ, of step 3.
        used = [part[:, COLUMNS_USED[test.kind]] for part, test in zip(parts, tests, strict=True)]
        return np.nan_to_num(np.concatenate([part.ravel() for part in used]), nan=LARGE, posinf=LARGE, neginf=-LARGE)


@njit(**fn.KERNEL)
def _follow(start, rest, a7, plastic, stress, work, k2):
    """Plastic work and n:n along a measured path, with the back stress of (3.1.7) and (3.1.8).

    `plastic` are the plastic strains ε11 and γ12; ζ is (rest + start exp(−a7 b*)) sqrt(6 n:n), with the measured n.
    """
    back, b, nn = np.zeros(2), 0.0, 0.0
    for i in range(plastic.shape[0]):
        if i > 0:
            zeta = (rest + start * math.exp(-a7 * b)) * math.sqrt(6.0 * nn)
            de, dg = plastic[i, 0] - plastic[i - 1, 0], plastic[i, 1] - plastic[i - 1, 1]
            b += 1.5 * (stress[i, 0] / 1.5 - back[0]) * de + (stress[i, 1] - back[1]) * dg
            b = max(b, 0.0)
            back[0] += zeta * de
            back[1] += 0.5 * zeta * dg
        nn = 1.5 * (stress[i, 0] / 1.5 - back[0]) ** 2 + 2.0 * (stress[i, 1] - back[1]) ** 2
        work[i], k2[i] = b, nn


def _hardening(model, tests, kinematic, starts, held=()):
    """k² over the plastic work as the tests themselves have it, for given ζ; `held` variables stay; and its reach."""
    moduli = np.array([2 * model.G * (1 + model.nu), model.G])
    points = []
    for test in tests:
        plastic = test.strain - test.stress / moduli
        work, k2 = np.empty(len(plastic)), np.empty(len(plastic))
        _follow(*(kinematic[name] for name in KINEMATIC), plastic, test.stress, work, k2)
        length = np.linalg.norm(np.diff(plastic, axis=0, prepend=0), axis=1).cumsum()
        flows = (length > 5e-4) & (work > 0) & (k2 > 0.85 * np.maximum.accumulate(k2))
        points.append((work[flows], k2[flows]))
    work, k2 = np.hstack(points)
    if work.size < 10:
        raise InputError(f"the tests {', '.join(test.name for test in tests)} show no yielding; is G right?")
    values = np.empty((6, work.size))

    def moved(start, x):
        return start | _moved({name: value for name, value in start.items() if name not in held}, x)

    def residual(x, start):
        fn.many(model.parameters(moved(start, x)), work, 0.0, values)
        return (values[0] - k2) / k2.max()

    found = [
        (least_squares(residual, np.zeros(len(start) - len(held)), args=(start,), bounds=(-6, 6), max_nfev=100), start)
        for start in starts(work.max(), k2.max())
    ]
    best, start = min(found, key=lambda pair: pair[0].cost)
    return moved(start, best.x) | kinematic, work.max()


def _bend_starts(model, values, tests, reach):
    """The bend b1* of k² elsewhere: least squares does not find it from afar."""
    yield values
    others = {name: values[name] for name in (*KINEMATIC, *NORMALITY)}
    for share in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8) if "b1" in values else ():
        base = {name: values[name] for name in model.hardening} | {"b1": share * reach}
        yield _hardening(model, tests, others, lambda *_, base=base: [base], ["b1"])[0]


def _moved(start, x):
    """Variables of which the logarithms changed by `x`."""
    return {name: value * math.exp(change) for (name, value), change in zip(start.items(), x, strict=True)}


def _first_starts(model):
    """Shapes of k² from which step 1 starts."""

    def starts(reach, top):
        for a3, share in itertools.product((3, 10, 30), (0.3, 0.5, 0.7) if "b1" in model.hardening else (1.0,)):
            start = {"k0": 0.5 * top, "a1": 0.5 * top, "a2": 1 / reach, "a3": a3 / reach}
            yield start | ({"b1": share * reach, "gain": 0.2 * top} if "b1" in model.hardening else {})

    return starts


def _kinematic_starts(model, hardening, tests, reach):
    """Step 2 starts from back stresses of several sizes, with the k² that the tests have with each of them."""
    base = {name: hardening[name] for name in model.hardening}
    for size, a7, rest in itertools.product((0.05, 0.2, 0.6), (5 / reach, 25 / reach, 125 / reach), (0.02, 0.2)):
        k = math.sqrt(hardening["k0"])
        kinematic = {"start": size * a7 * k, "rest": rest * k / reach, "a7": a7}
        yield _hardening(model, tests, kinematic, lambda *_: [base])[0]


def _adjust(model, values, names, tests):
    """Least squares over the logarithms of the constants `names`, started at `values`."""
    start = {name: values[name] for name in names}

    def residual(x):
        return model.residual(values | _moved(start, x), tests)

    def slopes(x):
        here = residual(x)
        return np.array([residual(x + step) - here for step in STEP * np.eye(x.size)]).T / STEP

    found = least_squares(residual, np.zeros(len(names)), slopes, bounds=(-12, 12), ftol=1e-7, xtol=1e-6, max_nfev=60)
    return values | _moved(start, found.x), found


def _minima(model, starts, names, tests):
    """Minima that `_adjust` finds from the starts, the deepest first, each once."""
    found = sorted((_adjust(model, start, names, tests) for start in starts), key=lambda pair: pair[1].cost)
    new = [i == 0 or pair[1].cost > found[i - 1][1].cost * (1 + 1e-4) for i, pair in enumerate(found)]
    return list(itertools.compress(found, new))


def _closest(model, starts, tests, number):
    """The starts that fit best."""
    return sorted(starts, key=lambda start: np.sum(model.residual(start, tests) ** 2))[:number]


@dataclass(frozen=True)
class Fit:
    """The result of `fit`.

    Attributes:
        G, nu, temperature: as given.
        constants: by their names in a material file.
        standard: standard deviation of each.
        uncertainty: all constants lie within these distances with 95 % confidence.
        tests: as given.
        stress: of the law along each test, shape (rows, 2), N/mm².
        scatter: rms residual of each test, N/mm².
        work: greatest b* of the tests, N/mm².
    """

    G: float
    nu: float
    temperature: float
    constants: dict[str, float]
    standard: dict[str, float]
    uncertainty: dict[str, float]
    tests: tuple[Test, ...]
    stress: tuple[np.ndarray, ...]
    scatter: tuple[float, ...]
    work: float

    def material(self, name: str) -> dict[str, Any]:
        """Content of a material file."""
        c = self.constants
        isotropic = {key: c[key] for key in ("k0_squared", "a1", "a2", "a3")}
        if "b1" in c:
            isotropic["saturation"] = {key: c[key] for key in ("b1", "k1_squared", "k_inf_squared", "a4")}
        at = {
            "temperature": self.temperature,
            "elasticity": {"G": self.G, "nu": self.nu},
            "isotropic": isotropic,
            "kinematic": {key: c[key] for key in ("a5", "a6", "a7")},
            "non_normality": {"a": c["a"]},
        }
        return {
            "name": name,
            "description": "Constants identified from tests",
            "source": "coilset material fit: " + ", ".join(test.name for test in self.tests),
            "units": "N, mm, K",
            "validity": {"plastic_work": float(f"{self.work:.3g}"), "remark": "As far as the tests went."},
            "temperatures": [at],
        }


def fit(tests: Iterable[Test], G: float, nu: float, saturates: bool = True, temperature: float = 293.15) -> Fit:
    """Identify the constants of k², ζ and κ.

    Args:
        tests: `Test` objects, at least one each of tension, torsion with reversal, and tension-torsion.
        G, nu: elastic constants, measured before; N/mm².
        saturates: whether k² has its second branch; the tests must reach it.
        temperature: of the tests, K.

    Returns:
        A `Fit`.

    Raises:
        InputError: if a kind of test is missing.
        SolveError: if the constants cannot be told from these tests.
    """
    tests = tuple(tests)
    kinds = {kind: [test for test in tests if test.kind == kind] for kind in ("tension", "torsion", "combined")}
    for kind, use in (("tension", "k²"), ("torsion", "ζ"), ("combined", "κ")):
        if not kinds[kind]:
            raise InputError(f"there is no {kind} test among the data; without it {use} cannot be identified")
    model = _Model(float(G), float(nu), saturates)
    proportional, names = kinds["tension"] + kinds["torsion"], [*model.hardening, *KINEMATIC]
    values, reach = _hardening(model, kinds["tension"], NO_BACK_STRESS, _first_starts(model))
    starts = _closest(model, _kinematic_starts(model, values, proportional, reach), proportional, 2)
    values, _ = _minima(model, starts, names, proportional)[0]
    starts = [values | {"a": 10.0**n} for n in range(-7, 0)]
    values, _ = _minima(model, _closest(model, starts, kinds["combined"], 1), NORMALITY, kinds["combined"])[0]
    minima = _minima(model, _bend_starts(model, values, proportional, reach), model.names, tests)
    return _result(model, minima, tests, float(temperature))


def _result(model, minima, tests, temperature):
    """The deepest minimum; others that the scatter of the tests does not exclude widen the uncertainties."""
    best, found = minima[0]
    if not found.cost < LARGE:
        raise SolveError("no constants were found with which the law can follow these tests; are their units right?")
    constants = _constants(model, best)
    value = np.array(list(constants.values()))
    spread = _spread(model, best, found)
    variance = 2 * found.cost / (found.fun.size - len(model.names))
    coverage = norm.isf(0.5 * (1 - CONFIDENCE) / len(model.names))  # Bonferroni's, for all constants together
    uncertainty = coverage * spread
    for other, local in minima[1:]:
        if 2 * (local.cost - found.cost) < coverage**2 * variance:
            away = abs(np.array(list(_constants(model, other).values())) - value)
            uncertainty = np.maximum(uncertainty, away + coverage * _spread(model, other, local))
    followed = [model.follow(best, test) for test in tests]
    stress = tuple(stress for stress, _ in followed)
    scatter = tuple(float(np.sqrt(np.mean((s - t.stress) ** 2))) for s, t in zip(stress, tests, strict=True))
    standard, uncertainty = (dict(zip(constants, v.tolist(), strict=True)) for v in (spread, uncertainty))
    work = max(work for _, work in followed)
    return Fit(model.G, model.nu, temperature, constants, standard, uncertainty, tests, stress, scatter, work)


def _constants(model, values):
    """The material file's constants."""
    row = model.row(values)
    names = {"k0_squared": fn.K0, "a1": fn.A1, "a2": fn.A2, "a3": fn.A3}
    if "b1" in model.names:
        names |= {"b1": fn.B1, "k1_squared": fn.K1, "k_inf_squared": fn.KINF, "a4": fn.A4}
    names |= {"a5": fn.A5, "a6": fn.A6, "a7": fn.A7}
    return {name: float(row[place]) for name, place in names.items()} | {"a": float(values["a"])}


def _spread(model, values, found):
    """Standard deviations of the file's constants.

    The covariance of the variables' logarithms is robust against scatter that differs from test to test.
    """
    J = found.jac
    weighted = J * found.fun[:, None]
    try:
        inverse = np.linalg.inv(J.T @ J)
    except np.linalg.LinAlgError as error:
        raise SolveError("these tests cannot tell the constants apart; other paths are needed") from error
    covariance = inverse @ (weighted.T @ weighted) @ inverse * J.shape[0] / (J.shape[0] - J.shape[1])
    start = {name: values[name] for name in model.names}
    moved = [list(_constants(model, _moved(start, step)).values()) for step in 1e-6 * np.eye(len(start))]
    gradient = (np.array(moved) - list(_constants(model, start).values())).T / 1e-6
    return np.sqrt(np.einsum("ij,jk,ik->i", gradient, covariance, gradient))
