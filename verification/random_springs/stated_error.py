"""Random springs with fine references, against which the errors that runs state are held.

The references are in `stated_error.yaml`. This makes those of more springs, and adds them to it:

    scripts/coilset python verification/random_springs/stated_error.py 12 40 77

with 64 elements a turn, 16 × 64 section points, an accuracy of 0.02 % and a bedding as stiff as Young's modulus, four
times the default. Each takes a minute to half an hour, those to block longer than those to a travel: `numbers(60)` are
the springs with the fewest turns among the first of the generator, in which no section warps freely.
"""

import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.case import check
from coilset.model.core.case.material import case_law
from coilset.verification.random_springs.springs import random_spring

DATA = Path(__file__).with_suffix(".yaml")
DRAWN = 240  # springs of the generator among which to choose
PARTS = 0.5, 0.9  # of the travel, at which forces are compared
FINE_MESH, FINE_SECTION, FINE_ACCURACY = {"elements_per_turn": 64}, {"radial": 16, "angular": 64}, 0.0002
FINE_BEDDING = 1.0  # over Young's modulus
# Springs with references made after the factors were chosen; none goes to block.
FRESH = frozenset(
    [11, 18, 26, 31, 37, 52, 64, 65, 73, 78, 89, 110, 141, 177, 191, 193, 200, 206, 208, 218, 227, 230, 233]
)


class Number(NamedTuple):
    """A number of a run with the error that it states; None where it states none."""

    value: float
    error: float | None


def numbers(count: int) -> list[int]:
    """Numbers of the springs that are compared, those with the fewest turns first."""
    drawn = {number: random_spring(number) for number in range(DRAWN)}
    kept = [
        number
        for number, case in drawn.items()
        if case["mesh"]["section"]["kind"] != "warping" and case["material"] != "elastic"
    ]
    return sorted(kept, key=lambda number: (drawn[number]["spring"]["turns"], number))[:count]


def spring(number: int, fine: bool = False) -> dict[str, Any]:
    """The case of a number with phases that end at the parts of its travel; `fine`: as a reference."""
    data = random_spring(number)
    case = check(data)
    geometry = case.spring.build()
    loading: list[dict[str, Any]] = []
    for phase in data["loading"]:
        to = phase["to"]
        if not loading:
            block = geometry.free_length - geometry.block_height
            loading += [{"to": {"travel": part * (block if to == "block" else to["travel"])}} for part in PARTS]
        loading.append(phase)
    data["loading"], data["release"] = loading, "held"  # as the references, which were made between the ends
    if fine:
        data["accuracy"] = FINE_ACCURACY
        data["contact"] = data.get("contact", {}) | {"bedding": FINE_BEDDING * case_law(case, geometry).E}
        data["mesh"] = {**FINE_MESH, "section": data["mesh"]["section"] | FINE_SECTION}
    return data


def run(number: int, fine: bool = False) -> dict[str, Number]:
    """Forces at the parts of the travel and at its end, set and residual shear inside, by their names.

    Raises:
        CoilsetError: no equilibrium was found.
    """
    analysis = Analysis(check(spring(number, fine)), MPI.COMM_SELF, detailed=False, estimates=not fine)
    result = analysis.run()
    last = {step.phase: step for step in result.steps}
    found = {
        f"force at {100 * part:g} %, N": Number(last[phase].force_N, last[phase].estimated_force_error_N)
        for phase, part in enumerate((*PARTS, 1.0))
    }
    summary = summarise(analysis.setup, result)
    for name, key, error in (
        ("set, mm", "set_mm", "estimated_set_error_mm"),
        ("residual shear, MPa", "residual_shear_inside_MPa", "estimated_residual_shear_inside_error_MPa"),
    ):
        if summary[key] is not None:
            found[name] = Number(summary[key], summary[error])
    return found


def references() -> dict[int, dict[str, float]]:
    """The numbers of all references made so far, by the springs' numbers."""
    return yaml.safe_load(DATA.read_text(encoding="utf-8")) or {} if DATA.exists() else {}


def main(asked: list[int]) -> None:
    """Make references and add each to the file."""
    for number in asked:
        began = time.process_time()
        try:
            found = {name: float(one.value) for name, one in run(number, fine=True).items()}
        except CoilsetError as error:
            print(number, error, flush=True)
            continue
        DATA.write_text(yaml.safe_dump(references() | {number: found}, sort_keys=True), encoding="utf-8")
        print(number, found, f"{time.process_time() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main([int(number) for number in sys.argv[1:]])
