"""`coilset compare`: a measured spring beside the run of its case."""

from math import isnan
from pathlib import Path

from rich.table import Table

from coilset.model.core.results.files.folder import make
from coilset.model.tools.figures.png import save
from coilset.scripts.terminal.console import Console
from coilset.scripts.terminal.target import results_folder
from coilset.verification.comparison import compare as run_and_compare
from coilset.verification.comparison import figure


def compare(folder: str, out: str | None, force: bool) -> None:
    """Run the case of a folder, print measured and computed numbers, and draw their ratios.

    Raises:
        InputError, SolveError: as `coilset.verification.comparison.compare`.
    """
    name = Path(folder).resolve().name
    target = results_folder(out, name, "compare")
    found = run_and_compare(folder, target, force)
    rows = found.rows
    table = Table("quantity", "measured", "±", "computed", "±", "ratio", "", box=None, padding=(0, 1))
    for row in rows:
        error = "–" if isnan(row.computed_error) else f"{row.shown(row.computed_error):.2g}"
        ratio = "–" if isnan(row.ratio) else f"{row.ratio:.4f}"
        numbers = (f"{row.measured:.5g}", f"{row.error:.3g}", f"{row.shown(row.computed):.5g}", error, ratio)
        table.add_row(row.quantity, *numbers, "met" if row.met else "not met")
    console = Console()
    console.print(table)
    console.print(f"{sum(row.met for row in rows)} of {len(rows)} numbers met: they differ by no more than both errors")
    make(target)
    save(figure(found, name), target / "comparison.png")
    console.say(f"results and comparison.png in {target}")
