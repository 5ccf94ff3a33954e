"""How much each number that controls the iteration matters: each is halved and doubled, and the work counted.

    scripts/coilset python verification/control_sensitivity.py [--springs NAME …] [--steps N] [--fields NAME …] …

These are the entries of `solver.control` and what `CONSTANTS` of model/core/equilibrium/settings.py names.
Each spring goes to block and back to zero force, once per variant. A number with an upper bound of 1 is doubled at most
halfway to 1; for a growth factor, which is at least 1, the excess over 1 is halved and doubled; the travel of the probe
and the numbers of automatic steps are varied like all others. Iterations, evaluated states (updates of the body, those
of line searches included), failed solves and cuts are counted. Each row is written as soon as it is known. `--page
FILE.csv …` prints the table of docs/tuning.md from such files: the minimum and the maximum number of states over all
springs in them, relative to those with the number as it is, and how many more failed solves and cuts all springs had
together.
"""

import argparse
import csv
import importlib
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from types import ModuleType
from typing import TextIO, get_type_hints

from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import SolveError
from coilset.model.core.case import read_case
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.settings import CONSTANTS, Growth, NewtonControl, StepControl
from coilset.verification.counting import listen

CONTROLS: dict[str, type[NewtonControl] | type[StepControl]] = {"newton": NewtonControl, "steps": StepControl}
GROWTHS = {
    name
    for control in CONTROLS.values()
    for name, kind in get_type_hints(control, include_extras=True).items()
    if kind is Growth
} | {"penetration_growth", "regrowth", "tolerated_share"}
SWITCHES = ("predicted_forces",)
AUTOMATIC = (  # of automatic steps only
    "automatic",
    "easy",
    "hard",
    "growth",
    "shrinkage",
    "largest",
    "step_share",
    "least_rest",
    "tolerated_share",
    "finest",
    "caution",
    "least_factor",
)
COLUMNS = ("spring", "variant", "iterations", "evaluations", "failures", "cuts", "steps", "ended")
PETSC_SEARCH = "cp"


@dataclass
class Counts:
    """What a run took.

    Attributes:
        iterations: of all solves, failed ones included.
        evaluations: states that the body was brought to.
        failures: solves without an equilibrium.
        cuts: of steps.
        steps: converged ones.
        ended: did the run finish?
    """

    iterations: int = 0
    evaluations: int = 0
    failures: int = 0
    cuts: int = 0
    steps: int = 0
    ended: bool = False


def example(name: str) -> Path:
    """File of a shipped spring, by its name."""
    return EXAMPLES / (f"{name}.yaml" if name == "ck15_presetting" else f"springs/{name}.yaml")


def numbers() -> dict[str, float | None]:
    """All numbers by their names with their group, those of the entries first."""
    found = {
        f"{group}.{field.name}": getattr(control(), field.name)
        for group, control in CONTROLS.items()
        for field in fields(control)
    }
    return found | {name: getattr(*_constant(name)) for name in CONSTANTS}


def _constant(name: str) -> tuple[ModuleType, str]:
    """The module of a constant, and its name there."""
    module = CONSTANTS[name].removesuffix(".py").replace("/", ".")
    return importlib.import_module(f"coilset.model.core.equilibrium.{module}"), name.partition(".")[2].upper()


@contextmanager
def changed(name: str, value: float) -> Iterator[None]:
    """With a constant of another value; nothing changes for a name of none."""
    if name not in CONSTANTS:
        yield
        return
    module, constant = _constant(name)
    before = getattr(module, constant)
    setattr(module, constant, value)
    try:
        yield
    finally:
        setattr(module, constant, before)


def count(spring: str, settings: Iterable[str], name: str = "", value: float = 0.0) -> Counts:
    """Run a shipped spring with settings as of `--set`, and a constant as of `changed`."""
    with changed(name, value):
        return _count(Analysis(read_case(example(spring), list(settings)), MPI.COMM_SELF))


def _count(analysis: Analysis) -> Counts:
    found = Counts()

    def count_solve(outcome: Outcome) -> None:
        found.iterations += outcome.iterations
        found.failures += not outcome.converged

    def count_update(_: bool) -> None:
        found.evaluations += 1

    listen(analysis.newton, "solve", count_solve)
    listen(analysis.rod, "update", count_update)
    try:
        analysis.run()
        found.ended = True
    except SolveError:
        pass
    found.steps, found.cuts = len(analysis.result.steps), sum(step.cuts for step in analysis.result.steps)
    return found


def halved_and_doubled(name: str, value: float | None) -> tuple[float, float]:
    """The two values at which a field is tried; for a switch, both settings."""
    if name in SWITCHES:
        return False, True
    assert value is not None
    if isinstance(value, int):
        return max(1, int(value) // 2), int(value) * 2
    if name in GROWTHS:
        return 1.0 + 0.5 * (value - 1.0), 1.0 + 2.0 * (value - 1.0)
    return 0.5 * value, 2.0 * value if 2.0 * value < 1.0 else 0.5 * (1.0 + value)


@dataclass(frozen=True)
class Variant:
    """A variant of all springs: its name, settings as of `--set`, and a constant with its value, if it has another."""

    name: str
    settings: tuple[str, ...]
    constant: str = ""
    value: float = 0.0


def variants(names: Iterable[str], steps: str | int) -> Iterator[Variant]:
    """Numbers of automatic steps are tried with those, the others with `steps`; `names`: only these, if any."""
    chosen = set(names)

    def in_steps(kind: str | int) -> tuple[str, ...]:
        return tuple(f"loading.{phase}.steps={kind}" for phase in (0, 1))

    search = f"solver.options.snes_linesearch_type={PETSC_SEARCH}"
    yield Variant("as shipped", in_steps(steps))
    yield Variant(f"{PETSC_SEARCH} of PETSc", (*in_steps(steps), search))
    if not chosen or chosen & set(AUTOMATIC):
        yield Variant("automatic steps", in_steps("auto"))
        yield Variant(f"{PETSC_SEARCH} of PETSc, automatic", (*in_steps("auto"), search))
    for name, as_is in numbers().items():
        _, _, field = name.partition(".")
        if chosen and field not in chosen:
            continue
        kind = in_steps("auto" if field in AUTOMATIC else steps)
        for value in halved_and_doubled(field, as_is):
            entry = () if name in CONSTANTS else (f"solver.control.{name}={value!r}",)
            yield Variant(f"{field} = {value:g}", (*kind, *entry), name, value)


def table(springs: Iterable[str], names: Iterable[str], steps: str | int, given: Sequence[str], out: TextIO) -> None:
    """Write a row for each spring and variant; `given` are settings of all of them."""
    rows = csv.writer(out)
    rows.writerow(COLUMNS)
    for spring in springs:
        for one in variants(names, steps):
            found = count(spring, [*given, *one.settings], one.constant, one.value)
            rows.writerow([spring, one.name, *(getattr(found, column) for column in COLUMNS[2:])])
            out.flush()


Rows = dict[str, dict[str, dict[str, str]]]


def page(files: Iterable[Path]) -> None:
    """Print the table of docs/tuning.md from files that `table` has written."""
    springs: Rows = {}
    for path in files:
        with path.open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                springs.setdefault(row["spring"], {})[row["variant"]] = row
    print(
        "| number | value | halved | doubled | additional failed solves | additional cuts |\n|---|---|---|---|---|---|"
    )
    for number, value in numbers().items():
        _, _, name = number.partition(".")
        tried = [f"{name} = {each:g}" for each in halved_and_doubled(name, value)]
        if not any(tried[0] in rows for rows in springs.values()):
            continue
        cells = [_compared(springs, one) for one in tried]
        worse = (", ".join(str(cell[k]) for cell in cells) for k in (1, 2))
        print(f"| `{name}` | {value} | {cells[0][0]} | {cells[1][0]} | {' | '.join(worse)} |")


def _compared(springs: Rows, variant: str) -> tuple[str, int, int]:
    """States relative to the number as it is, minimum and maximum over the springs; more failures and cuts."""
    base = "automatic steps" if variant.split(" = ")[0] in AUTOMATIC else "as shipped"
    pairs = [(rows[variant], rows[base]) for rows in springs.values() if variant in rows and base in rows]
    if any(row["ended"] != "True" for row, _ in pairs):
        return "some ended early", 0, 0
    shares = [int(row["evaluations"]) / int(as_is["evaluations"]) for row, as_is in pairs]
    more = [sum(int(row[name]) - int(as_is[name]) for row, as_is in pairs) for name in ("failures", "cuts")]
    return f"{min(shares):.2f} … {max(shares):.2f}", more[0], more[1]


def main() -> None:
    """Read the command line and write the table."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--springs", nargs="+", default=["ck15_presetting", "barrel", "funnel", "measured"])
    parser.add_argument("--fields", nargs="+", default=[], help="only these (default: all)")
    parser.add_argument("--steps", default="12", help="equal steps of each phase, or auto")
    parser.add_argument("--set", nargs="+", default=[], dest="settings", help="settings of all runs")
    parser.add_argument("--out", type=Path, help="CSV file (default: the screen)")
    parser.add_argument(
        "--page", nargs="+", type=Path, metavar="FILE", help="print the table of these files; run nothing"
    )
    given = parser.parse_args()
    if given.page:
        page(given.page)
    elif given.out is None:
        table(given.springs, given.fields, given.steps, given.settings, sys.stdout)
    else:
        with given.out.open("w", encoding="utf-8") as out:
            table(given.springs, given.fields, given.steps, given.settings, out)


if __name__ == "__main__":
    main()
