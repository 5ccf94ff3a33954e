"""Tables of what random springs cost in one checkout, and in two."""

from collections import Counter
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from rich.table import Table

from coilset.verification.benchmarks.springs import COSTS, SHARES, costs, groups

FORMATS = {"seconds": "{:.2f}", "evaluations": "{:,.0f}", "cuts": "{:,.0f}"}
ENDS = ("complete", "refused", "unsolved", "too slow")


def cost_table(rows: Sequence[Mapping[str, Any]], side: int, title: str) -> Table:
    """How the springs of each family ended, and what they cost."""
    units = {"seconds": "s of the processor", "evaluations": "evaluations", "cuts": "cuts"}
    table = _table(
        f"{title}; {', '.join(units.values())}: {', '.join(SHARES)}",
        "springs",
        *ENDS,
        *(f"{cost}, {share}" if share == "median" else share for cost in COSTS for share in SHARES),
    )
    for name, group in groups(rows).items():
        ends = Counter(row["sides"][side]["end"] for row in group)
        spent = costs(group, side)
        numbers = (FORMATS[cost].format(value) for cost in COSTS for value in spent[cost])
        table.add_row(name, *(str(ends[end]) for end in ENDS), *numbers)
    return table


def comparison(rows: Sequence[Mapping[str, Any]]) -> Table:
    """Springs that end in both checkouts: ratios of what they cost here, and how far their results differ."""
    table = _table(
        "this checkout against the other, springs that end in both",
        "springs",
        "number",
        "time, median",
        "least",
        "greatest",
        "evaluations, median",
        "force differs by up to",
    )
    for name, group in groups(rows).items():
        pairs = [row["sides"] for row in group if all(side["end"] == "complete" for side in row["sides"])]
        if not pairs:
            continue
        times = [here["seconds"] / there["seconds"] for here, there in pairs]
        states = [here["evaluations"] / there["evaluations"] for here, there in pairs]
        force = max(abs(here["force_N"] / there["force_N"] - 1.0) for here, there in pairs)
        numbers = (f"{value:.2f}" for value in (median(times), min(times), max(times), median(states)))
        table.add_row(name, str(len(pairs)), *numbers, f"{100 * force:.2g} %")
    return table


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", box=None, padding=(0, 1), header_style="bold")
    for column in columns:
        table.add_column(column, justify="left" if column == columns[0] else "right")
    return table
