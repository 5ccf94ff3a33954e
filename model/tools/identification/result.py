"""Result of a fit: the constants in the form of a material file, and their uncertainties."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult
from scipy.stats import norm

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material.law import functions as fn
from coilset.model.tools.identification.elastic_part import TESTER
from coilset.model.tools.identification.experiments import COMPONENTS, Test
from coilset.model.tools.identification.fitted_law import LARGE, FittedLaw, Variables, moved_by

CONFIDENCE = 0.95
WIDE = 1.0  # of the value: an interval that is wider leaves a constant undetermined
POOR = 0.03  # of a test's greatest stress: a law with a larger rms residual does not follow it; scatter is 1 % or less
Minimum = tuple[dict[str, float], OptimizeResult]  # variables, and the result of least squares


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
        scatter: rms residual of the readings of each test that are fitted, N/mm².
        work: maximum b* of the tests, N/mm².
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

    @property
    def doubtful(self) -> tuple[str, ...]:
        """Constants that may as well be half as large, or twice: the tests do not determine them."""
        return tuple(c for c, value in self.constants.items() if not 2.0 * self.uncertainty[c] < WIDE * abs(value))

    @property
    def misfits(self) -> tuple[str, ...]:
        """Tests that the law does not follow, in a sentence each."""
        greatest = [float(np.abs(test.stress).max()) for test in self.tests]
        return tuple(
            f"{test.name}: the rms residual of {scatter:.3g} MPa is {100.0 * scatter / stress:.2g} % of the greatest "
            f"stress, {stress:.4g} MPa: the law does not follow this test; are its readings right, and in order?"
            for test, scatter, stress in zip(self.tests, self.scatter, greatest, strict=True)
            if scatter > POOR * stress
        )

    @property
    def tester(self) -> tuple[str, ...]:
        """What of the tester was taken off each test's strain, in a sentence each."""
        given = {
            test.name: ", ".join(f"{name} {value:.3g} {TESTER[name]}".strip() for name, value in test.tester.items())
            for test in self.tests
        }
        return tuple(f"{name}: {properties} taken off the strain." for name, properties in given.items() if properties)

    def material(self, name: str) -> dict[str, Any]:
        """Content of a material file."""
        c = self.constants
        isotropic: dict[str, Any] = {key: c[key] for key in ("k0_squared", "a1", "a2", "a3")}
        if "b1" in c:
            isotropic["saturation"] = {key: c[key] for key in ("b1", "k1_squared", "k_inf_squared", "a4")}
        remark = "As far as the tests went." if "a5" in c else "Tension only; no reversed loading was tested."
        kinematic = {key: c[key] for key in ("a5", "a6", "a7")} if "a5" in c else "none"
        return self.file(name, remark, isotropic, kinematic, {"a": c["a"]} if "a" in c else "none")

    def file(self, name: str, remark: str, isotropic: Any, kinematic: Any, non_normality: Any) -> dict[str, Any]:
        """Content of a material file with these functions."""
        at = {
            "temperature": self.temperature,
            "elasticity": {"G": self.G, "nu": self.nu},
            "isotropic": isotropic,
            "kinematic": kinematic,
            "non_normality": non_normality,
        }
        return {
            "name": name,
            "description": "Constants identified from tests",
            "source": "coilset material fit: " + ", ".join(test.name for test in self.tests),
            "units": "N, mm, K",
            "validity": {
                "plastic_work": float(f"{self.work:.3g}"),
                "remark": " ".join([remark, *self.tester]),
                "undetermined": list(self.doubtful),
            },
            "temperatures": [at],
        }


def result(model: FittedLaw, minima: Sequence[Minimum], tests: tuple[Test, ...], temperature: float) -> Fit:
    """The lowest minimum; other minima compatible with the scatter of the tests increase the uncertainties."""
    best, found = minima[0]
    if not found.cost < LARGE:
        raise SolveError("no constants were found with which the law can follow these tests; are their units right?")
    constants = _constants(model, best)
    value = np.array(list(constants.values()))
    spread = _spread(model, best, found)
    variance = 2 * found.cost / (found.fun.size - len(model.names))
    covers = coverage(len(model.names))
    uncertainty = covers * spread
    for other, local in minima[1:]:
        if 2 * (local.cost - found.cost) < covers**2 * variance:
            away = abs(np.array(list(_constants(model, other).values())) - value)
            uncertainty = np.maximum(uncertainty, away + covers * _spread(model, other, local))
    followed = [model.follow(best, test) for test in tests]
    stress = tuple(stress for stress, _ in followed)
    away = ((s - t.stress)[:, COMPONENTS[t.kind]] for s, t in zip(stress, tests, strict=True))
    scatter = tuple(float(np.sqrt(np.mean(one**2))) for one in away)
    standard, reach = (dict(zip(constants, values.tolist(), strict=True)) for values in (spread, uncertainty))
    work = max(work for _, work in followed)
    return Fit(model.G, model.nu, temperature, constants, standard, reach, tests, stress, scatter, work)


def _constants(model: FittedLaw, values: Variables) -> dict[str, float]:
    """The material file's constants."""
    row = model.row(values)
    names = {"k0_squared": fn.K0, "a1": fn.A1, "a2": fn.A2, "a3": fn.A3}
    if "b1" in model.names:
        names |= {"b1": fn.B1, "k1_squared": fn.K1, "k_inf_squared": fn.KINF, "a4": fn.A4}
    if model.isotropic:
        return {name: float(row[place]) for name, place in names.items()}
    names |= {"a5": fn.A5, "a6": fn.A6, "a7": fn.A7}
    return {name: float(row[place]) for name, place in names.items()} | {"a": float(values["a"])}


def _spread(model: FittedLaw, values: Variables, found: OptimizeResult) -> np.ndarray:
    """Standard deviations of the file's constants."""
    start = {name: values[name] for name in model.names}
    return spread(lambda x: _constants(model, moved_by(start, x)), np.zeros(len(start)), robust_covariance(found))


def spread(constants: Callable[[np.ndarray], dict[str, float]], x: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard deviations of constants as functions of variables with a covariance."""
    here = np.array([*constants(x).values()])
    gradient = (np.array([[*constants(x + step).values()] for step in 1e-6 * np.eye(x.size)]) - here).T / 1e-6
    return np.sqrt(np.einsum("ij,jk,ik->i", gradient, covariance, gradient))


def coverage(constants: int) -> float:
    """Standard deviations within which so many constants lie all together (Bonferroni)."""
    return float(norm.isf(0.5 * (1 - CONFIDENCE) / constants))


def robust_covariance(found: OptimizeResult) -> np.ndarray:
    """Covariance of the variables, also where the scatter differs from test to test.

    Raises:
        SolveError: if the tests do not distinguish them.
    """
    J = found.jac
    weighted = J * found.fun[:, None]
    try:
        inverse = np.linalg.inv(J.T @ J)
    except np.linalg.LinAlgError as error:
        raise SolveError("these tests cannot distinguish the constants; other strain paths are needed") from error
    return inverse @ (weighted.T @ weighted) @ inverse * J.shape[0] / (J.shape[0] - J.shape[1])
