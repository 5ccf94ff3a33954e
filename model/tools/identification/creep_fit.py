"""Fit of the constants of creep to relaxation tests, with their uncertainty.

Least squares of the losses over log c₀, N, p, Q (and log σ₀, unless the form is a power), with c₀ at the tests' mean
stress and temperature, so that the constants are nearly independent of each other. All readings count alike. The
covariance is s² (JᵀJ)⁻¹ with s² of the residuals; the interval of each constant holds it with 95 % confidence
(Student's t). Readings of one specimen that err together make the intervals too narrow.

A catalogue prints few points, all after the same time. Then p is given, not fitted, and s is the error with which a
point can be read off, unless the residuals are larger than it allows (χ², 95 %).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.stats import chi2, norm
from scipy.stats import t as student

from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.physics.time.creep.forms import FORMS
from coilset.model.tools.identification.relaxation_tests import Readings
from coilset.model.tools.identification.relaxing import loss
from coilset.model.tools.identification.result import WIDE

CONFIDENCE = 0.95
BOUNDS = {
    "log_strain": (-60.0, 0.0),
    "exponent": (1.0, 50.0),
    "time_exponent": (0.05, 1.0),
    "activation_energy": (0.0, 1e6),
    "log_stress": (0.0, 10.0),
}
AT_BOUND = 1e-4  # of the way between its bounds: a variable that the search has driven against one
STEPS = {"log_strain": 1e-5, "exponent": 1e-4, "time_exponent": 1e-5, "activation_energy": 10.0, "log_stress": 1e-5}
LOGARITHMIC = "strain", "stress"
STARTS = ((5.0, 0.2, 8e4), (8.0, 0.5, 1.5e5))  # N, p, Q
UNITS = {"strain": "", "stress": "N/mm²", "exponent": "", "time_exponent": "", "activation_energy": "J/mol"}


@dataclass(frozen=True)
class CreepFit:
    """The result of `fit_creep`.

    Attributes:
        law: the material whose elastic constants were used.
        form, hardening: as in a material file.
        constants: all entries of creep that are numbers.
        interval: lowest and highest value of each fitted constant, 95 % confidence each.
        tests: as given; loss: of the law at their readings, per cent.
        scatter: standard deviation of the residuals, per cent; NaN of as many readings as constants.
        beyond: whether the residuals are larger than the readings' error allows.
    """

    law: Law
    form: str
    hardening: str
    constants: dict[str, float]
    interval: dict[str, tuple[float, float]]
    tests: tuple[Readings, ...]
    loss: tuple[np.ndarray, ...]
    scatter: float
    beyond: bool
    _fitted: tuple["_Problem", np.ndarray, np.ndarray]  # its variables, and the squared half-widths of their intervals

    def uncertainty(self, tests: Readings) -> np.ndarray:
        """Half-width of the 95 % interval of the law's loss at some readings, per cent."""
        problem, x, squares = self._fitted
        slopes = replace(problem, tests=(tests,), moduli=(modulus(self.law, tests),)).slopes(x)
        return np.sqrt(np.einsum("ij,jk,ik->i", slopes, squares, slopes))

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Constants whose interval is wider than their value, or that the bounds of the search have stopped."""
        problem, x, _ = self._fitted
        low, high = np.array([BOUNDS[name] for name in problem.names]).T
        stopped = np.minimum(x - low, high - x) < AT_BOUND * (high - low)
        return tuple(
            name
            for (name, (least, most)), at_bound in zip(self.interval.items(), stopped, strict=True)
            if at_bound or not most - least <= WIDE * abs(self.constants[name])
        )

    @property
    def range(self) -> dict[str, list[float]]:
        """Least and greatest temperature, equivalent stress and time of the tests, as in a material file."""
        return _range(self.tests)

    def material(self, name: str, source: str) -> dict[str, object]:
        """Content of a material file: that of the law, with this creep."""
        creep = {"form": self.form, "hardening": self.hardening, **self.constants, "tests": self.range}
        data = self.law.data.model_dump(mode="json", exclude_none=True)
        data |= {"name": name, "source": f"{self.law.data.source}; creep: {source}", "creep": creep}
        MaterialFile.model_validate(data)
        return data


@dataclass(frozen=True)
class _Problem:
    """What is fitted: the names of the variables, and what they are turned into."""

    form: str
    hardening: str
    tests: tuple[Readings, ...]
    moduli: tuple[np.ndarray, ...]
    stress: float
    temperature: float
    time_exponent: float | None = None  # if it is given

    @property
    def names(self) -> tuple[str, ...]:
        known = {"log_stress"} if FORMS[self.form].HOMOGENEOUS else set()
        known |= {"time_exponent"} if self.time_exponent is not None else set()
        return tuple(name for name in BOUNDS if name not in known)

    def constants(self, x: np.ndarray) -> dict[str, float]:
        """Entries of a material file."""
        values = dict(zip(self.names, x.tolist(), strict=True))
        if self.time_exponent is not None:
            values["time_exponent"] = self.time_exponent
        stress = self.stress if "log_stress" not in values else float(np.exp(values.pop("log_stress")))
        found = {"strain": float(np.exp(values.pop("log_strain"))), "stress": stress, **values}
        if not FORMS[self.form].HOMOGENEOUS:  # log_strain is that at the mean stress
            found["strain"] /= FORMS[self.form].factor(self.stress / stress)[0] ** found["exponent"]
        return found | {"temperature": self.temperature}

    def losses(self, x: np.ndarray) -> list[np.ndarray]:
        constants = self.constants(x)
        pairs = zip(self.tests, self.moduli, strict=True)
        return [loss(self.form, self.hardening, constants, tests, modulus) for tests, modulus in pairs]

    def residual(self, x: np.ndarray) -> np.ndarray:
        found = zip(self.losses(x), self.tests, strict=True)
        return np.concatenate([values - tests.loss for values, tests in found])

    def slopes(self, x: np.ndarray) -> np.ndarray:
        steps = np.array([STEPS[name] for name in self.names])
        low, high = (np.array(ends) for ends in zip(*(BOUNDS[name] for name in self.names), strict=True))
        columns = []
        for step in np.diag(steps):
            up, down = np.minimum(x + step, high), np.maximum(x - step, low)
            columns.append((self.residual(up) - self.residual(down)) / np.abs(up - down).max())
        return np.array(columns).T


def fit_creep(
    law: Law,
    tests: tuple[Readings, ...],
    form: str = "norton_bailey",
    hardening: str = "strain",
    time_exponent: float | None = None,
    error: float | None = None,
) -> CreepFit:
    """Identify the constants of creep.

    Args:
        law: gives E and G over temperature.
        tests: Readings at two stresses and two temperatures at least.
        form, hardening: as in a material file.
        time_exponent: p, of tests that have only one time; left out: fitted.
        error: standard deviation of a reading, per cent of the load; left out: that of the residuals.

    Raises:
        InputError: if the tests cannot determine a constant, or lie outside the material's table.
        SolveError: if no constants are found.
    """
    _check(tests, time_exponent)
    stresses = _stresses(tests)
    temperatures = np.concatenate([one.temperature for one in tests])
    problem = _Problem(
        form,
        hardening,
        tests,
        tuple(modulus(law, one) for one in tests),
        float(f"{np.exp(np.log(stresses).mean()):.3g}"),
        float(np.round(temperatures.mean())),
        time_exponent,
    )
    found = min((_adjusted(problem, start) for start in STARTS), key=lambda one: one.cost)
    freedom = found.fun.size - found.x.size
    if freedom < (0 if error else 1):
        raise InputError(f"{found.fun.size} readings cannot determine {found.x.size} constants; give more", "tests")
    scatter = float(np.sqrt(2.0 * found.cost / freedom)) if freedom else np.nan
    beyond = error is not None and 2.0 * found.cost > error**2 * chi2.isf(1.0 - CONFIDENCE, max(freedom, 1))
    if error is None or (beyond and freedom):
        width = scatter * float(student.isf(0.5 * (1.0 - CONFIDENCE), freedom))
    else:
        width = error * float(norm.isf(0.5 * (1.0 - CONFIDENCE)))
    J = problem.slopes(found.x)
    scale = np.linalg.norm(J, axis=0)
    if not scale.min() > 0.0 or np.linalg.cond(J / scale) > 1e8:
        raise SolveError(
            "these tests cannot distinguish the constants of creep; other stresses, temperatures or times are needed"
        )
    inverse = np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
    squares = inverse * width**2
    return CreepFit(
        law,
        form,
        hardening,
        problem.constants(found.x),
        _intervals(problem, found.x, squares),
        tests,
        tuple(problem.losses(found.x)),
        scatter,
        beyond,
        (problem, found.x, squares),
    )


def _stresses(tests: tuple[Readings, ...]) -> np.ndarray:
    """Equivalent stresses of all readings, N/mm²."""
    return np.concatenate([one.stress * (1.0 if one.kind == "tension" else np.sqrt(3.0)) for one in tests])


def _range(tests: tuple[Readings, ...]) -> dict[str, list[float]]:
    parts = {"stress": _stresses(tests)}
    parts |= {name: np.concatenate([getattr(one, name) for one in tests]) for name in ("temperature", "hours")}
    return {name: [float(f"{end:.6g}") for end in (values.min(), values.max())] for name, values in parts.items()}


def _intervals(problem: _Problem, x: np.ndarray, squares: np.ndarray) -> dict[str, tuple[float, float]]:
    """Of the constants, from the squared half-widths of the variables (with their products), in log c₀ and log σ₀."""

    def values(x: np.ndarray) -> np.ndarray:
        constants = problem.constants(x)
        return np.array([np.log(constants[name]) if name in LOGARITHMIC else constants[name] for name in names])

    names = [name.removeprefix("log_") for name in problem.names]
    steps = np.diag([STEPS[name] for name in problem.names])
    slopes = np.array([(values(x + step) - values(x - step)) / (2.0 * step.max()) for step in steps]).T
    half = np.sqrt(np.einsum("ij,jk,ik->i", slopes, squares, slopes))
    found = {}
    for name, value, width in zip(names, values(x), half, strict=True):
        ends = np.array([value - width, value + width])
        with np.errstate(over="ignore"):  # infinite: the tests say nothing about it
            found[name] = tuple((np.exp(ends) if name in LOGARITHMIC else ends).tolist())
    return found


def _check(tests: tuple[Readings, ...], time_exponent: float | None) -> None:
    for name, what in (("stress", "stresses: N"), ("temperature", "temperatures: Q"), ("hours", "times: p")):
        values = np.concatenate([getattr(one, name) for one in tests])
        if len(np.unique(values)) < 2 and not (name == "hours" and time_exponent):
            hint = "; give p by --time-exponent" if name == "hours" else ""
            raise InputError(f"the tests need two {what} is unknown otherwise; there is only {values[0]:g}{hint}", name)


def modulus(law: Law, tests: Readings) -> np.ndarray:
    """E or 3 G at the temperatures of the tests, shape (readings,), N/mm²."""
    try:
        E, G = law.moduli([law.known(float(T)) for T in tests.temperature])
    except InputError as error:
        hint = "give its elastic constants there, too, in another entry of `temperatures`"
        raise InputError(f"{error.problem}; {hint}", error.place, error.file) from None
    return 3.0 * G if tests.kind == "torsion" else E


def _adjusted(problem: _Problem, start: tuple[float, float, float]) -> OptimizeResult:
    """Least squares from a start, with log c₀ found first by trying."""
    bounds = np.array([BOUNDS[name] for name in problem.names]).T
    known = dict(zip(("exponent", "time_exponent", "activation_energy"), start, strict=True))
    known["log_stress"] = float(np.log(0.5 * problem.stress))
    tries = [
        np.array([{"log_strain": log_strain, **known}[name] for name in problem.names])
        for log_strain in np.arange(-24.0, -1.0, 2.0)
    ]
    first = min(tries, key=lambda x: float(np.sum(problem.residual(x) ** 2)))
    return least_squares(
        problem.residual, first, problem.slopes, bounds=bounds, x_scale="jac", xtol=1e-9, ftol=1e-12, max_nfev=100
    )
