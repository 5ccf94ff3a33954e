"""A figure: its finding, its data, and its description for screen readers; pages and PNG files render it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

Trace = dict[str, Any]

# Okabe and Ito's colours, distinguishable with colour-vision deficiencies; used on light and dark backgrounds.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
GREY = "#808080"
DIVERGING = "RdBu"


@dataclass(frozen=True)
class Panel:
    """One figure.

    Attributes:
        name: of the figure, for links.
        title: the finding, in a sentence.
        description: the same for screen readers: what is drawn, and its range.
        traces: of plotly. A trace that belongs to a choice has the choice's number in `meta.choice`.
        layout: of plotly.
        choices: alternatives to choose from, such as snapshots; the last is shown first.
        choice: what is being chosen, for the label.
        frames: what the first trace shows at each moment of the load program, for a slider; the last is shown first.
        moments: the labels of these moments.
        height: pixels.
        note: a remark under the figure.
    """

    name: str
    title: str
    description: str
    traces: list[Trace]
    layout: dict[str, Any] = field(default_factory=dict)
    choices: tuple[str, ...] = ()
    choice: str = "state"
    frames: Sequence[Trace] = ()
    moments: Sequence[str] = ()
    height: int = 380
    note: str = ""


def axis(title: str, **more: Any) -> dict[str, Any]:
    """An axis with its quantity and unit."""
    return {"title": {"text": title}, **more}


def curve(
    x: Any, y: Any, colour: int | str, marker: float = 0, dash: str | None = None, width: float = 2.0, **more: Any
) -> Trace:
    """A line, with markers of so many pixels, if any.

    Args:
        x, y: numbers, arrays or lists.
        colour: its number in COLOURS, or its name.
        marker: size, pixels.
        dash: plotly's name of a line.
        width: of the line, pixels.
        more: other entries of the trace.
    """
    colour = COLOURS[colour % len(COLOURS)] if isinstance(colour, int) else colour
    line = {"width": width, "color": colour} | ({"dash": dash} if dash else {})
    marks = {"mode": "lines+markers", "marker": {"size": marker}} if marker else {"mode": "lines"}
    return {"type": "scatter", **marks, "x": x, "y": y, "line": line, **more}


def in_legend_only(name: str, colour: int | str, **more: Any) -> Trace:
    """An entry of the legend without a line in the figure."""
    return curve([None], [None], colour, name=name, **more)


def upright(x: float, label: str) -> dict[str, Any]:
    """A dashed line across the figure at an abscissa, with its label at the top; parts of a layout."""
    line = {"type": "line", "x0": x, "x1": x, "yref": "paper", "y0": 0, "y1": 1}
    note = {"x": x, "y": 1, "yref": "paper", "yanchor": "bottom", "text": label, "showarrow": False}
    return {"shapes": [{**line, "line": {"dash": "dash", "width": 1, "color": GREY}}], "annotations": [note]}


def with_unit(value: float | None, unit: str, digits: int = 0, missing: str = "none") -> str:
    """A number with its unit, for use in text; `missing` for None."""
    return missing if value is None else f"{value:z.{digits}f} {unit}".replace("-", "−")  # z: no −0
