"""The law of a material file: its properties, and the array of its constants for the kernels."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from coilset.model.core.base.entry import Strict
from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law import functions as fn
from coilset.model.core.material.law.checks import check_combinations, check_functions, check_moduli, check_stresses
from coilset.model.core.material.law.file import UNITS, Chaboche, Constants, MaterialFile
from coilset.model.core.material.law.hardening_curves import AnyCurve
from coilset.model.core.material.law.parts import CREEP_ENTRIES, Parts, further_columns

CELSIUS = 273.15  # K at 0 °C


class Law:
    """A material: its data and the parameter array for the compiled kernels.

    Args:
        data: the validated material file.
        spin: whether the rod's law contains the spin terms (5.2.33), see `coilset.model.physics.back_stresses.spin`.
        file: where the data came from, for messages.

    Raises:
        InputError: if the functions violate a condition of the theory.

    Attributes:
        keeps_direction: of a law of one's own, whether it is the same for all directions across the wire; else None.
    """

    keeps_direction: bool | None = None

    def __init__(self, data: MaterialFile, spin: bool = False, file: str | Path = "") -> None:
        self.data, self.spin, self.file = data, spin, str(file)
        self._temperatures = np.array([at.temperature for at in data.temperatures])
        if self.file:  # numbers that somebody wrote, and not those that a search tries
            check_moduli(data, self.refuse)
        self._curves: dict[int, np.ndarray] = {}  # of the temperatures whose k² is given by points
        self._rows = np.array([self._row(i, at) for i, at in enumerate(data.temperatures)])
        check_combinations(data, self.refuse)
        self._terms = np.array(
            [[(2.0 / 3.0 * one.C, one.gamma) for one in at.terms] for at in data.temperatures], dtype=float
        )
        if self.file:
            check_stresses(data, self.functions, self.refuse)
        check_functions(data, self.functions, self.refuse)

    @property
    def name(self) -> str:
        """As the file names it."""
        return self.data.name

    @property
    def temperatures(self) -> tuple[float, ...]:
        """Of the table, K."""
        return tuple(float(t) for t in self._temperatures)

    @property
    def reference_temperature(self) -> float:
        """The first temperature given, K."""
        return float(self._temperatures[0])

    @property
    def temperature_range(self) -> tuple[float, float]:
        """The first and the last temperature given, K."""
        return float(self._temperatures[0]), float(self._temperatures[-1])

    @property
    def G(self) -> float:
        """Shear modulus at the reference temperature, N/mm²."""
        return self.data.temperatures[0].elasticity.G

    @property
    def nu(self) -> float:
        """Poisson's ratio at the reference temperature."""
        return self.data.temperatures[0].elasticity.nu

    @property
    def E(self) -> float:
        """Young's modulus at the reference temperature, N/mm²."""
        return 2 * self.G * (1 + self.nu)

    @property
    def is_adiabatic(self) -> bool:
        """Whether plastic work heats the points."""
        return self.data.heating is not None

    def columns(self, components: int) -> int:
        """Length of the state of a point with 3 or 6 stresses, without what creep adds."""
        return 2 * components + 1 + self.is_adiabatic + further_columns(components, self.n_terms)

    @property
    def n_terms(self) -> int:
        """Number of back stresses that saturate (Chaboche); 0: there is the one of ζ, or none."""
        return len(self.data.temperatures[0].terms)

    @property
    def yield_stress(self) -> float:
        """First uniaxial yield stress sqrt(1.5 k0²) at the reference temperature, N/mm² (3.1.4); inf if elastic."""
        return math.sqrt(1.5 * self._rows[0, fn.K0])

    @property
    def heating(self) -> float:
        """Rise of temperature per plastic work b*, K mm²/N."""
        h = self.data.heating
        return h.dissipated / (h.density * h.specific_heat) if h else 0.0

    def constants(self, temperature: float) -> Iterator[tuple[str, tuple[float, str]]]:
        """Names, values and units of the constants that the file gives at one of its temperatures."""
        at = self.data.temperatures[self.temperatures.index(temperature)]
        for section in (at.elasticity, at.isotropic, getattr(at.isotropic, "saturation", None), at.kinematic):
            yield from _entries(section)
        for i, term in enumerate(at.terms):
            yield from ((f"{name}_{i + 1}", found) for name, found in _entries(term))
        yield from _entries(at.non_normality)

    def parameters(self, temperature: float | None = None) -> np.ndarray:
        """Parameter array of the kernels.

        Args:
            temperature: K; default is the reference temperature.

        Returns:
            1-D array, laid out as in `functions`.

        Raises:
            InputError: if the temperature lies outside the material's table.
        """
        temperature = self.reference_temperature if temperature is None else self.known(temperature)
        head = np.zeros(fn.ROWS_START)
        head[fn.SPIN] = self.spin
        head[fn.TEMPERATURE] = temperature
        head[fn.HEATING] = self.heating
        head[fn.N_ROWS] = len(self._rows)
        head[fn.EXPONENT] = self.data.rate.exponent if self.data.rate else 0.0
        rows, start = self._rows.copy(), fn.ROWS_START + self._rows.size
        for i, points in self._curves.items():
            rows[i, fn.CURVE] = start
            start += len(points)
        return np.concatenate([head, rows.ravel(), *self._curves.values()])

    def point_law(self, temperature: float | None = None) -> np.ndarray | Parts:
        """What the kernels take as the law without time: the parameter array alone, if the return map suffices."""
        parameters = self.parameters(temperature)
        return self.parts(parameters) if self.is_adiabatic or not self.returns_cold else parameters

    @property
    def returns_cold(self) -> bool:
        """Does the return map suffice where plastic work heats nothing and no time passes?"""
        return not (self.n_terms or self.spin or self.data.rate)

    def parts(self, parameters: np.ndarray | None = None) -> Parts:
        """What the point problem takes as the law, without time; `parameters` may be those of another temperature."""
        plastic = self.parameters() if parameters is None else parameters
        return Parts(plastic, self._terms.reshape(len(self._rows), -1, 2), np.zeros(CREEP_ENTRIES))

    def content(self) -> bytes:
        """All constants and how far they are valid, for a digest."""
        terms = self._terms.tobytes() if self.n_terms else b""
        sections = self.data.creep, self.data.rate, self.data.heating
        parts = (part.model_dump_json().encode() for part in sections if part)
        return (
            self.parameters().tobytes()
            + terms
            + b"".join(parts)
            + np.float64(self.data.validity.plastic_work).tobytes()
        )

    def refuse(self, place: str, problem: str) -> NoReturn:
        """Raise InputError about an entry of its file."""
        raise InputError(problem, place, self.file)

    def known(self, temperature: float) -> float:
        """The temperature, K, as a number.

        Raises:
            InputError: if it lies outside the material's table.
        """
        low, high = self.temperature_range
        if not low <= temperature <= high:
            known = f"only for {low:g} K" if low == high else f"for {low:g} to {high:g} K"
            if low <= temperature + CELSIUS <= high:
                known += f"; {temperature:g} °C is {temperature + CELSIUS:g} K"
            self.refuse("temperature", f"{temperature:g} K is outside the table of '{self.name}', known {known}")
        return float(temperature)

    def moduli(self, temperature: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """E and G, N/mm², at temperatures of the table, K; shape as `temperature`."""
        at, table = np.asarray(temperature, float), self._temperatures
        return np.interp(at, table, self._rows[:, fn.YOUNG]), np.interp(at, table, self._rows[:, fn.SHEAR])

    def thermal_strain(self, start: float, end: float) -> float:
        """Thermal strain α ΔT (3.1.2) from one temperature to another, K, with the mean α of both."""
        alphas = np.interp([self.known(start), self.known(end)], self._temperatures, self._rows[:, fn.ALPHA])
        return float(alphas.mean()) * (end - start)

    def functions(self, work: npt.ArrayLike, temperature: float | None = None) -> np.ndarray:
        """k², k²′, ζ, ζ′, κ, κ′ at plastic works b*.

        Args:
            work: b*, N/mm², any shape.
            temperature: K; default is the reference temperature.

        Returns:
            Array with the six functions along its first axis, in N, mm.
        """
        p = self.parameters(temperature)
        p[fn.HEATING] = 0.0  # slopes along b* alone
        work = np.asarray(work, float)
        values = np.empty((6, work.size))
        fn.many(p, work.ravel(), p[fn.TEMPERATURE], values)
        return values.reshape(6, *work.shape)

    def first_yield(self, temperature: float | None = None) -> float:
        """`yield_stress` at a temperature of the table, K; default is the reference temperature."""
        return math.sqrt(1.5 * float(self.functions(0.0, temperature)[0]))

    def _row(self, i: int, at: Constants) -> np.ndarray:
        row = np.zeros(fn.ROW_LENGTH)
        G, nu = at.elasticity.G, at.elasticity.nu
        row[[fn.ROW_T, fn.YOUNG, fn.SHEAR, fn.ALPHA]] = at.temperature, 2 * G * (1 + nu), G, at.elasticity.alpha
        row[[fn.K0, fn.B1]] = np.inf
        if isinstance(at.isotropic, AnyCurve):
            try:
                points = at.isotropic.sampled(2 * G * (1 + nu), G)
            except InputError as error:
                place = f"temperatures.{i}.isotropic"
                named = error.file or error.place
                raise InputError(error.problem, error.place if named else place, error.file or self.file) from None
            row[fn.K0], row[fn.NODES] = points[1][0], len(points[0])
            self._curves[i] = np.concatenate(points)
        elif at.isotropic != "none":
            k = at.isotropic
            row[[fn.K0, fn.A1, fn.A2, fn.A3]] = k.k0_squared, k.a1, k.a2, k.a3
            if k.saturation:
                second = k.saturation
                k1 = k.first_branch(second.b1)
                if abs(k1 - second.k1_squared) > 1e-4 * k1:
                    self.refuse(
                        f"temperatures.{i}.isotropic.saturation.k1_squared",
                        f"{second.k1_squared:g} N²/mm⁴, but the first branch ends at {k1:.6g}; k² must not jump at b1",
                    )
                # The first branch's own end, so that k² is continuous to the last digit.
                row[[fn.B1, fn.K1, fn.KINF, fn.A4]] = second.b1, k1, second.k_inf_squared, second.a4
        if at.kinematic != "none" and not isinstance(at.kinematic, Chaboche):
            row[[fn.A5, fn.A6, fn.A7]] = at.kinematic.a5, at.kinematic.a6, at.kinematic.a7
        if at.non_normality != "none":
            row[fn.KAPPA] = at.non_normality.a / (2 * G)
        return row


def _entries(section: object) -> Iterator[tuple[str, tuple[float, str]]]:
    if isinstance(section, Strict):
        for name, value in section:
            if isinstance(value, float | int):
                yield name, (value, UNITS[name])
