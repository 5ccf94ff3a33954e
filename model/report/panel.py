"""A figure of the report: what it says, how it is drawn, and how it is told to whoever does not see it."""

from dataclasses import dataclass, field
from typing import Any

Trace = dict[str, Any]

# Okabe and Ito's colours, which all eyes tell apart; the page puts them on light and on dark.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DIVERGING = "RdBu"
LINE = {"width": 2}


@dataclass(frozen=True)
class Panel:
    """One figure.

    Attributes:
        name: of the figure, for links.
        title: the finding, in a sentence.
        description: the same for whoever hears the page: what is drawn, from where to where.
        traces: of plotly. One that belongs to a choice has its number in `meta.choice`.
        layout: of plotly.
        choices: what can be chosen between, such as moments; the last is shown first.
        choice: what is chosen, for the label.
        height: pixels.
        note: a remark under the figure.
    """

    name: str
    title: str
    description: str
    traces: list[Trace]
    layout: dict[str, Any] = field(default_factory=dict)
    choices: tuple[str, ...] = ()
    choice: str = "moment"
    height: int = 380
    note: str = ""


def axis(title: str, **more: Any) -> dict[str, Any]:
    """An axis with its quantity and unit."""
    return {"title": {"text": title}, **more}


def said(value: float, unit: str, digits: int = 0) -> str:
    """A number with its unit, as a text shows it."""
    return f"{value:.{digits}f} {unit}".replace("-", "−")
