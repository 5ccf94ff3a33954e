"""Random springs, run in this checkout and in another: what became of them, and what that cost.

Each checkout has one process that runs spring after spring, in turns with the other's, so that both see the same load
of the machine; times are of the processor. A short run, not counted, loads or compiles what the first spring of each
material and kind of section needs: the laws that are put together from parts take a minute each to compile.
"""

import json
import subprocess
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.runtime.processes import end_with_parent
from coilset.verification.random_springs import press_one
from coilset.verification.random_springs.springs import family, features, random_spring

LIMIT = 60.0  # seconds of the processor that a spring may take
COMPILING = 900.0  # seconds of the processor that a short run may take
WARM = {
    "spring": {"wire_diameter": 2.0, "mean_diameter": 20.0, "turns": 2.5, "pitch": 4.0},
    "contact": {"friction": {"seats": 0.1, "coils": 0.1}},
    "loading": [{"to": "block", "steps": 4}],
}
COSTS = ("seconds", "evaluations", "cuts")
SHARES = {"median": 50.0, "90 %": 90.0, "worst": 100.0}


class Side:
    """The process of a checkout that runs springs.

    Args:
        start: words that start the command of the checkout.
        environment: of the process.
    """

    def __init__(self, start: Sequence[str], environment: Mapping[str, str]) -> None:
        self._process = subprocess.Popen(
            [*start, "python", str(press_one.__file__)],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            preexec_fn=end_with_parent,
        )

    def press(self, case: dict[str, Any], limit: float) -> dict[str, Any]:
        """What became of a case within `limit` seconds of the processor, see `press_one.press`.

        Raises:
            CoilsetError: if the process has ended.
        """
        to, answers = self._process.stdin, self._process.stdout
        assert to is not None
        assert answers is not None
        try:
            to.write(json.dumps([case, limit]) + "\n")
            to.flush()
        except (BrokenPipeError, ValueError):  # ValueError: closed
            raise CoilsetError("the process that runs the springs has ended") from None
        line = answers.readline()
        if not line:
            raise CoilsetError(f"the process that runs the springs ended with {self._process.wait()}")
        return dict(json.loads(line))

    def end(self) -> None:
        """Let the process end."""
        self._process.communicate()


def press_springs(
    starts: Sequence[Sequence[str]],
    numbers: Sequence[int],
    environment: Mapping[str, str],
    report: Callable[[int, list[dict[str, Any]]], object],
    limit: float = LIMIT,
) -> list[dict[str, Any]]:
    """Run the random springs of some numbers.

    Args:
        starts: words that start the command of each checkout.
        numbers: of the springs.
        environment: of the processes.
        report: called with each number and what became of it on each side.
        limit: seconds of the processor for a spring.

    Returns:
        For each spring its `number`, `family`, `friction`, `case`, and `sides`: what became of it in each checkout.

    Raises:
        CoilsetError: if a process of a checkout died.
    """
    sides = [Side(start, environment) for start in starts]
    rows, warm = [], set[str]()
    try:
        for number in numbers:
            case = random_spring(number)
            short = warming(case)
            if (key := json.dumps(short)) not in warm:
                warm.add(key)
                for side in sides:
                    side.press(short, COMPILING)
            found = [side.press(case, limit) for side in sides]
            report(number, found)
            friction = "friction" in features(case)
            rows.append(
                {"number": number, "family": family(number), "friction": friction, "case": case, "sides": found}
            )
    finally:
        for side in sides:
            side.end()
    return rows


def warming(case: dict[str, Any]) -> dict[str, Any]:
    """A short run that loads what a case needs; wires of a standard have the same law."""
    named = isinstance(case["material"], dict)
    section = {"kind": case["mesh"]["section"]["kind"], "radial": 2, "angular": 8}
    return {**WARM, "material": "ck15" if named else case["material"], "mesh": {"section": section}}


def groups(rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Mapping[str, Any]]]:
    """The rows by family, with and without friction, and all of them."""
    found: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        for name in (row["family"], "with friction" if row["friction"] else "without friction", "all"):
            found.setdefault(name, []).append(row)
    last = ("without friction", "with friction", "all")
    return {name: found[name] for name in sorted(found, key=lambda name: (name in last and last.index(name) + 1, name))}


def costs(rows: Sequence[Mapping[str, Any]], side: int) -> dict[str, list[float]]:
    """Median, 90 % and worst of each of `COSTS` over some rows."""
    return {
        cost: [float(np.percentile([row["sides"][side][cost] for row in rows], share)) for share in SHARES.values()]
        for cost in COSTS
    }
