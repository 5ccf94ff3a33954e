"""Programs for one point: targets of strain or stress, one after the other, as in a tension-torsion testing machine.

At any time each component is controlled either by its strain or by its stress. A step names components and their values
at its end, reached in equal increments; components that it does not name remain controlled as before, at their last
value. At the start every stress is prescribed as zero: tension is `eps11` alone.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Unit
from pydantic import Field

from coilset.model.core.base.entry import Strict, Whole, check_entries, shortened
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.base.yaml import read_data
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point.points import initial_state, update

STRAINS = {
    "rod": ("eps11", "gamma12", "gamma13"),
    "solid": ("eps11", "eps22", "eps33", "gamma12", "gamma13", "gamma23"),
}
STRESSES = {
    "rod": ("sigma11", "tau12", "tau13"),
    "solid": ("sigma11", "sigma22", "sigma33", "tau12", "tau13", "tau23"),
}
MAX_ITERATIONS = 50
MAX_HALVINGS = 12
Temperature = Annotated[float, Unit("K"), Field(gt=0)]
Advance = Callable[..., tuple[np.ndarray, np.ndarray, np.ndarray]]


class Step(Strict):
    """One straight segment of a program."""

    name: Annotated[str, Field(description="a label for readers")] = ""
    to: Annotated[
        dict[str, float], Unit("1, N/mm²"), Field(description="strains (1) and stresses (N/mm²) at the end")
    ] = Field({})
    temperature: Annotated[Temperature | None, Field(description="temperature at the end, K")] = None
    increments: Annotated[Whole, Field(ge=1, le=1_000_000, description="the number of equal increments")]


class Program(Strict):
    """A program for one point of material."""

    name: Annotated[str, Field(description="a name for the program")]
    description: Annotated[str, Field(description="its purpose, in a sentence")] = ""
    source: Annotated[str, Field(description="where it comes from")] = ""
    form: Annotated[Literal["rod", "solid"], Field(description="rod: three stresses; solid: all six components")] = (
        "rod"
    )
    temperature: Annotated[
        Temperature | None, Field(description="temperature at the start, K; default: the first in the material file")
    ] = None
    steps: Annotated[tuple[Step, ...], Field(strict=False, min_length=1, description="a list of steps")]


@dataclass(frozen=True)
class History:
    """History of a point; the first row is the start.

    strain: engineering shear strains, shape (rows, 3 or 6); stress, back (N/mm²): the same shape; work: b*, N/mm²;
    temperature: K; step: index of the step that the row belongs to.
    """

    form: str
    strain: np.ndarray
    stress: np.ndarray
    back: np.ndarray
    work: np.ndarray
    temperature: np.ndarray
    step: np.ndarray

    def columns(self) -> Iterator[tuple[str, np.ndarray]]:
        """Names and values of a table's columns."""
        yield "step", self.step
        for names, values in ((STRAINS, self.strain), (STRESSES, self.stress)):
            for i, name in enumerate(names[self.form]):
                yield name, values[:, i]
        for i, name in enumerate(STRESSES[self.form]):
            yield "back" + name[-2:], self.back[:, i]
        yield "plastic_work", self.work
        yield "temperature", self.temperature


def read(path: str | Path) -> Program:
    """Read a program.

    Raises:
        InputError: if the file cannot be read or says something wrong.
    """
    program = check_entries(read_data(path, "a program file holds the entries name: and steps:"), Program, path)
    for i, step in enumerate(program.steps):
        _check_targets(step, program.form, f"steps.{i}.to", str(path))
    return program


def _check_targets(step: Step, form: str, place: str, file: str) -> None:
    strains, stresses = STRAINS[form], STRESSES[form]
    for name in step.to:
        if name not in strains + stresses:
            raise InputError(f"'{shortened(name)}' is none of {', '.join(strains + stresses)} ({form})", place, file)
    for strain, stress in zip(strains, stresses, strict=True):
        if strain in step.to and stress in step.to:
            raise InputError(f"{strain} and {stress} cannot both be prescribed", place, file)


def run(law: Law, program: Program, advance: Advance = update, jump: float = 0.0) -> History:
    """Drive one point through a program.

    Args:
        law: a `Law`.
        program: a `Program`.
        advance: another integrator of the law, with the arguments of `points.update`.
        jump: by how much, relative to the stress, its choice of sub-steps makes the stress jump.

    Returns:
        A `History`.

    Raises:
        InputError: if a temperature lies outside the material's table, or is prescribed for a material that heats
        itself. SolveError: if an increment cannot be solved, for instance because the material cannot carry a stress.
    """
    _check_temperatures(law, program)
    point = _Point(law, program.form, advance, jump, program.temperature)
    rows = [point.row(0)]
    for index, step in enumerate(program.steps):
        start = point.drive(step.to)
        end = start.copy()
        for i, names in enumerate(zip(STRAINS[program.form], STRESSES[program.form], strict=True)):
            end[i] = next((step.to[name] for name in names if name in step.to), end[i])
        hot = point.temperature if step.temperature is None else step.temperature
        targets = np.linspace(start, end, step.increments + 1)
        temperatures = np.linspace(point.temperature, hot, step.increments + 1)
        for k in range(1, step.increments + 1):
            try:
                point.advance(targets[k], temperatures[k])
            except SolveError as error:
                where = f"step {index + 1} of the program ({step.name or 'unnamed'}), increment {k}"
                raise SolveError(f"{where}: {error}") from error
            rows.append(point.row(index))
    return History(program.form, *(np.array(column) for column in zip(*rows, strict=True)))


def _check_temperatures(law: Law, program: Program) -> None:
    named = {"temperature": program.temperature}
    named |= {f"steps.{index}.temperature": step.temperature for index, step in enumerate(program.steps)}
    for place, temperature in named.items():
        if temperature is None:
            continue
        if law.is_adiabatic and place != "temperature":
            raise InputError(f"'{law.name}' has adiabatic heating and finds its own temperature", place)
        try:
            law.known(temperature)
        except InputError as error:
            raise InputError(error.problem, place) from None


class _Point:
    """The point in the testing machine: state, total strain, and which components are controlled by strain."""

    def __init__(self, law: Law, form: str, advance: Advance, jump: float, temperature: float | None) -> None:
        self.law, self.form, self._update, self._jump = law, form, advance, jump
        self.n = len(STRAINS[form])
        self.temperature = law.reference_temperature if temperature is None else temperature
        self.state = initial_state(law, 1, self.n, self.temperature)[0]
        self.strain = np.zeros(self.n)
        self.by_strain = np.zeros(self.n, dtype=bool)
        _, tangent, _ = advance(law, self.state[None], np.zeros((1, self.n)), self._at(self.temperature))
        self.tangent = self._elastic = tangent[0]

    def _at(self, end: float) -> tuple[float, float] | None:
        """The temperature argument of `update`."""
        return None if self.law.is_adiabatic else (self.temperature, end)

    def drive(self, targets: Mapping[str, float]) -> np.ndarray:
        """Set which components are controlled by strain; returns the current values of the controlled quantities."""
        for i, (strain, stress) in enumerate(zip(STRAINS[self.form], STRESSES[self.form], strict=True)):
            if strain in targets or stress in targets:
                self.by_strain[i] = strain in targets
        return np.where(self.by_strain, self.strain, self.state[: self.n])

    def row(self, index: int) -> tuple[Any, ...]:
        n, s = self.n, self.state
        temperature = s[2 * n + 1] if self.law.is_adiabatic else self.temperature
        return self.strain.copy(), s[:n].copy(), s[n : 2 * n].copy(), s[2 * n], temperature, index

    def advance(self, target: np.ndarray, temperature: float, halvings: int = 0) -> None:
        """One increment to `target` and `temperature`; if Newton's method fails, two of half the size."""
        now = np.where(self.by_strain, self.strain, self.state[: self.n])
        self.refused: InputError | None = None
        if self._newton(target, temperature, self.tangent):
            return
        if halvings == MAX_HALVINGS:
            if self._newton(target, temperature, self._elastic):  # back from flow without hardening
                return
            if self.refused is not None:
                raise self.refused
            raise SolveError("no strain was found that gives the prescribed stress; can the material carry it?")
        self.advance(0.5 * (now + target), 0.5 * (self.temperature + temperature), halvings + 1)
        self.advance(target, temperature, halvings + 1)

    def _newton(self, target: np.ndarray, temperature: float, tangent: np.ndarray) -> bool:
        held, free = self.by_strain, ~self.by_strain
        increment = np.where(held, target - self.strain, 0.0)
        stress = self.state[: self.n]
        scale = max(1.0, float(np.abs(stress).max()), float(np.abs(target[free]).max(initial=0.0)))
        last = np.inf
        # The free components follow the given tangent first.
        residual = target[free] - stress[free] - tangent[np.ix_(free, held)] @ increment[held]
        for _ in range(MAX_ITERATIONS):
            if free.any():
                try:
                    increment[free] += np.linalg.solve(tangent[np.ix_(free, free)], residual)
                except np.linalg.LinAlgError:
                    return False
            try:
                new, tangents, _ = self._update(self.law, self.state[None], increment[None], self._at(temperature))
            except SolveError:
                return False
            except InputError as error:  # a trial may be hotter than the increment's end
                self.refused = error
                return False
            tangent = tangents[0]
            residual = target[free] - new[0, : self.n][free]
            off = np.abs(residual).max(initial=0.0)
            if off <= 1e-10 * scale or 0.1 * last < off <= self._jump * scale:
                self.state, self.tangent, self.temperature = new[0], tangent, temperature
                self.strain = self.strain + increment
                return True
            if not np.abs(increment).max() < 1.0:
                return False
            last = off
        return False
