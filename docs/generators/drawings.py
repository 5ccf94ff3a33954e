"""Pictures of the pages that no command draws.

scripts/coilset python docs/generators/drawings.py FOLDER NAME ...        # of DRAWINGS
"""

import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import pyvista as pv
from matplotlib.figure import Figure

from coilset.meshes.drawings import view
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import read_case
from coilset.model.tools.figures import display
from coilset.model.tools.figures.png import save
from coilset.verification.spring_references import progressive, representation

SHAPES = (
    "cone",
    "double_cone",
    "barrel",
    "hourglass",
    "funnel",
    "variable_pitch",
    "variable_wire",
    "closed_and_ground",
)
SIDE = 500  # pixels of a spring


def shapes(folder: Path) -> None:
    """Springs of the examples, each with its name."""
    display.ensure()
    with mpl.rc_context(STYLE):
        sheet = Figure(figsize=(9.0, 5.2), layout="constrained")
        for axes, name in zip(sheet.subplots(2, 4).ravel(), SHAPES, strict=True):
            file = folder / f"{name}.png"
            view.picture(read_case(EXAMPLES / "springs" / f"{name}.yaml", []).spring.build(), file)
            axes.imshow(pv.read_texture(str(file)).to_array())
            axes.set_title(name.replace("_", " "))
            axes.set_axis_off()
        save(sheet, folder / "shapes.png")


def demos(folder: Path) -> None:
    """The figure that each demo ends with."""
    for path in sorted((EXAMPLES / "demos").glob("*.py")):
        save(runpy.run_path(str(path))["figure"], folder / f"{path.stem}.png")


DRAWINGS: dict[str, Callable[[Path], None]] = {
    "shapes": shapes,
    "demos": demos,
    "progressive": lambda folder: progressive.figure(
        {name: progressive.solve(name) for name in progressive.CASES}, folder / "progressive.png"
    ),
    "representation": lambda folder: representation.figure(representation.study(), folder / "representation.png"),
}


if __name__ == "__main__":
    for one in sys.argv[2:]:
        DRAWINGS[one](Path(sys.argv[1]))
