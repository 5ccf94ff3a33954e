"""The PNG files of a run, in parts that can be drawn in parallel; their libraries are loaded when they are needed."""

from collections.abc import Callable
from pathlib import Path

Draw = Callable[[Path], list[str]]
"""Draws into the folder of a run; gives warnings, one line each."""


def load_figures() -> Draw:
    """Load the libraries of the diagrams."""
    from functools import partial

    from coilset.model.core.results.files.opened import Run, open_run
    from coilset.model.tools.figures.panels import buckling, characteristic, fatigue, force_line, seats, section_map
    from coilset.model.tools.figures.panels.panel import Panel
    from coilset.model.tools.figures.png import write_png

    pictures: dict[str, list[Callable[[Run], Panel | None]]] = {
        "characteristic.png": [characteristic.characteristic],
        "cross_section.png": [section_map.shear_map, section_map.normal_map],
        "force_centre.png": [seats.force_centre, seats.eccentricity],
        "force_line.png": [
            force_line.side_view_x,
            force_line.side_view_y,
            force_line.view_along_axis,
            force_line.side_force,
        ],
        "seat_pressure.png": [partial(seats.contact, kinds="seat"), seats.contact_length, seats.active_turns],
        "fatigue.png": [fatigue.fatigue_map],
        "buckling_mode.png": [buckling.buckling_mode, buckling.buckling_axis],
    }

    def draw(folder: Path) -> list[str]:
        run = open_run(folder)
        source = f"{run.summary['material']}; {run.summary['origin']['versions'].split(' (')[0]}"
        for name, functions in pictures.items():
            panels = [panel for function in functions if (panel := function(run)) is not None]
            if panels:
                write_png(folder / name, panels, source)
        return []

    return draw


def load_scene() -> Draw:
    """Load the libraries for springs.png, and start a virtual display if it needs one."""
    from coilset.model.core.results.files.opened import open_run
    from coilset.model.tools.figures import display, scene

    there = display.ensure()

    def draw(folder: Path) -> list[str]:
        if not there:
            return ["springs.png is not drawn: there is no display and no Xvfb"]
        scene.springs(folder / "springs.png", open_run(folder))
        return []

    return draw


def not_drawn(what: str, error: Exception) -> str:
    """The warning that a picture is missing, in one line."""
    reason = str(error).partition("\n")[0] or type(error).__name__
    return f"{what}: {reason}"


PARTS: dict[str, Callable[[], Draw]] = {"figures": load_figures, "scene": load_scene}
"""Names of the parts; each gives a function that draws."""
