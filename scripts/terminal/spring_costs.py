"""Tables of what random springs cost in one checkout, and in two."""

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from rich.table import Table

from coilset.scripts.terminal.console import table
from coilset.verification.benchmarks.springs import COSTS, SHARES, costs, groups

FORMATS = {"seconds": "{:.2f}", "evaluations": "{:,.0f}", "cuts": "{:,.0f}"}
ENDS = ("complete", "refused", "unsolved", "too slow")


def cost_table(rows: Sequence[Mapping[str, Any]], side: int, title: str) -> Table:
    """How the springs of each family ended, and what they cost."""
    units = {"seconds": "s of the processor", "evaluations": "evaluations", "cuts": "cuts"}
    shares = (f"{cost}, {share}" if share == "median" else share for cost in COSTS for share in SHARES)
    made = table(
        ["springs", *ENDS, *shares], title=f"{title}; {', '.join(units.values())}: {', '.join(SHARES)}", padding=1
    )
    for name, group in groups(rows).items():
        ends = Counter(row["sides"][side]["end"] for row in group)
        spent = costs(group, side)
        numbers = (FORMATS[cost].format(value) for cost in COSTS for value in spent[cost])
        made.add_row(name, *(str(ends[end]) for end in ENDS), *numbers)
    return made


def comparison(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Springs that end in both checkouts: ratios of what they cost here, and how far their results differ."""
    heads = ("springs", "number", "time, median", "least", "greatest", "evaluations, median", "force differs by up to")
    made = table(heads, title="this checkout against the other, springs that end in both", padding=1)
    for name, group in groups(rows).items():
        pairs = [row["sides"] for row in group if all(side["end"] == "complete" for side in row["sides"])]
        if not pairs:
            continue
        times = [here["seconds"] / there["seconds"] for here, there in pairs]
        states = [here["evaluations"] / there["evaluations"] for here, there in pairs]
        force = max(abs(here["force_N"] / there["force_N"] - 1.0) for here, there in pairs)
        numbers = (f"{value:.2f}" for value in (median(times), min(times), max(times), median(states)))
        made.add_row(name, str(len(pairs)), *numbers, f"{100 * force:.2g} %")
    return made
