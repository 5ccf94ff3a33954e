"""Figures shared by several cases."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

Column = tuple[str, str, Sequence[int | None], Sequence[int | None]]  # method, colour, ours, the table's


def iterations(axes: Axes, labels: Sequence[str], columns: Sequence[Column], title: str) -> None:
    """Iterations of each row of a table, ours beside the table's; a row that diverged has a cross at the top.

    Args:
        axes: matplotlib Axes.
        labels: the rows' names.
        columns: (method, colour, our numbers, the table's numbers); None for a divergence.
        title: of the axes.
    """
    place = np.arange(len(labels))
    known = [n for _, _, ours, theirs in columns for n in [*ours, *theirs] if n is not None]
    top = 1.08 * max(known) + 0.5
    for k, (method, colour, ours, theirs) in enumerate(columns):
        shift = 0.16 * (k - 0.5 * (len(columns) - 1))
        for numbers, filled, name in ((theirs, "none", "thesis"), (ours, colour, "coilset")):
            values = np.array([np.nan if n is None else n for n in numbers], dtype=float)
            axes.plot(
                place + shift,
                values,
                "o",
                ms=7 if filled == "none" else 4,
                mfc=filled,
                mec=colour,
                label=f"{method}, {name}",
            )
            lost = np.isnan(values)
            if lost.any():
                axes.plot(
                    (place + shift)[lost],
                    np.full(lost.sum(), top),
                    "x",
                    color=colour,
                    ms=6,
                    label=f"{method}, {name}: diverged",
                )
    axes.set_xticks(place, labels, rotation=90)
    axes.set(ylabel="iterations, one step per row", title=title, ylim=(-0.05 * top, 1.06 * top))
    axes.grid(lw=0.3)
    axes.legend(fontsize=7)
