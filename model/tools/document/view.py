"""The drawing of a spring with its dimensions, as lines and texts: for a page and for a DXF file alike."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from coilset.meshes.drawings.silhouette import silhouette
from coilset.meshes.springs.geometry import Spring

Layer = Literal["OUTLINE", "AXIS", "DIMENSION"]
HIGH, WIDE = 66.0, 62.0  # mm on paper that the spring may take
LETTERS = 2.4  # height of letters on paper, mm
SCALES = (1.0, 2.0, 5.0)  # of ISO 5455
ROW = 4.6  # between texts on paper, mm
SQUARE = 0.7  # cosine to the axis, from which on a part of an arm is drawn from the side


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
    """A length of the spring from a level on, mm, with its text."""

    length: float
    text: str
    base: float = 0.0

    @property
    def top(self) -> float:
        """Level of its end, mm."""
        return self.base + self.length


def view(
    spring: Spring,
    levels: Sequence[Level],
    widths: Sequence[tuple[float, str]],
    wire: str,
    notes: Sequence[str] = (),
    number: Callable[[float], str] = "{:.4g}".format,
) -> Drawing:
    """The side view: lengths with forces on the right, diameters below, the wire and notes on the left.

    A spring with arms is seen from above, too, beside it; each straight part of an arm has its length where it is seen.

    Args:
        spring: as it is drawn.
        levels: lengths, the free one among them.
        widths: diameters with their texts, smallest first.
        wire: text of the wire's diameter.
        notes: lines of text.
        number: text of a length of an arm, mm.
    """
    t = spring.breaks
    outlines = silhouette(spring)
    plan = silhouette(spring, from_above=True) if any(tail and not tail.pulled for tail in spring.tails) else []
    points = np.concatenate([np.zeros((1, 2)), *outlines])
    reach = float(np.max(spring.mean_radius(t) + 0.5 * spring.width * spring.wire_diameter(t)))
    reach, low = max(reach, float(np.abs(points[:, 0]).max())), float(points[:, 1].min())
    high = max(float(points[:, 1].max()), spring.body_length)
    flat = np.concatenate([np.zeros((1, 2)), *plan])
    made = Drawing(_round_scale(max((high - low) / HIGH, 2.0 * reach / WIDE, *np.ptp(flat, axis=0) / WIDE)))
    u = made.unit
    made.lines += [(line, "OUTLINE") for line in outlines]
    made.line((0.0, low - 3.0 * u), (0.0, high + 3.0 * u), layer="AXIS")
    for row, (width, text) in enumerate(widths, 1):
        y = low - (3.0 + 6.0 * row) * u
        for x in (-0.5 * width, 0.5 * width):
            made.line((x, low - 1.0 * u), (x, y - 1.0 * u))
        made.arrow((-0.5 * width, y), (0.5 * width, y))
        made.texts.append(Text(text, 0.0, y + 0.8 * u, True))
    right = _levels(made, reach, levels)
    middle = float(spring.turns) / 2.0
    left = min(np.linspace(middle - 0.5, middle + 0.5, 65), key=lambda turn: spring.centre_line(turn)[0])
    x, _, z = spring.centre_line(left)
    made.line((x, z), (-reach - 6.0 * u, z + 5.0 * u), (-reach - 8.0 * u, z + 5.0 * u))
    start = -reach - 9.0 * u - 0.62 * LETTERS * u * max(map(len, (wire, *notes)))
    made.line((-reach - 8.0 * u, z + 5.0 * u), (start, z + 5.0 * u))
    made.texts.append(Text(wire, start, z + 5.8 * u))
    made.texts += [Text(note, start, high - (2.4 + ROW * row) * u) for row, note in enumerate(notes)]
    if plan:
        left_of, middle_of = flat[:, 0].min(), 0.5 * (flat[:, 1].min() + flat[:, 1].max())
        at = np.array([right + 8.0 * u - left_of, 0.5 * (low + high) - middle_of])
        made.lines += [(line + at, "OUTLINE") for line in plan]
        for one, other in (((reach, 0.0), (-reach, 0.0)), ((0.0, reach), (0.0, -reach))):
            made.line(at + one, at + other, layer="AXIS")
        _arms(made, spring, at, number)
    return made


def _levels(made: Drawing, reach: float, levels: Sequence[Level]) -> float:
    """A line at each length, its dimension, and its text, moved up where two would overlap; returns where texts end."""
    u = made.unit
    ordered = sorted(levels, key=lambda level: level.top)
    out = reach + (4.0 + 5.0 * len(ordered)) * u
    for base in {level.base for level in ordered}:
        made.line((reach + 1.0 * u, base), (out, base))
    below = -np.inf
    for row, level in enumerate(ordered):
        x, text_y = reach + (5.0 + 5.0 * row) * u, max(level.top, below + ROW * u)
        below = text_y
        made.line((reach + 1.0 * u, level.top), (out, level.top), (out + 4.0 * u, text_y), (out + 6.0 * u, text_y))
        made.arrow((x, level.base), (x, level.top))
        made.texts.append(Text(level.text, out + 7.0 * u, text_y - 0.4 * LETTERS * u))
    return out + (7.0 + 0.62 * LETTERS * max(len(level.text) for level in levels)) * u


def _arms(made: Drawing, spring: Spring, at: np.ndarray, number: Callable[[float], str]) -> None:
    """The lengths of the arms' straight parts: of those along the axis in the side view, of others from above."""
    u = made.unit
    for tail in spring.tails:
        for piece in tail.pieces if tail else ():
            if np.isfinite(piece.radius):
                continue
            along = abs(float(piece.tangent[2])) > SQUARE
            shown, shift = ([0, 2], np.zeros(2)) if along else ([0, 1], at)
            ends = [piece.along(np.array([s]), 0)[0, shown] + shift for s in (0.0, piece.length)]
            across = np.array([-(ends[1] - ends[0])[1], (ends[1] - ends[0])[0]])
            across /= max(float(np.linalg.norm(across)), 1e-12)
            outwards = across @ (0.5 * (ends[0] + ends[1]) - shift)
            across *= 1.0 if outwards >= 0.0 else -1.0
            away = 6.0 * u * across
            for end in ends:
                made.line(end + 0.3 * away, end + 1.15 * away)
            made.arrow(tuple(ends[0] + away), tuple(ends[1] + away))
            x, y = 0.5 * (ends[0] + ends[1]) + away * 1.3
            made.texts.append(Text(number(piece.length), x, y - 0.4 * LETTERS * u, True))


def _round_scale(unit: float) -> float:
    power = 10.0 ** np.floor(np.log10(unit))
    return float(next(power * one for one in (*SCALES, 10.0) if power * one >= unit * (1.0 - 1e-9)))
