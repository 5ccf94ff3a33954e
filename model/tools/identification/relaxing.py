"""Relaxation at constant strain in closed integrals, as a function of the constants of creep.

A fibre of the stress σ₀ that is held creeps by c while its stress falls to σ₀ − E c. With the rates of `creep`, du/dτ =
φ(σ)^(1/q), c = u^q, where q = p and τ = t for strain hardening, q = 1 and τ = t^p for time hardening,

    τ(x) = ∫ φ(σ₀ (1 − x))^(−1/q) du,   u = (x σ₀/E)^(1/q),   x = 1 − σ/σ₀,

a quadrature for each x, from which x(τ) is interpolated (cubics with the slopes of the integrand, in logarithms). In
torsion each radius relaxes by itself, as tension does with √3 τ and 3 G in the places of σ and E; the loss of torque is
4 ∫ ρ³ x(ρ τ_R) dρ. The power law has one curve for all stresses, shifted by log (σ₀/(E φ(σ₀)))/q.
"""

from collections.abc import Mapping

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from coilset.model.physics.time.creep.forms import FORMS
from coilset.model.physics.time.creep.law import GAS_CONSTANT
from coilset.model.tools.identification.relaxation_tests import Readings

# x at which τ is computed: down to a part in 1e9, and up to all but 1e-6
PLACES = np.concatenate([np.geomspace(1e-9, 0.5, 80), 1.0 - np.geomspace(0.5, 1e-6, 50)[1:]])
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
RADII, RADIAL = np.polynomial.legendre.leggauss(10)
RADII, RADIAL = 0.5 * (RADII + 1.0), 0.5 * RADIAL

Constants = Mapping[str, float]  # strain, stress, exponent, time_exponent, activation_energy, temperature


def loss(form: str, hardening: str, constants: Constants, tests: Readings, modulus: np.ndarray) -> np.ndarray:
    """Loss of load of all readings, per cent.

    Args:
        form, hardening: as in a material file.
        constants: of creep.
        tests: Readings.
        modulus: E of tension tests, 3 G of torsion tests, at their temperatures, shape (readings,), N/mm².
    """
    worth = constants["activation_energy"] / GAS_CONSTANT * (1.0 / tests.temperature - 1.0 / constants["temperature"])
    time = np.log(tests.hours) - worth
    if hardening == "time":
        time = time * constants["time_exponent"]
    if FORMS[form].HOMOGENEOUS:
        return 100.0 * _by_power_law(form, hardening, constants, tests, modulus, time)
    found = np.empty_like(time)
    for stress, stiffness in {*zip(tests.stress.tolist(), modulus.tolist(), strict=True)}:
        here = (tests.stress == stress) & (modulus == stiffness)
        if tests.kind == "tension":
            found[here] = _fibre(form, hardening, constants, stress, stiffness)(time[here])
        else:
            each = [_fibre(form, hardening, constants, np.sqrt(3.0) * stress * r, stiffness)(time[here]) for r in RADII]
            found[here] = 4.0 * (RADIAL * RADII**3) @ np.array(each)
    return 100.0 * found


def _by_power_law(
    form: str, hardening: str, constants: Constants, tests: Readings, modulus: np.ndarray, time: np.ndarray
) -> np.ndarray:
    """x of the load of all readings."""
    q = constants["time_exponent"] if hardening == "strain" else 1.0
    curve = _fibre(form, hardening, {**constants, "strain": 1.0, "stress": 1.0}, 1.0, 1.0)
    radii, weights = (np.ones(1), np.ones(1)) if tests.kind == "tension" else (RADII, 4.0 * RADIAL * RADII**3)
    stress = np.outer(radii, tests.stress) * (1.0 if tests.kind == "tension" else np.sqrt(3.0))
    shift = (np.log(stress / modulus) - _log_rate(form, constants, stress)) / q
    return weights @ curve(time - shift)


class _Fibre:
    """x over log τ of one fibre."""

    def __init__(self, log_time: np.ndarray, log_x: np.ndarray, slope: np.ndarray) -> None:
        self._curve, self._ends = CubicHermiteSpline(log_time, log_x, slope), log_time[[0, -1]]
        self._first = log_x[0], slope[0]

    def __call__(self, log_time: np.ndarray) -> np.ndarray:
        early = self._first[0] + self._first[1] * (log_time - self._ends[0])
        return np.exp(np.where(log_time < self._ends[0], early, self._curve(np.clip(log_time, *self._ends))))


def _fibre(form: str, hardening: str, constants: Constants, stress: float, modulus: float) -> _Fibre:
    q = constants["time_exponent"] if hardening == "strain" else 1.0
    edges = np.concatenate([[0.0], PLACES]) ** (1.0 / q)  # w = x^(1/q)
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    w = middle[:, None] + half[:, None] * NODES
    scale = (stress / modulus) ** (1.0 / q)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # places never reached are left out below
        slowness = np.exp(-_log_rate(form, constants, stress * (1.0 - w**q)) / q)
        time = np.cumsum(half * (slowness @ WEIGHTS)) * scale
        own = np.exp(-_log_rate(form, constants, stress * (1.0 - PLACES)) / q) * scale
        slope = time / (own * PLACES ** (1.0 / q) / q)  # d log x/d log τ
        log_time = np.log(time)
        good = np.isfinite(log_time) & np.isfinite(slope) & (np.diff(log_time, prepend=-np.inf) > 1e-12)
    return _Fibre(log_time[good], np.log(PLACES)[good], slope[good])


def _log_rate(form: str, constants: Constants, stress: np.ndarray) -> np.ndarray:
    """log φ."""
    x = stress / constants["stress"]
    with np.errstate(divide="ignore"):
        return np.log(constants["strain"]) + constants["exponent"] * FORMS[form].logarithm(x)
