"""Stress and plastic work on the deformed section: files for ParaView, and pyvista's pictures of them.

    scripts/coilset python -m coilset.verification.solid_study.pictures FOLDER

The same pictures by ParaView: `paraview_view.py` beside this file, run by its pvpython.
"""

import sys
from collections.abc import Callable
from pathlib import Path

from mpi4py import MPI

from coilset.model.physics.solid import output
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.tools.figures import display
from coilset.verification.solid_study.pressing import PressedSection, run_solid

CASE = PressedSection()
FIELDS = {"von Mises stress": "MPa", "plastic work": "N/mm²"}


def main(folder: str | Path) -> None:
    """Press and release the section; write full_travel.vtu, released.vtu and a picture of each field."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    bodies = {}

    def keep(name: str) -> Callable[[SolidProblem], None]:
        def write(problem: SolidProblem) -> None:
            output.write_fields(folder / f"{name.replace(' ', '_')}.vtu", problem.solid)
            bodies[name] = output.grid(problem.solid)

        return write

    comm = MPI.COMM_WORLD
    say = print if comm.rank == 0 else lambda line: None
    run_solid(CASE, comm, report=say, on_full=keep("full travel"), on_end=keep("released"))
    if comm.rank == 0 and display.ensure():
        for field, unit in FIELDS.items():
            output.picture(folder / f"{field.replace(' ', '_')}.png", bodies, field, unit)


if __name__ == "__main__":
    main(*sys.argv[1:])
