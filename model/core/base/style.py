"""The look of all figures: the parameters of matplotlib in coilset.mplstyle, and round scales."""

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator

FILE = Path(__file__).parent / "coilset.mplstyle"
STYLE = mpl.rc_params_from_file(str(FILE), use_default_template=False)
DIVERGING = "RdBu_r"
"""Map of values with a sign, red where positive."""
SEQUENTIAL = "viridis"
"""Map of values without a sign."""
ROUND = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # ends of a scale
QUARTERED = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0)  # ends of a scale whose quarters have few digits


def round_end(greatest: float, ends: Sequence[float] = ROUND) -> float:
    """The smallest round number that is not below a value, for the end of a scale from zero; 1 for 0."""
    if not greatest > 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(greatest))
    return next((end * power for end in ends if end * power >= greatest * (1.0 - 1e-9)), 10.0 * power)


def as_written(figure: Figure) -> None:
    """Texts of a figure, which may have names of the user's, are no formulas: a `$` in them is a letter.

    Those of matplotlib's own, as powers of ten along an axis, stay formulas.
    """
    for text in figure.findobj(Text):
        if "$" in text.get_text() and not text.get_text().startswith("$\\mathdefault"):
            text.set_parse_math(False)


def levels(low: float, high: float) -> np.ndarray:
    """Round numbers for the contours of values; about zero, as `-high` to `high`, symmetric."""
    steps = [1, 2, 2.5, 5, 10]
    return MaxNLocator(20, steps=steps, symmetric=low == -high).tick_values(low, max(high, low + 1e-9))


def colour_bar(title: str, letters: tuple[int, int], across: tuple[float, float], up: tuple[float, float]) -> dict:
    """A scale of colours in a view of pyvista; an empty line separates its title from the numbers.

    Args:
        title: of the scale.
        letters: sizes of the title and of the numbers.
        across, up: where it begins, and how long and how high it is, over the picture's width and height.
    """
    looks = {"color": "black", "n_labels": 5, "fmt": "%.5g"}
    sizes = {"title_font_size": letters[0], "label_font_size": letters[1]}
    place = {"position_x": across[0], "width": across[1], "position_y": up[0], "height": up[1]}
    return {"title": f"{title}\n", **looks, **sizes, **place}
