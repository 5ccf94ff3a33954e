"""Collect the numbers of a checkout, to be compared with those of another one by compare.py.

    scripts/coilset python tests/numbers/collect.py OUT [--only NAME ...] [--ranks R ...] [--missing]

The checkout is the one whose scripts/coilset runs this; the script itself may lie in another one. Each run gets a
folder OUT/NAME (OUT/NAME@R on R > 1 ranks), and a line in OUT/STATUS.txt with its seconds, for orientation only.
"""

import argparse
import fnmatch
import shutil
import sys
import time
from pathlib import Path

from read import UNFINISHED
from runs import TREE, all_runs


def main() -> int:
    """Run what is asked for; returns 1 if a run failed, else 0."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="folder of the numbers; runs that are there are replaced")
    parser.add_argument(
        "--only", nargs="+", default=["*"], metavar="NAME", help="runs, such as spring/cone or 'verify/*'"
    )
    parser.add_argument("--ranks", nargs="+", type=int, default=[1], metavar="R", help="numbers of MPI ranks")
    parser.add_argument("--missing", action="store_true", help="leave out what is there already")
    parser.add_argument("--list", action="store_true", help="print the names of the runs")
    options = parser.parse_args()
    runs = {name: run for name, run in all_runs().items() if any(fnmatch.fnmatch(name, one) for one in options.only)}
    if not runs:
        parser.error(f"no run is called {' or '.join(options.only)}; --list shows them")
    if options.list:
        print("\n".join(runs))
        return 0
    options.out.mkdir(parents=True, exist_ok=True)
    note(options.out, f"{time.strftime('%H:%M')}  from {TREE}")
    failed = False
    for ranks in options.ranks:
        for name, run in runs.items():
            label = name if ranks == 1 else f"{name}@{ranks}"
            if options.missing and (options.out / label).exists():
                continue
            failed |= not collect(run, ranks, options.out, label)
    note(options.out, f"{time.strftime('%H:%M')}  {'some failed' if failed else 'all done'}")
    return int(failed)


def collect(run, ranks: int, out: Path, label: str) -> bool:
    """One run into its folder, which appears when the run has ended well; False if it failed."""
    partial, began = out / UNFINISHED, time.perf_counter()
    shutil.rmtree(partial, ignore_errors=True)
    shutil.rmtree(out / label, ignore_errors=True)
    partial.mkdir()
    try:
        run(partial, ranks)
    except RuntimeError as error:
        note(out, f"{time.strftime('%H:%M')}  {label}  FAILED  {error}")
        return False
    (out / label).parent.mkdir(exist_ok=True)
    partial.rename(out / label)
    note(out, f"{time.strftime('%H:%M')}  {label}  {time.perf_counter() - began:.1f} s")
    return True


def note(out: Path, line: str) -> None:
    """A line to the screen and to STATUS.txt."""
    print(line, flush=True)
    with open(out / "STATUS.txt", "a", encoding="utf-8") as file:
        file.write(line + "\n")


if __name__ == "__main__":
    sys.exit(main())
