"""Identification of several back stresses (Chaboche) from cyclic tests in one direction: tension and compression, or
torsion.

In one direction the law of `physics/back_stresses` is scalar: with the plastic strain's length p,

    |σ − Σ Xᵢ| = σ₀ + Q (1 − exp(−m p)),   dXᵢ = Cᵢ dεᵖ − γᵢ Xᵢ dp,

and over an increment in which εᵖ goes one way, Xᵢ tends to ± Cᵢ/γᵢ as exp(−γᵢ Δp): an increment of any size is followed
exactly. Torsion is the same with √3 τ, γ/√3 and 3G. The constants σ₀, Q, m, Cᵢ/γᵢ, γᵢ are fitted by least squares, with
one back stress first and one more at a time. Q is left out if Schwarz's criterion does not require it.

What a test can determine: only flow in both directions separates the yield surface's size from the back stresses; a
γᵢ whose 1/γᵢ is far above the strain of the test leaves only Cᵢ, one far below the spacing of its readings only Cᵢ/γᵢ.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from coilset.model.core.base.errors import InputError
from coilset.model.core.runtime.kernels import KERNEL, njit
from coilset.model.tools.identification.elastic_part import check_elastic
from coilset.model.tools.identification.experiments import Test
from coilset.model.tools.identification.result import Fit, coverage, robust_covariance, spread

MOST_TERMS = 4
AXIS = {"tension": 0, "torsion": 1}  # column of the tests' arrays
STARTS_YIELD = (0.3, 0.6)  # σ₀ over the maximum stress
STARTS_RATE = (3.0, 15.0, 75.0, 400.0)  # γ times the maximum plastic strain
BOUND = 12.0  # of the logarithms' changes
BOTH_WAYS = 5e-4  # plastic strain each way, from which on a test has a reversal; more than scatter
LEAST_RISE = 1e-3  # of the maximum stress: less is no rise of the yield stress
NEWTON = 60


@njit(**KERNEL)
def follow(E: float, size: np.ndarray, X: np.ndarray, strain: np.ndarray, stress: np.ndarray) -> float:
    """Stress along a strain path in one direction.

    Args:
        E: modulus, N/mm².
        size: σ₀, Q, m.
        X: Cᵢ/γᵢ and γᵢ, shape (terms, 2).
        strain: path from the virgin state, shape (rows,).
        stress: written.

    Returns:
        p at the end.
    """
    back, before, σ, p = np.zeros(X.shape[0]), 0.0, 0.0, 0.0
    for i in range(strain.shape[0]):
        trial = σ + E * (strain[i] - before)
        before = strain[i]
        active = trial - back.sum()
        s = 1.0 if active > 0.0 else -1.0
        Δp = 0.0
        # E Δp + Σ s Xᵢ + σ_y is convex from below in Δp: Newton's method comes from one side
        for _ in range(NEWTON):
            fade = math.exp(-size[2] * (p + Δp))
            off, slope = s * trial - E * Δp - size[0] - size[1] * (1.0 - fade), E + size[1] * size[2] * fade
            for k in range(X.shape[0]):
                left = (X[k, 0] - s * back[k]) * math.exp(-X[k, 1] * Δp)
                off -= X[k, 0] - left
                slope += X[k, 1] * left
            if off <= 1e-12 * size[0]:
                break
            Δp += off / slope
        for k in range(X.shape[0]):
            back[k] = s * X[k, 0] - (s * X[k, 0] - back[k]) * math.exp(-X[k, 1] * Δp)
        σ = trial - s * E * Δp
        p += Δp
        stress[i] = σ
    return p


@dataclass(frozen=True)
class CyclicFit(Fit):
    """The result of `fit_back_stresses`, with the constants yield_stress, rise, rate, C_1, gamma_1, C_2, ...

    Attributes:
        enough: the number of back stresses that Schwarz's criterion requires, up to the one that was fitted.
        length: maximum length of the plastic strain in a test.
    """

    enough: int
    length: float

    @property
    def terms(self) -> int:
        """Number of back stresses."""
        return sum(name.startswith("gamma") for name in self.constants)

    def material(self, name: str) -> dict[str, Any]:
        """Content of a material file."""
        c = self.constants
        isotropic: dict[str, Any] = {"k0_squared": 2.0 / 3.0 * c["yield_stress"] ** 2}
        if "rise" in c:
            isotropic = {
                "law": "voce",
                "yield_stress": c["yield_stress"],
                "rise": c["rise"],
                "rate": c["rate"],
                "up_to": max(0.3, self.length),
            }
        terms = [{"C": c[f"C_{i}"], "gamma": c[f"gamma_{i}"]} for i in range(1, self.terms + 1)]
        remark = "Cyclic tests in one direction; as far as they went."
        return self.file(name, remark, isotropic, {"law": "chaboche", "terms": terms}, "none")


@dataclass(frozen=True)
class _Path:
    """A test in one direction, in terms of tension."""

    modulus: float
    strain: np.ndarray
    stress: np.ndarray
    to_test: float


def fit_back_stresses(tests: Iterable[Test], G: float, nu: float, terms: int, temperature: float = 293.15) -> CyclicFit:
    """Identify a yield stress, its rise and back stresses.

    Args:
        tests: tension-compression or torsion; one or more has plastic flow in both directions.
        G, nu: elastic constants, measured before; N/mm².
        terms: number of back stresses, 1 to 4.
        temperature: of the tests, K.

    Raises:
        InputError: if the tests cannot determine back stresses, or their number is not possible.
        SolveError: if the tests cannot distinguish the constants.
    """
    tests = tuple(tests)
    if not 1 <= terms <= MOST_TERMS:
        raise InputError(f"{terms} is not possible; give 1 to {MOST_TERMS}", "--back-stresses")
    for test in tests:
        if test.kind not in AXIS:
            problem = "is a test of both tension and torsion; back stresses are fitted to tests in one direction"
            raise test.error(problem)
        check_elastic(test, float(G), float(nu))
    paths = [_path(test, G, nu) for test in tests]
    _refuse_one_way(paths)
    found, enough, best = None, 1, math.inf
    for number in range(1, terms + 1):
        found = _closest(paths, number, found)
        criterion = _criterion(found)
        if criterion < best:
            best, enough = criterion, number
    assert found is not None
    return _result(tests, paths, terms, found, enough, (float(G), float(nu), float(temperature)))


def _path(test: Test, G: float, nu: float) -> _Path:
    column = AXIS[test.kind]
    strain, stress = test.strain[:, column], test.stress[:, column]
    if column:
        return _Path(3.0 * G, strain / math.sqrt(3.0), stress * math.sqrt(3.0), 1.0 / math.sqrt(3.0))
    return _Path(2.0 * G * (1.0 + nu), strain, stress, 1.0)


def _refuse_one_way(paths: Sequence[_Path]) -> None:
    """Reject tests without plastic flow in both directions."""
    for path in paths:
        plastic = np.append(0.0, path.strain - path.stress / path.modulus)
        down, up = (np.maximum.accumulate(sign * plastic) - sign * plastic for sign in (1.0, -1.0))
        if min(down.max(), up.max()) > BOTH_WAYS:
            return
    raise InputError(
        "no test flows in both directions; without a reversal back stresses cannot be separated from the size "
        "of the yield surface"
    )


def _unpacked(x: np.ndarray, terms: int) -> tuple[np.ndarray, np.ndarray]:
    """σ₀, Q, m and the back stresses of logarithms σ₀, (Cᵢ/γᵢ, γᵢ), and if they are there Q, m."""
    values = np.exp(x)
    size = np.array([values[0], 0.0, 1.0])
    if len(x) > 1 + 2 * terms:
        size[1:] = values[1 + 2 * terms :]
    return size, values[1 : 1 + 2 * terms].reshape(terms, 2)


def _residual(x: np.ndarray, paths: Sequence[_Path], terms: int) -> np.ndarray:
    """Difference of stress over the maximum of each test."""
    parts = []
    for path in paths:
        stress = np.empty_like(path.stress)
        follow(path.modulus, *_unpacked(x, terms), path.strain, stress)
        parts.append((stress - path.stress) / np.abs(path.stress).max())
    return np.concatenate(parts)


def _criterion(found: OptimizeResult) -> float:
    """Schwarz's: n ln(mean square) + ln(n) for each constant."""
    n = found.fun.size
    return float(n * math.log(2.0 * found.cost / n) + found.x.size * math.log(n))


def _closest(paths: Sequence[_Path], terms: int, fewer: OptimizeResult | None) -> OptimizeResult:
    """The best fit of so many back stresses, from that of one fewer, with or without a rise of the yield stress."""
    top = max(np.abs(path.stress).max() for path in paths)
    reach = max(np.abs(path.strain - path.stress / path.modulus).max() for path in paths)
    starts = []
    for rate in STARTS_RATE:
        new = [math.log(0.2 * top), math.log(rate / reach)]
        if fewer is None:
            starts += [[math.log(part * top), *new] for part in STARTS_YIELD]
        else:
            known = fewer.x[: 1 + 2 * (terms - 1)]
            starts.append([known[0] - 0.2, *known[1:], *new])
    plain = _lowest(paths, terms, starts)
    rising = _lowest(paths, terms, [[*plain.x, math.log(0.1 * top), math.log(rate / reach)] for rate in (0.2, 2.0)])
    seen = math.exp(rising.x[-2]) > LEAST_RISE * top
    return rising if seen and _criterion(rising) < _criterion(plain) else plain


def _lowest(paths: Sequence[_Path], terms: int, starts: Iterable[Sequence[float]]) -> OptimizeResult:
    """The lowest minimum from the starts."""
    found = []
    for start in starts:
        x = np.array(start)
        found.append(
            least_squares(
                _residual, x, bounds=(x - BOUND, x + BOUND), xtol=1e-9, ftol=1e-10, max_nfev=100, args=(paths, terms)
            )
        )
    return min(found, key=lambda one: one.cost)


def _constants(x: np.ndarray, terms: int) -> dict[str, float]:
    """By their names; back stresses in the order of falling γ."""
    size, back = _unpacked(x, terms)
    named = {"yield_stress": size[0]}
    if len(x) > 1 + 2 * terms:
        named |= {"rise": size[1], "rate": size[2]}
    for i, (top, γ) in enumerate(back[np.argsort(-back[:, 1], kind="stable")], 1):
        named |= {f"C_{i}": top * γ, f"gamma_{i}": γ}
    return {name: float(value) for name, value in named.items()}


def _result(
    tests: tuple[Test, ...],
    paths: Sequence[_Path],
    terms: int,
    found: OptimizeResult,
    enough: int,
    known: tuple[float, float, float],
) -> CyclicFit:
    """Constants with their uncertainties, and the law along the tests."""
    constants = _constants(found.x, terms)
    deviations = spread(lambda x: _constants(x, terms), found.x, robust_covariance(found))
    standard = dict(zip(constants, deviations.tolist(), strict=True))
    uncertainty = {name: coverage(found.x.size) * one for name, one in standard.items()}
    stresses, scatter, length, work = [], [], 0.0, 0.0
    size, back = _unpacked(found.x, terms)
    for test, path in zip(tests, paths, strict=True):
        ours, stress = np.empty_like(path.stress), np.zeros_like(test.stress)
        p = follow(path.modulus, size, back, path.strain, ours)
        stress[:, AXIS[test.kind]] = ours * path.to_test
        stresses.append(stress)
        scatter.append(float(np.sqrt(np.mean((stress - test.stress)[:, AXIS[test.kind]] ** 2))))
        length = max(length, float(p))
        work = max(work, float(size[0] * p + size[1] * (p + np.expm1(-size[2] * p) / size[2])))
    return CyclicFit(
        *known, constants, standard, uncertainty, tests, tuple(stresses), tuple(scatter), work, enough, length
    )
