"""The drawing of a spring with its dimensions, as lines and texts: for a page and for a DXF file alike."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from coilset.meshes.silhouette import silhouette
from coilset.meshes.springs.geometry import Spring

Layer = Literal["OUTLINE", "AXIS", "DIMENSION"]
HIGH, WIDE = 66.0, 62.0  # mm on paper that the spring may take
LETTERS = 2.4  # height of letters on paper, mm
SCALES = (1.0, 2.0, 5.0)  # of ISO 5455
ROW = 4.6  # between texts on paper, mm


@dataclass(frozen=True)
class Text:
    """A text at a place, mm of the spring; `middle` is centred, else it begins there."""

    text: str
    x: float
    y: float
    middle: bool = False


@dataclass
class Drawing:
    """Lines and texts in mm of the spring.

    Attributes:
        unit: mm of the spring to one on paper.
        lines: points, shape (n, 2), and layer of each.
        texts: in letters of LETTERS on paper.
    """

    unit: float
    lines: list[tuple[np.ndarray, Layer]] = field(default_factory=list)
    texts: list[Text] = field(default_factory=list)

    @property
    def scale(self) -> str:
        """As on a drawing, such as 2:1."""
        return f"1:{self.unit:g}" if self.unit >= 1.0 else f"{1.0 / self.unit:g}:1"

    def line(self, *points: Sequence[float] | np.ndarray, layer: Layer = "DIMENSION") -> None:
        """A line through points."""
        self.lines.append((np.array(points, dtype=float), layer))

    def arrow(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """A line with an arrow at either end."""
        self.line(start, end)
        a, b = np.array(start), np.array(end)
        along = (b - a) / max(float(np.linalg.norm(b - a)), 1e-12) * 2.0 * self.unit
        across = 0.2 * np.array([-along[1], along[0]])
        for tip, back in ((a, along), (b, -along)):
            self.line(tip + back + across, tip, tip + back - across)


@dataclass(frozen=True)
class Level:
    """A length of the spring with its text."""

    length: float
    text: str


def view(
    spring: Spring,
    levels: Sequence[Level],
    widths: Sequence[tuple[float, str]],
    wire: str,
    notes: Sequence[str] = (),
) -> Drawing:
    """The side view: lengths with forces on the right, diameters below, the wire and notes on the left.

    Args:
        spring: as it is drawn.
        levels: lengths, the free one among them.
        widths: diameters with their texts, smallest first.
        wire: text of the wire's diameter.
        notes: lines of text.
    """
    t = spring.breaks
    reach = float(np.max(spring.mean_radius(t) + 0.5 * spring.width * spring.wire_diameter(t)))
    length, base = spring.free_length, spring.levels[0]
    outlines = [line - [0.0, base] for line in silhouette(spring)]
    low, high = 0.0, length
    if spring.has_tails:
        x, z = np.concatenate(outlines).T
        low, high, reach = min(low, z.min()), max(high, z.max()), max(reach, np.abs(x).max())
    made = Drawing(_round_scale(max((high - low) / HIGH, 2.0 * reach / WIDE)))
    u = made.unit
    made.lines += [(line, "OUTLINE") for line in outlines]
    made.line((0.0, low - 3.0 * u), (0.0, high + 3.0 * u), layer="AXIS")
    for row, (width, text) in enumerate(widths, 1):
        y = low - (3.0 + 6.0 * row) * u
        for x in (-0.5 * width, 0.5 * width):
            made.line((x, low - 1.0 * u), (x, y - 1.0 * u))
        made.arrow((-0.5 * width, y), (0.5 * width, y))
        made.texts.append(Text(text, 0.0, y + 0.8 * u, True))
    _levels(made, reach, levels)
    middle = float(spring.turns) / 2.0
    left = min(np.linspace(middle - 0.5, middle + 0.5, 65), key=lambda turn: spring.centre_line(turn)[0])
    x, z = spring.centre_line(left)[[0, 2]] - [0.0, base]
    made.line((x, z), (-reach - 6.0 * u, z + 5.0 * u), (-reach - 8.0 * u, z + 5.0 * u))
    start = -reach - 9.0 * u - 0.62 * LETTERS * u * max(map(len, (wire, *notes)))
    made.line((-reach - 8.0 * u, z + 5.0 * u), (start, z + 5.0 * u))
    made.texts.append(Text(wire, start, z + 5.8 * u))
    made.texts += [Text(note, start, length - (2.4 + ROW * row) * u) for row, note in enumerate(notes)]
    return made


def _levels(made: Drawing, reach: float, levels: Sequence[Level]) -> None:
    """A line at each length, its dimension from the bottom, and its text, moved up where two would overlap."""
    u = made.unit
    ordered = sorted(levels, key=lambda level: level.length)
    out = reach + (4.0 + 5.0 * len(ordered)) * u
    made.line((reach + 1.0 * u, 0.0), (out, 0.0))
    below = -np.inf
    for row, level in enumerate(ordered):
        x, text_y = reach + (5.0 + 5.0 * row) * u, max(level.length, below + ROW * u)
        below = text_y
        made.line(
            (reach + 1.0 * u, level.length), (out, level.length), (out + 4.0 * u, text_y), (out + 6.0 * u, text_y)
        )
        made.arrow((x, 0.0), (x, level.length))
        made.texts.append(Text(level.text, out + 7.0 * u, text_y - 0.4 * LETTERS * u))


def _round_scale(unit: float) -> float:
    power = 10.0 ** np.floor(np.log10(unit))
    return float(next(power * one for one in (*SCALES, 10.0) if power * one >= unit * (1.0 - 1e-9)))
