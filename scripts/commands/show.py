"""`coilset fields` and `coilset animate`: a run for ParaView, and as a film."""

from pathlib import Path

from coilset.model.results.files.opened import open_run
from coilset.scripts.terminal.console import Console


def fields(folder: str | Path) -> None:
    """Write the time series of a run; see `coilset fields --help`.

    Raises:
        InputError: if there is no run in the folder. CoilsetError: if a file cannot be written.
    """
    from coilset.model.figures.series import write_series

    for path in write_series(open_run(folder)):
        Console().say(f"{path}")


def animate(folder: str | Path) -> None:
    """Write animation.gif of a run; see `coilset animate --help`.

    Raises:
        InputError: if there is no run in the folder. CoilsetError: if it cannot be drawn or written.
    """
    from coilset.model.figures.animation import animate as draw

    path = draw(open_run(folder))
    Console().say(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
