"""Compare the numbers of two checkouts that collect.py has collected.

    scripts/coilset python tests/numbers/compare.py BEFORE AFTER [--limit 1e-10] [--only NAME ...]

One line a run: the maximum difference of its columns, over the largest magnitude of the column (of a number of
verification that ought to vanish: over its tolerance); whole numbers, such as iterations, are compared exactly. Below
it stand what is beyond the limit, counts that differ, texts that differ, and what one side alone has.

Exit code 1: a number is beyond the limit, or a count differs (unless --counts-may-differ), or a run's shape does.
Texts, and what stands on one side only, do not count.
"""

import argparse
import fnmatch
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from read import UNFINISHED, Column, read_run

SHOWN = 12  # lines of one kind below a run


@dataclass
class Found:
    """What differs in one run."""

    greatest: float = 0.0
    where: str = "no difference"
    beyond: list[str] = field(default_factory=list)
    counts: list[str] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    alone: list[str] = field(default_factory=list)


def difference(before: Column, after: Column) -> np.ndarray:
    """|after − before| over the largest magnitude; 0 where both are no numbers, infinite where one is."""
    a, b = (np.asarray(column.values, float) for column in (before, after))
    scale = np.max(np.abs([*a[np.isfinite(a)], *b[np.isfinite(b)]]), initial=max(before.scale, after.scale))
    with np.errstate(invalid="ignore"):
        off = np.where(a == b, 0.0, np.abs(b - a) / (scale or 1.0))
    return np.where(np.isnan(a) & np.isnan(b), 0.0, np.nan_to_num(off, nan=np.inf))


def compare_runs(before: dict[str, Column], after: dict[str, Column], limit: float) -> Found:
    """Compare two runs' columns."""
    found = Found(
        alone=[f"only before: {name}" for name in before.keys() - after.keys()]
        + [f"only after: {name}" for name in after.keys() - before.keys()]
    )
    for name in sorted(before.keys() & after.keys()):
        a, b = before[name], after[name]
        if a.values.shape != b.values.shape:
            found.beyond.append(f"{name}: shape {a.values.shape} → {b.values.shape}")
            found.greatest, found.where = np.inf, name
        elif a.kind == "text" or b.kind == "text":
            if not np.array_equal(a.values.astype(str), b.values.astype(str)):
                found.texts.append(name)
        elif a.kind == b.kind == "count":
            if not np.array_equal(a.values, b.values):
                found.counts.append(f"{name}: {changes(a.values, b.values)}")
        elif a.values.size:
            off = difference(a, b)
            place = np.unravel_index(off.argmax(), off.shape)
            if off[place] > found.greatest:
                found.greatest, found.where = float(off[place]), name
            if off[place] > limit:
                found.beyond.append(
                    f"{name}: {off[place]:.1e} at {tuple(map(int, place))}, "
                    f"{a.values[place]:.15g} → {b.values[place]:.15g}"
                )
    return found


def changes(a: np.ndarray, b: np.ndarray) -> str:
    """The sums, and the first place that differs."""
    place = tuple(int(one) for one in np.argwhere(a != b)[0])
    return f"sum {int(a.sum())} → {int(b.sum())}, first at {place}: {a[place]} → {b[place]}"


def runs(out: Path) -> dict[str, Path]:
    """Name → folder of the runs that were collected."""
    return {
        f"{path.parent.name}/{path.name}": path
        for path in out.glob("*/*")
        if path.is_dir() and path.parent.name != UNFINISHED
    }


def show(name: str, found: Found) -> None:
    """The run's line, and what there is to say besides."""
    print(f"{name:32s} {found.greatest:8.1e}  {found.where}")
    kinds = (("beyond", found.beyond), ("count", found.counts), ("text differs", found.texts), ("", found.alone))
    for word, lines in kinds:
        for line in lines[:SHOWN]:
            print(f"    {word + ': ' if word else ''}{line}")
        if len(lines) > SHOWN:
            print(f"    ... and {len(lines) - SHOWN} more")


def main(arguments: list[str] | None = None) -> int:
    """Compare as the command line says; the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--limit", type=float, default=1e-10, help="greatest difference that is none")
    parser.add_argument("--only", nargs="+", default=["*"], metavar="NAME")
    parser.add_argument("--counts-may-differ", action="store_true", help="list counts that differ, no more")
    options = parser.parse_args(arguments)
    before, after = runs(options.before), runs(options.after)
    both = [
        name for name in sorted(before.keys() & after.keys()) if any(fnmatch.fnmatch(name, one) for one in options.only)
    ]
    if not both:
        parser.error("there is no run that both have")
    off = []
    for name in both:
        found = compare_runs(read_run(before[name]), read_run(after[name]), options.limit)
        show(name, found)
        if found.beyond or (found.counts and not options.counts_may_differ):
            off.append(name)
    for word, names in (("before", before.keys() - after.keys()), ("after", after.keys() - before.keys())):
        if names:
            print(f"only {word}: {', '.join(sorted(names))}")
    print(f"{len(both)} runs, {len(off)} off" + (f": {', '.join(off)}" if off else ""))
    return int(bool(off))


if __name__ == "__main__":
    sys.exit(main())
