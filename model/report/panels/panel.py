"""A figure of the report: its finding, its data, and its description for screen readers."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

Trace = dict[str, Any]

# Okabe and Ito's colours, distinguishable with colour-vision deficiencies; used on light and dark backgrounds.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
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


def curve(x: np.ndarray, y: np.ndarray, number: int, marker: int = 0, dash: str | None = None, **more: Any) -> Trace:
    """A line in the colour of its number, with markers of so many pixels, if any."""
    line = {"width": 2, "color": COLOURS[number % len(COLOURS)]} | ({"dash": dash} if dash else {})
    marks = {"mode": "lines+markers", "marker": {"size": marker}} if marker else {"mode": "lines"}
    return {"type": "scatter", **marks, "x": x, "y": y, "line": line, **more}


def said(value: float, unit: str, digits: int = 0) -> str:
    """A number with its unit, for use in text."""
    return f"{value:z.{digits}f} {unit}".replace("-", "−")  # z: no −0
