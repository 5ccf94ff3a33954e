"""Identification of the law's constants from tests, in the order of the thesis (6.2.2).

1. Tension gives the hardening k²(b*): its plastic work is integrated from the test itself, and without back stress the
yield
   condition (3.1.4) makes k² = ⅔σ².
2. Torsion with reversal parts it into isotropic and kinematic hardening, ζ(b*).
3. Tension-torsion with an abrupt change gives the deviation from normality, κ(b*).
Last, all constants are adjusted together to all tests; the uncertainties are those of this step.

The two branches of k² meet at b1* with the same slope, as with the thesis's constants: k1² and a4 follow from the
others.
"""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numba import njit
from scipy.optimize import least_squares

from coilset.model.errors import InputError, SolveError
from coilset.model.material import functions as fn
from coilset.model.material.heun import rod_heun

COLUMNS = ("eps11", "gamma12", "sigma11", "tau12")
SUBSTEP = 5e-4  # greatest strain increment of the simulation
COVERAGE = 1.96  # of 95 %
HARDENING, KINEMATIC, NORMALITY = ("k0", "a1", "a2", "a3", "b1", "kinf"), ("start", "rest", "a7"), ("a",)


@dataclass(frozen=True)
class Test:
    """A strain-controlled test: strain ε11, γ12, shape (rows, 2), and the stress σ11, τ12 it gave, N/mm²."""

    __test__ = False  # not a test of pytest
    name: str
    strain: np.ndarray
    stress: np.ndarray

    @property
    def kind(self):
        """tension, torsion or combined."""
        tension, torsion = np.abs(self.strain).max(axis=0)
        if torsion < 1e-2 * tension:
            return "tension"
        return "torsion" if tension < 1e-2 * torsion else "combined"


def read_test(path):
    """Read a test: a CSV file with the columns eps11, gamma12, sigma11, tau12 (N/mm²), from the unloaded start on.

    Raises:
        InputError: if the file cannot be read, or a column or a number is missing or wrong.
    """
    path = Path(path)
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            missing = [name for name in COLUMNS if name not in (reader.fieldnames or ())]
            if missing:
                raise InputError(f"is missing; the columns are {', '.join(COLUMNS)}", f"column {missing[0]}", str(path))
            rows = [[_number(row[name], name, reader.line_num, path) for name in COLUMNS] for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"cannot be read ({getattr(error, 'strerror', None) or error})", file=str(path)) from error
    if len(rows) < 20:
        raise InputError(f"has {len(rows)} rows; a test needs at least 20", file=str(path))
    values = np.array(rows)
    return Test(path.stem, values[:, :2], values[:, 2:])


def _number(text, name, line, path):
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"'{text}' is no number", f"line {line}, column {name}", str(path))
    return value


@njit(**fn.KERNEL)
def _simulate(p, strain, stress):
    """Stress along a strain path, by Heun's method with sub-steps of fixed size, smooth in the constants."""
    state, new, tangent = np.zeros(7), np.zeros(7), np.zeros((3, 3))
    e = g = 0.0
    for i in range(strain.shape[0]):
        de, dg = strain[i, 0] - e, strain[i, 1] - g
        e, g = strain[i, 0], strain[i, 1]
        n = max(1, math.ceil(max(abs(de), abs(dg)) / SUBSTEP))
        for _ in range(n):
            if rod_heun(p, state, de / n, dg / n, 0.0, new, tangent) < 0:
                return False
            state[:] = new
        stress[i, 0], stress[i, 1] = state[0], state[1]
    return True


class _Model:
    """The law as a function of the fit's variables."""

    def __init__(self, G, nu, saturates):
        self.G, self.nu = G, nu
        self.names = [n for n in HARDENING if saturates or n not in ("b1", "kinf")] + [*KINEMATIC, *NORMALITY]

    def row(self, values):
        """A row of the parameter array, and k1², a4."""
        v = {"b1": math.inf, "kinf": math.inf, "start": 0.0, "rest": 0.0, "a7": 1.0, "a": 0.0} | values
        row = np.zeros(fn.ROW_LENGTH)
        row[[fn.ROW_T, fn.YOUNG, fn.SHEAR]] = 293.15, 2 * self.G * (1 + self.nu), self.G
        row[[fn.K0, fn.A1, fn.A2, fn.A3, fn.B1]] = v["k0"], v["a1"], v["a2"], v["a3"], v["b1"]
        if math.isfinite(v["b1"]):
            fading = math.exp(-v["a3"] * v["b1"])
            k1 = v["k0"] + v["a1"] * (1 + v["a2"] * v["b1"] - fading)
            slope = v["a1"] * (v["a2"] + v["a3"] * fading)
            row[[fn.K1, fn.KINF, fn.A4]] = k1, v["kinf"], slope / max(v["kinf"] - k1, 1e-6 * k1)
        row[[fn.A5, fn.A6, fn.A7]] = v["start"] / v["a7"], v["rest"] * v["a7"] / max(v["start"], 1e-12), v["a7"]
        row[fn.KAPPA] = v["a"] / (2 * self.G)
        return row

    def stress(self, values, test):
        head = np.zeros(fn.ROWS_START)
        head[[fn.TEMPERATURE, fn.TOLERANCE, fn.N_ROWS]] = 293.15, np.inf, 1
        stress = np.zeros_like(test.stress)
        if not _simulate(np.concatenate([head, self.row(values)]), test.strain, stress):
            stress[:] = np.inf
        return stress

    def residual(self, values, tests):
        """Difference of stress to the tests over the greatest stress of each, all in one vector."""
        parts = [(self.stress(values, test) - test.stress) / np.abs(test.stress).max() for test in tests]
        # What a test does not load is not part of it: a tension test says nothing by its vanishing shear stress.
        used = [part[:, np.ptp(test.strain, axis=0) > 0] for part, test in zip(parts, tests, strict=True)]
        return np.nan_to_num(np.concatenate([part.ravel() for part in used]), nan=1e3, posinf=1e3, neginf=-1e3)


def _hardening(model, test, saturates):
    """Step 1: k² over the plastic work of a tension test."""
    E = 2 * model.G * (1 + model.nu)
    strain, stress = test.strain[:, 0], test.stress[:, 0]
    plastic = strain - stress / E
    work = np.concatenate([[0.0], np.cumsum(0.5 * (stress[1:] + stress[:-1]) * np.diff(plastic))])
    loaded = (plastic > 2e-4) & (np.gradient(strain) > 0)
    work, k2 = np.maximum(work[loaded], 0.0), 2 / 3 * stress[loaded] ** 2
    if work.size < 10:
        raise InputError(f"test '{test.name}' shows no yielding; is G right?")
    names = [n for n in HARDENING if n in model.names]
    scale = {"k0": k2[:3].mean(), "a1": np.ptp(k2), "a2": 1 / work[-1], "a3": 10 / work[-1], "kinf": 1.1 * k2.max()}
    head = np.zeros(fn.ROWS_START)
    head[fn.N_ROWS] = 1

    def residual(x, b1):
        values = np.zeros((6, work.size))
        fn.many(np.concatenate([head, model.row(dict(zip(names, np.abs(x) * b1, strict=True)))]), work, 0.0, values)
        return (values[0] - k2) / k2.max()

    best = None
    for share in (0.3, 0.5, 0.7) if saturates else (1.0,):
        size = np.array([(scale | {"b1": share * work[-1]})[name] for name in names])
        found = least_squares(residual, np.ones(size.size), args=(size,), x_scale="jac", max_nfev=400)
        if best is None or found.cost < best[0]:
            best = found.cost, dict(zip(names, np.abs(found.x) * size, strict=True))
    return best[1]


def _adjust(model, values, names, tests):
    """Least squares over the constants `names`, started at `values`; all are positive."""
    start = np.array([values[name] for name in names])

    def residual(x):
        return model.residual(values | dict(zip(names, start * x, strict=True)), tests)

    bounds = (np.full(start.size, 1e-6), np.full(start.size, np.inf))
    found = least_squares(residual, np.ones(start.size), bounds=bounds, x_scale="jac", diff_step=1e-5, max_nfev=200)
    return values | dict(zip(names, start * found.x, strict=True)), found


def _best(model, values, starts, names, tests):
    """`_adjust` from the start that fits best."""
    costs = [np.sum(model.residual(values | start, tests) ** 2) for start in starts]
    return _adjust(model, values | starts[int(np.argmin(costs))], names, tests)[0]


@dataclass(frozen=True)
class Fit:
    """The result of `fit`.

    constants: by their names in a material file; uncertainty: half the width of the 95 % confidence interval of each;
    stress: of the law along each test; scatter: rms residual of each test, N/mm².
    """

    G: float
    nu: float
    constants: dict
    uncertainty: dict
    tests: tuple
    stress: tuple
    scatter: tuple

    def material(self, name):
        """Content of a material file."""
        c = self.constants
        isotropic = {key: c[key] for key in ("k0_squared", "a1", "a2", "a3")}
        if "b1" in c:
            isotropic["saturation"] = {key: c[key] for key in ("b1", "k1_squared", "k_inf_squared", "a4")}
        reached = max(float(_work(test)) for test in self.tests)
        return {
            "name": name,
            "description": "Constants identified from tests",
            "source": "coilset material fit: " + ", ".join(test.name for test in self.tests),
            "units": "N, mm, K",
            "validity": {"plastic_work": round(reached, 1), "remark": "As far as the tests went."},
            "temperatures": [
                {
                    "temperature": 293.15,
                    "elasticity": {"G": self.G, "nu": self.nu},
                    "isotropic": isotropic,
                    "kinematic": {key: c[key] for key in ("a5", "a6", "a7")},
                    "non_normality": {"a": c["a"]},
                }
            ],
        }


def _work(test):
    """Upper bound of the plastic work of a test, from the whole work."""
    return np.abs(0.5 * (test.stress[1:] + test.stress[:-1]) * np.diff(test.strain, axis=0)).sum()


def _constants(model, values):
    row = model.row(values)
    names = {"k0_squared": fn.K0, "a1": fn.A1, "a2": fn.A2, "a3": fn.A3}
    if "b1" in model.names:
        names |= {"b1": fn.B1, "k1_squared": fn.K1, "k_inf_squared": fn.KINF, "a4": fn.A4}
    names |= {"a5": fn.A5, "a6": fn.A6, "a7": fn.A7}
    return {name: float(row[place]) for name, place in names.items()} | {"a": float(values["a"])}


def fit(tests, G, nu, saturates=True):
    """Identify the constants of k², ζ and κ.

    Args:
        tests: `Test` objects, at least one each of tension, torsion with reversal, and tension-torsion.
        G, nu: elastic constants, measured before; N/mm².
        saturates: whether k² has its second branch; the tests must reach it.

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
    hardening = [name for name in HARDENING if name in model.names]
    values = _hardening(model, kinds["tension"][0], saturates)
    k = math.sqrt(values["k0"])
    starts = [{"start": k * s, "rest": 0.01 * k * s, "a7": a7} for s in (0.003, 0.03, 0.3) for a7 in (0.1, 0.5, 2.0)]
    values = _best(model, values, starts, [*hardening, *KINEMATIC], kinds["tension"] + kinds["torsion"])
    values = _best(model, values, [{"a": 10.0**n} for n in range(-7, 0)], NORMALITY, kinds["combined"])
    values, found = _adjust(model, values, model.names, tests)
    covariance = _covariance(found)
    base = np.array([values[name] for name in model.names])
    constants = _constants(model, values)
    gradient = np.empty((len(constants), base.size))  # of the file's constants by the relative change of the variables
    for j, name in enumerate(model.names):
        moved = _constants(model, values | {name: base[j] * (1 + 1e-6)})
        gradient[:, j] = [(moved[key] - constants[key]) / 1e-6 for key in constants]
    spread = np.sqrt(np.einsum("ij,jk,ik->i", gradient, covariance, gradient))
    stress = tuple(model.stress(values, test) for test in tests)
    scatter = tuple(float(np.sqrt(np.mean((s - t.stress) ** 2))) for s, t in zip(stress, tests, strict=True))
    uncertainty = dict(zip(constants, (COVERAGE * spread).tolist(), strict=True))
    return Fit(model.G, model.nu, constants, uncertainty, tests, stress, scatter)


def _covariance(found):
    """Covariance of the relative changes, robust against scatter that differs from test to test."""
    J = found.jac * found.x
    try:
        inverse = np.linalg.inv(J.T @ J)
    except np.linalg.LinAlgError as error:
        raise SolveError("these tests cannot tell the constants apart; other paths are needed") from error
    weighted = J * found.fun[:, None]
    return inverse @ (weighted.T @ weighted) @ inverse * J.shape[0] / (J.shape[0] - J.shape[1])
