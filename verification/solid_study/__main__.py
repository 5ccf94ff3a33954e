"""Run the study: `scripts/coilset python -m coilset.verification.solid_study FOLDER [whole]`; it resumes by itself."""

import sys
from pathlib import Path

from mpi4py import MPI
from rich.console import Console

from coilset.model.tools.figures.png import save
from coilset.verification.solid_study import figures, study
from coilset.verification.solid_study.store import Store


def main(folder: str, extent: str = "standard") -> None:
    """Run the standard or the whole study and print its records and its table; figures go to the folder."""
    console = Console(highlight=False, quiet=MPI.COMM_WORLD.rank != 0)
    cases = {"standard": study.STANDARD, "whole": study.WHOLE}[extent]
    found = study.run(Store(folder, MPI.COMM_WORLD, console.print), cases)
    if MPI.COMM_WORLD.rank == 0:
        for name, figure in figures.draw(found).items():
            save(figure, Path(folder) / f"{name}.png")
    for record in study.records(found):
        deviation = record["ours"] / record["reference"] - 1
        console.print(
            f"{record['quantity']}: {record['ours']:.5g}, {record['source']} {record['reference']:.5g}, "
            f"{100 * deviation:+.2f} % of {100 * record['tolerance']:g} %"
        )
    for name, unknowns, quantity, solid, rod, deviation in study.table(found):
        last = "" if deviation is None else f"{100 * deviation:+.2f} %"
        console.print(f"{name:28s}{unknowns:8d}  {quantity:32s}{solid:12.4f}{rod:12.4f}  {last}")


if __name__ == "__main__":
    main(*sys.argv[1:])
