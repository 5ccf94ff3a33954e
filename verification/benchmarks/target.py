"""What the measurements say: cost of an element in an iteration, its spread, and the targets."""

from collections.abc import Mapping, Sequence
from typing import Any

from coilset.verification.benchmarks.walk import WALKS

ITERATION = ("law", "contact", "assemble", "factorise", "solve", "other")  # stages of the equilibrium iteration
LARGE = 4_000  # number of elements above which the cost of an element should not depend on it
COMMANDS = {"--help": 0.3, "solve --no-pictures": 1.0, "solve": 2.5}  # seconds by the clock, at most
SECONDS_OF_WALKS = dict(zip(WALKS, (0.06, 0.06, 0.25), strict=True))  # as well
FASTER = {320: 0.9, 2_560: 1.6, 20_000: 1.8}  # how many times as fast two ranks should be, by the number of elements
FLAT = 0.1  # how much the cost of an element may differ above LARGE elements


def seconds(stages: Mapping[str, Sequence[float]], kind: int = 1) -> float:
    """Sum of all stages; kind 0: elapsed time, 1: processor time."""
    return sum(pair[kind] for pair in stages.values())


def per_element(run: dict[str, Any], stage: str | None = None) -> float:
    """Processor time of an element in a Newton iteration, µs; of all stages of the iteration, or of one."""
    spent = sum(run["stages"][name][1] for name in ITERATION) if stage is None else run["stages"][stage][1]
    return 1e6 * spent / (run["elements"] * run["iterations"])


def spread(runs: Sequence[dict[str, Any]], least: int) -> float | None:
    """Highest over lowest cost of an element, minus one, from `least` elements on; None for fewer than two runs."""
    costs = [per_element(run) for run in runs if run["elements"] >= least]
    return max(costs) / min(costs) - 1.0 if len(costs) > 1 else None


def targets(record: dict[str, Any]) -> list[dict[str, Any]]:
    """Rows of the targets: name, value, limit, unit; processor time is that of one core."""
    rows = [
        (
            f"walk of the example, {row['name']}, threads: {row['threads']}",
            row["seconds"][0],
            SECONDS_OF_WALKS[row["name"]],
            "s",
        )
        for row in record["walks"]
    ]
    rows += [
        (f"coilset {row['name']}", row["end"][0], COMMANDS[row["name"]], "s")
        for row in record["commands"]
        if row["name"] in COMMANDS
    ]
    rows += [
        (
            f"time on two ranks over that on one, {row['elements']:,} elements, {row['kind']}",
            row["elapsed"][1] / row["elapsed"][0],
            1.0 / FASTER[row["elements"]],
            "",
        )
        for row in record["one_and_two_ranks"]
        if row["elements"] in FASTER
    ]
    for run in (*record["elements"], *record["unestimated"]):
        if run["elements"] == 100_000:
            words = "" if run["estimated"] else ", error of the step not estimated"
            rows += [
                (f"100,000 elements, one plastic step, one core{words}", seconds(run["stages"]), 25.0, "s"),
                (f"100,000 elements, memory{words}", run["memory_GiB"], 2.0, "GiB"),
            ]
    differs = spread(record["elements"], LARGE)
    if differs is not None:
        rows.append((f"spread of an element's cost from {LARGE:,} elements on", 100.0 * differs, 100.0 * FLAT, "%"))
    rows.append(("1,000 cases on 2 cores", record["cases"]["seconds"][1] * 1000 / 2 / 60, 10.0, "minutes"))
    for run in record["opensees"]:
        if run["opensees"] and run["axis"] == "chords":
            for name, words in (("coilset", ""), ("unestimated", ", error of steps not estimated")):
                threads = run[name]["threads"]
                for kind, cores in (("seconds", "one core"), ("elapsed", f"by the clock with {threads} threads")):
                    ratio = run[name][kind] / run["opensees"][kind]
                    rows.append(
                        (
                            f"time over that of OpenSees, {run['elements']} elements, {cores}{words}",
                            ratio,
                            1.0 / 15.0,
                            "",
                        )
                    )
    return [{"name": name, "value": value, "limit": limit, "unit": unit} for name, value, limit, unit in rows]
