"""How much each number of `solver.control` matters: each is halved and doubled, and the work counted.

    scripts/coilset python verification/control_sensitivity.py [--springs NAME …] [--steps N] [--fields NAME …] …

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
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TextIO, get_type_hints

from mpi4py import MPI

from coilset.model.base.errors import SolveError
from coilset.model.case import read_case
from coilset.model.equilibrium.newton.outcome import Outcome
from coilset.model.equilibrium.settings import Growth, NewtonControl, StepControl
from coilset.model.run.analysis import Analysis
from coilset.model.run.examples import EXAMPLES
from coilset.verification.counting import listen

CONTROLS: dict[str, type[NewtonControl] | type[StepControl]] = {"newton": NewtonControl, "steps": StepControl}
GROWTHS = {
    name
    for control in CONTROLS.values()
    for name, kind in get_type_hints(control, include_extras=True).items()
    if kind is Growth
}
SWITCHES = ("predicted_forces",)
FREE_PENETRATION = 0.02  # wire diameters: the contacts' limit, which stands where no number is given
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


def count(name: str, settings: Iterable[str]) -> Counts:
    """Run a shipped spring with settings as of `--set`."""
    analysis, found = Analysis(read_case(example(name), list(settings)), MPI.COMM_SELF), Counts()

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
    if value is None:
        value = FREE_PENETRATION
    if isinstance(value, int):
        return max(1, int(value) // 2), int(value) * 2
    if name in GROWTHS:
        return 1.0 + 0.5 * (value - 1.0), 1.0 + 2.0 * (value - 1.0)
    return 0.5 * value, 2.0 * value if 2.0 * value < 1.0 else 0.5 * (1.0 + value)


def variants(names: Iterable[str], steps: str | int) -> Iterator[tuple[str, list[str]]]:
    """Name and settings of each variant; fields of automatic steps are tried with those, the others with `steps`."""
    chosen = set(names)

    def in_steps(kind: str | int) -> list[str]:
        return [f"loading.{phase}.steps={kind}" for phase in (0, 1)]

    yield "as shipped", in_steps(steps)
    yield f"{PETSC_SEARCH} of PETSc", [*in_steps(steps), f"solver.options.snes_linesearch_type={PETSC_SEARCH}"]
    if not chosen or chosen & set(AUTOMATIC):
        yield "automatic steps", in_steps("auto")
        yield (
            f"{PETSC_SEARCH} of PETSc, automatic",
            [*in_steps("auto"), f"solver.options.snes_linesearch_type={PETSC_SEARCH}"],
        )
    for group, control in CONTROLS.items():
        for field in fields(control):
            if chosen and field.name not in chosen:
                continue
            kind = "auto" if group == "steps" and field.name in AUTOMATIC else steps
            for value in halved_and_doubled(field.name, getattr(control(), field.name)):
                yield f"{field.name} = {value:g}", [*in_steps(kind), f"solver.control.{group}.{field.name}={value!r}"]


def table(springs: Iterable[str], names: Iterable[str], steps: str | int, given: Sequence[str], out: TextIO) -> None:
    """Write a row for each spring and variant; `given` are settings of all of them."""
    rows = csv.writer(out)
    rows.writerow(COLUMNS)
    for spring in springs:
        for variant, settings in variants(names, steps):
            found = count(spring, [*given, *settings])
            rows.writerow([spring, variant, *(getattr(found, column) for column in COLUMNS[2:])])
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
    for control in CONTROLS.values():
        for field in fields(control):
            low, high = halved_and_doubled(field.name, value := getattr(control(), field.name))
            names = [f"{field.name} = {tried:g}" for tried in (low, high)]
            if not any(names[0] in rows for rows in springs.values()):
                continue  # not tried
            cells = [_compared(springs, name) for name in names]
            shown = FREE_PENETRATION if value is None and field.name not in SWITCHES else value
            worse = (", ".join(str(cell[k]) for cell in cells) for k in (1, 2))
            print(f"| `{field.name}` | {shown} | {cells[0][0]} | {cells[1][0]} | {' | '.join(worse)} |")


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
