"""Measured springs beside the run of their case: measured over computed, with both errors.

A folder holds `case.yaml` and `measured.csv`, one measured number a row: `quantity`, `value`, `error` (±, in the same
unit), and where it needs them `travel_mm` or `height_mm`, and `phase` (of a `force_N`, phases from 1 on), `turn`,
`angle` and `spot` (of a residual stress such as `stress_+45°_MPa`). Other quantities are numbers of summary.json. A
number is met if measured and computed differ by no more than both errors together.

The rows `tester_offset_mm` and `tester_compliance_mm_per_N` are not compared: they make a reading s of the travel one
of s − s₀ − c F of the spring, and a height h one of h + c F. Forces may be in kgf or lbf, lengths in inches, by the end
of the quantity's or column's name.

A folder with `nest.yaml` in place of the case is that of two springs between the same seats, whose travel counts from
the height at which they touch the longer one. Numbers of one of them begin with its name, as in `outer.set_mm`.
"""

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, ClassVar, Self

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

import coilset.open
from coilset.api import Case, solve
from coilset.model.core.base.columns import Columns, in_our_unit, number, read_columns, scaled
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.style import STYLE
from coilset.model.core.results.records.summary_entries import NUMBERS
from coilset.model.tools.diffraction.diffraction import DIRECTIONS
from coilset.model.tools.nest.file import NAMES, read_nest
from coilset.model.tools.nest.nest import press
from coilset.model.tools.nest.output import write

ROUNDING = 1e-6  # of a measured number or its error, below which a computed one is 0
DRAWN = 121  # points of a phase's characteristic
OFFSET, COMPLIANCE = "tester_offset_mm", "tester_compliance_mm_per_N"
UNITS_OF = {name: "" for name in ("quantity", "value", "error", "phase", "turn", "angle", "spot")} | {
    name: "mm" for name in ("travel_mm", "height_mm")
}
CASE, NEST, MEASURED, COLUMNS = "case.yaml", "nest.yaml", "measured.csv", "quantity, value, error"
FORCE, STRESSES = "force_N", {f"stress_{name}_MPa": name for name in DIRECTIONS}
OF_NEST = ("free_length_before_mm", "free_length_after_mm", "set_mm", "block_height_mm", "force_max_N")
ERRORS = {
    "force_N": "estimated_force_error_N",
    "force_max_N": "estimated_force_error_N",
    "set_mm": "estimated_set_error_mm",
    "free_length_after_mm": "estimated_set_error_mm",
}
"""Entries of the summary with the error that the steps leave in a quantity."""


@dataclass(frozen=True)
class Compared:
    """One measured number beside the computed one, in the same unit; the errors are ±.

    Attributes:
        computed_error: as the run estimates it; NaN where it does not.
        travel: of a force, mm; NaN of anything else.
    """

    quantity: str
    measured: float
    error: float
    computed: float
    computed_error: float
    travel: float = float("nan")

    @property
    def met(self) -> bool:
        """Whether they differ by no more than both errors."""
        known = 0.0 if np.isnan(self.computed_error) else self.computed_error
        return abs(self.measured - self.computed) <= self.error + known

    @property
    def ratio(self) -> float:
        """Measured over computed; NaN where one of them is 0 within its error."""
        known = 0.0 if np.isnan(self.computed_error) else self.computed_error
        if abs(self.measured) <= self.error or abs(self.computed) <= known or not self.shown(self.computed):
            return float("nan")
        return self.measured / self.computed

    def shown(self, value: float) -> float:
        """A computed number, 0 where it is rounding beside what is measured."""
        return 0.0 if abs(value) < ROUNDING * max(abs(self.measured), self.error) else value


@dataclass(frozen=True)
class Comparison:
    """All numbers of a folder beside those of the run.

    Attributes:
        rows: the numbers.
        characteristic: ascending travel (mm), force (N) and its error of each phase, between its steps too, shape
            (3, DRAWN); the error is NaN where the run does not estimate it.
    """

    rows: list[Compared]
    characteristic: list[np.ndarray]


def compare(folder: str | Path, results: str | Path, overwrite: bool = False) -> Comparison:
    """Run the case of a folder and compare it with what was measured.

    Args:
        folder: with case.yaml or nest.yaml, and measured.csv.
        results: folder for the run.
        overwrite: replace results that it holds.

    Raises:
        InputError: if a file is missing or wrong, or a quantity is none that the run has.
        SolveError: if the run finds no equilibrium.
    """
    folder, results = Path(folder), Path(results)
    nested = (folder / NEST).is_file()
    table = _in_our_units(_checked(read_columns(folder / MEASURED).named(UNITS_OF), nested))
    tester = _Tester.of(table)
    run = (_nest if nested else _case)(folder, results, overwrite)
    return Comparison(
        [_compared(table, row, line, run, tester) for line, row in table.rows if row["quantity"] not in tester.ROWS],
        [
            np.array(
                [way, *([read(one, phase) for one in way.tolist()] for read in (run.force_at, run.force_error_at))]
            )
            for phase, way in run.ways
        ],
    )


@dataclass(frozen=True)
class _Tester:
    """Of the tester: zero of its travel, mm, and compliance, mm/N, with their errors."""

    ROWS: ClassVar[tuple[str, str]] = (OFFSET, COMPLIANCE)
    offset: float = 0.0
    offset_error: float = 0.0
    compliance: float = 0.0
    compliance_error: float = 0.0

    @classmethod
    def of(cls, table: Columns) -> Self:
        """By the rows of a table.

        Raises:
            InputError: one that is there twice.
        """
        found: dict[str, list[float]] = {}
        for line, row in table.rows:
            if (name := row["quantity"]) in cls.ROWS:
                if name in found:
                    raise InputError(f"'{name}' is there twice; leave one out", f"line {line}", table.path)
                found[name] = [number(row["value"]), number(row["error"])]
        return cls(*found.get(OFFSET, [0.0, 0.0]), *found.get(COMPLIANCE, [0.0, 0.0]))

    def gives_way(self, force: float) -> float:
        """Its own travel under a force, mm."""
        return self.compliance * force

    def doubt(self, force: float) -> float:
        """Error of the spring's travel by it, mm."""
        return self.offset_error + self.compliance_error * abs(force)


@dataclass(frozen=True)
class _Run:
    """What a comparison reads of a run.

    Attributes:
        summary: its numbers.
        force_at, force_error_at: force at a travel in a phase, from 0 on, and its error; NaN where not estimated.
        ways: each phase, and travels at equal distances over it.
        folder: of its results, where stresses are computed from; None of a nest.
    """

    summary: Mapping[str, Any]
    force_at: Callable[[float, int], float]
    force_error_at: Callable[[float, int], float]
    ways: list[tuple[int, np.ndarray]]
    folder: Path | None = None

    def error(self, quantity: str) -> float:
        """As the run estimates it; NaN where it does not."""
        of, _, name = quantity.rpartition(".")
        found = (self.summary[of] or {} if of else self.summary).get(ERRORS.get(name, ""))
        return abs(float(found)) if isinstance(found, int | float) else float("nan")


def _case(folder: Path, results: Path, overwrite: bool) -> _Run:
    result = solve(Case.read(folder / CASE))
    result.save(results, overwrite)
    travel, of_step, ways = np.append(0.0, result.travel), result.data["phase"].to_numpy(), []
    for phase in np.unique(of_step).tolist():
        rows = np.flatnonzero(of_step == phase)
        ways.append((phase, _drawn(travel[rows[0] : rows[-1] + 2])))
    return _Run(result.summary, result.force_at, result.force_error_at, ways, results)


def _nest(folder: Path, results: Path, overwrite: bool) -> _Run:
    pressed = press(read_nest(folder / NEST))
    found = write(results, pressed, overwrite)
    members = [found[name] for name in NAMES if found[name]]
    for name, whole in (("estimated_force_error_N", sum), ("estimated_set_error_mm", max)):
        errors = [one.get(name) for one in members]
        found[name] = None if None in errors else whole(map(abs, errors))
    travel, first, parts = pressed.plan.free_length - pressed.plan.heights, 0, []
    for last in pressed.plan.ends:
        parts.append((travel[first : last + 1], pressed.force[first : last + 1]))
        first = last

    def force_at(at: float, phase: int) -> float:
        if not 0 <= phase < len(parts) or not parts[phase][0].min() <= at <= parts[phase][0].max():
            problem = f"the nest does not reach a travel of {at:g} mm in phase {phase + 1}"
            raise InputError(problem, "", folder / MEASURED)
        way = np.argsort(parts[phase][0])
        return float(PchipInterpolator(*(part[way] for part in parts[phase]))(at))

    def force_error_at(at: float, phase: int) -> float:
        return run.error(FORCE)

    run = _Run(found, force_at, force_error_at, [(phase, _drawn(way)) for phase, (way, _) in enumerate(parts)])
    return run


def _drawn(travel: np.ndarray) -> np.ndarray:
    return np.linspace(travel.min(), travel.max(), DRAWN)


def _in_our_units(table: Columns) -> Columns:
    """The table with its columns' quantities, values and errors in our units."""
    rows = []
    for line, row in table.rows:
        quantity, factor = in_our_unit(row["quantity"].strip())
        numbers = {name: scaled(row[name], factor) for name in ("value", "error")}
        rows.append((line, row | numbers | {"quantity": quantity}))
    return replace(table, rows=tuple(rows))


def _checked(table: Columns, nested: bool) -> Columns:
    for name in ("quantity", "value", "error"):
        if name not in table.names:
            raise table.lacks(name, COLUMNS)
    values, errors = table.numbers("value"), table.numbers("error")
    if not len(values):
        raise InputError("give one measured number at least", "", table.path)
    if (errors < 0.0).any():
        first = int(np.argmax(errors < 0.0))
        raise InputError(
            f"is {errors[first]:g}; must be 0 or more", f"line {table.rows[first][0]}, column error", table.path
        )
    known = [FORCE, OFFSET, COMPLIANCE, *STRESSES, *NUMBERS]
    if nested:
        known = [FORCE, OFFSET, COMPLIANCE, *OF_NEST, *(f"{name}.{one}" for name in NAMES for one in NUMBERS)]
    for line, row in table.rows:
        quantity, _ = in_our_unit(row["quantity"].strip())
        if quantity not in known:
            within = [one for one in known if one in quantity]  # as the rate in initial_rate_N_per_mm
            near = sorted(within, key=len, reverse=True) or get_close_matches(quantity, known, 1, 0.7)
            right = f"is {near[0]} meant?" if near else f"give a number of summary.json, {', '.join(known[:5])}"
            raise InputError(f"'{quantity}' is none that a run has; {right}", f"line {line}", table.path)
        places = [name for name in ("travel_mm", "height_mm") if not np.isnan(number(row.get(name)))]
        if quantity == FORCE and len(places) != 1:
            problem = f"'{FORCE}' needs one of travel_mm and height_mm as a number"
            raise InputError(problem, f"line {line}", table.path)
        if quantity in STRESSES:
            _given(table, row, line, "turn")
    return table


def _given(table: Columns, row: dict[str, str], line: int, name: str, otherwise: float = float("nan")) -> float:
    """A number of a row, or what holds where it is left out.

    Raises:
        InputError: if it is left out and nothing holds.
    """
    value = number(row.get(name))
    value = otherwise if np.isnan(value) else value
    if np.isnan(value):
        raise InputError(f"'{row['quantity']}' needs it as a number", f"line {line}, column {name}", table.path)
    return value


def _compared(table: Columns, row: dict[str, str], line: int, run: _Run, tester: _Tester) -> Compared:
    name = quantity = row["quantity"]

    def given(column: str, *otherwise: float) -> float:
        return _given(table, row, line, column, *otherwise)

    travel, error, measured_error = float("nan"), run.error(quantity), given("error")
    if quantity == FORCE:
        phase, force = given("phase", 1.0), given("value")
        column = "travel_mm" if np.isnan(number(row.get("height_mm"))) else "height_mm"
        read, start = given(column), float(run.summary["free_length_before_mm"])
        travel = (read - tester.offset if column == "travel_mm" else start - read) - tester.gives_way(force)
        try:
            computed, error = (at(travel, int(phase) - 1) for at in (run.force_at, run.force_error_at))
        except InputError:
            problem = f"{travel:.6g} mm are not reached in phase {phase:g} of the load program, the first being 1"
            raise InputError(problem, f"line {line}, column {column}", table.path) from None
        measured_error += _of_travel(run, travel, int(phase) - 1, tester.doubt(force))
        name = f"{FORCE} at {'a height of ' * (column == 'height_mm')}{read:g} mm, phase {phase:g}"
    elif quantity in STRESSES:
        turn, angle = given("turn"), given("angle", 0.0)
        seen = coilset.open(run.folder).xray(turn, angle, given("spot", 0.0))  # type: ignore[operator]
        name = f"{quantity} at turn {turn:g}, {angle:g}°"
        computed = float(seen["stress"].sel(direction=STRESSES[quantity]))
    else:
        of, _, one = quantity.rpartition(".")
        value = (run.summary[of] or {} if of else run.summary).get(one)
        if value is None:
            raise InputError(f"'{quantity}' is unknown in this run", f"line {line}", table.path)
        computed = float(value)
    return Compared(name, given("value"), measured_error, computed, error, travel)


def _of_travel(run: _Run, travel: float, phase: int, error: float) -> float:
    """Error of a force by one of the travel, mm: by as much as the computed one changes, N."""
    found = [0.0]
    for side in (-error, error) if error else ():
        with contextlib.suppress(InputError):  # beyond the end of the phase
            found.append(abs(run.force_at(travel + side, phase) - run.force_at(travel, phase)))
    return max(found)


def figure(found: Comparison, name: str) -> Figure:
    """Measured over computed of all numbers, with the measured error as a bar and the computed one as a band; where
    forces at travels were measured, these over the computed characteristic, too."""
    rows, forces = found.rows, [row for row in found.rows if not np.isnan(row.travel)]
    with mpl.rc_context(STYLE):
        ratios = 1.2 + 0.34 * len(rows)
        sheet = Figure(figsize=(7.0, ratios + 3.8 * bool(forces)), layout="constrained")
        panels = sheet.subplots(2, 1, height_ratios=[ratios, 3.8]) if forces else [sheet.add_subplot()]
        _draw_ratios(panels[0], rows, name)
        if forces:
            _draw_forces(panels[1], found, forces)
    return sheet


def _draw_ratios(axes: Axes, rows: list[Compared], name: str) -> None:
    for k, row in enumerate(rows):
        if np.isnan(row.ratio):
            verdict = "met" if row.met else "not met"
            words, across = f"0 within its error: no ratio, {verdict}", axes.get_yaxis_transform()
            axes.text(0.01, k, words, transform=across, va="center", backgroundcolor="white")
            continue
        size = abs(row.computed)
        if not np.isnan(row.computed_error):
            axes.barh(k, 2.0 * row.computed_error / size, 0.7, 1.0 - row.computed_error / size, color="0.85")
        axes.errorbar(row.ratio, k, xerr=row.error / size, fmt="o", ms=4, color="C0" if row.met else "C3")
    axes.axvline(1.0, color="k", lw=0.8)
    axes.set_yticks(range(len(rows)), [row.quantity for row in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    met = sum(row.met for row in rows)
    axes.set(xlabel="measured over computed", title=f"{name}: {met} of {len(rows)} numbers met")
    axes.grid(lw=0.3, axis="x")


def _draw_forces(axes: Axes, found: Comparison, forces: list[Compared]) -> None:
    for k, (travel, force, error) in enumerate(found.characteristic):
        label = "computed, with its estimated error" if not k else None
        axes.plot(travel, force, "-", color=f"C{k % 2}", lw=1.2, label=label)
        if not np.isnan(error).all():
            axes.fill_between(travel, force - error, force + error, color=f"C{k % 2}", alpha=0.2, lw=0)
    for met, colour in ((True, "k"), (False, "C3")):
        here = [row for row in forces if row.met is met]
        if here:
            axes.errorbar(
                [row.travel for row in here],
                [row.measured for row in here],
                yerr=[row.error for row in here],
                fmt="o",
                ms=4,
                mfc="none",
                capsize=2,
                color=colour,
                label="measured" if met else "measured, not met",
            )
    axes.set(xlabel="travel in mm", ylabel="force in N")
    axes.legend()
    axes.grid(lw=0.3)
