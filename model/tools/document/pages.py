"""The data sheet on A4: one page, and a second one for diagrams and what the first one has no room for."""

import textwrap
from collections.abc import Iterator, Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.tools.checks.check import HEADS
from coilset.model.tools.document.content import Document, Line
from coilset.model.tools.document.view import LETTERS, Drawing
from coilset.model.tools.figures.png import draw

WIDTH, HEIGHT, MARGIN = 210.0, 297.0, 12.0  # mm
INCH = 25.4
POINT = 72.0 / INCH  # points to a mm
HEAD = 44.0  # mm of the head of the first page
SMALL, PITCH = 6.6, 3.75  # points of the tables, mm of a line
REMARK = 2.9  # mm of a line of the remarks
BESIDE = 75.0  # mm of a diagram beside the table
CHECK = 3.3  # mm of a line of the checks
CELLS = ((0.0, "left"), (48.0, "left"), (84.0, "right"), (106.0, "right"), (122.0, "right"))
"""Where the cells of a check are, mm from the margin, and which side of the text that is."""
BASIS, LETTERS_OF_BASIS = 125.0, 66
COLUMN = 0.5 * (WIDTH - 2 * MARGIN - 6.0)
WEIGHTS = {"OUTLINE": 0.9, "AXIS": 0.5, "DIMENSION": 0.4}
STYLES = {"OUTLINE": "-", "AXIS": (0, (10, 3, 2, 3)), "DIMENSION": "-"}

Item = tuple[str, Line | None]  # a heading, or a line of a table


def pages(made: Document) -> list[Figure]:
    """Figures of A4 in the look of coilset: one where all is on it, or two."""
    with mpl.rc_context(STYLE):
        first, axes = _page(made)
        _head(axes, made)
        top = _checks(axes, made, HEIGHT - MARGIN - HEAD)
        bottom = _drawing(axes, made.drawing, top) - 6.0
        _numbers(axes, made, top)
        items, remarks = list(_items(made)), _remark_lines(made)
        room = bottom - MARGIN - REMARK * (len(remarks) + 1 if remarks else 0)
        if max(_height(items), len(made.panels) * BESIDE) < room:
            _columns(axes, items, bottom, made)
            _diagrams(first, made, bottom, 1, BESIDE, MARGIN + COLUMN + 6.0)
            _number(axes, made, 1, 1)
            _remarks(axes, made, remarks)
            return [first]
        rest = _columns(axes, items, bottom, made)
        _number(axes, made, 1, 2)
        second, axes = _page(made)
        _number(axes, made, 2, 2)
        top = HEIGHT - MARGIN - 6.0
        axes.text(MARGIN, top + 3.0, f"{made.title} {dict(made.head).get(made.words('part'), '')}".strip(), fontsize=9)
        if made.panels:
            columns, high = (len(made.panels), 80.0) if rest else (1, 115.0)
            top = _diagrams(second, made, top, columns, high)
        rest = _columns(axes, rest, top - 6.0, made)
        _remarks(axes, made, remarks)
    return [first, second]


def _page(made: Document) -> tuple[Figure, Axes]:
    """A figure and axes over all of it, in mm from its lower left corner."""
    figure = Figure(figsize=(WIDTH / INCH, HEIGHT / INCH))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, WIDTH), ylim=(0.0, HEIGHT))
    axes.set_axis_off()
    axes.text(MARGIN, 6.0, f"coilset · {made.basis}", fontsize=SMALL, color="0.4")
    return figure, axes


def _number(axes: Axes, made: Document, page: int, pages: int) -> None:
    axes.text(WIDTH - MARGIN, 6.0, made.words(f"page {page} of {pages}"), fontsize=SMALL, ha="right", color="0.4")


def _head(axes: Axes, made: Document) -> None:
    """Title, then a table with one cell for each entry, wide enough to be filled in by hand."""
    top, wide = HEIGHT - MARGIN, WIDTH - 2 * MARGIN
    axes.text(MARGIN, top - 4.0, made.title, fontsize=15, va="center", weight="bold")
    axes.text(MARGIN, top - 11.0, made.basis, fontsize=7.5, va="center")
    for k, (name, value) in enumerate(made.head):
        row, place = divmod(k, 3)
        cells = min(len(made.head) - 3 * row, 3)
        left, right = (MARGIN + wide * share / cells for share in (place, place + 1))
        y = top - 16.0 - 11.0 * row
        axes.plot([left, right, right, left, left], [y, y, y - 11.0, y - 11.0, y], color="0.3", lw=0.6)
        axes.text(left + 1.5, y - 3.0, name, fontsize=5.8, color="0.35", va="center")
        letters = max(int((right - left) / 1.75), 8)
        axes.text(left + 1.5, y - 7.4, textwrap.shorten(value, letters, placeholder="…"), fontsize=8.5, va="center")


def _checks(axes: Axes, made: Document, top: float) -> float:
    """The table of checks below a level, over the whole width; returns the level that it ends at."""
    if not made.checks:
        return top
    y = top - PITCH
    axes.text(MARGIN, y, made.verdict, fontsize=SMALL + 0.6, weight="bold")
    heads = tuple(made.words(head) for head in HEADS)
    for cells, basis in [(heads, made.words("limit from")), *made.checks]:
        y -= CHECK
        for cell, (x, side) in zip(cells, CELLS, strict=True):
            axes.text(MARGIN + x, y, cell, fontsize=SMALL - 0.4, ha=side)
        axes.text(MARGIN + BASIS, y, textwrap.shorten(basis, LETTERS_OF_BASIS, placeholder="…"), fontsize=5.4)
        axes.plot([MARGIN, WIDTH - MARGIN], [y - 0.8] * 2, color="0.85", lw=0.3)
    return y - 3.0


def _numbers(axes: Axes, made: Document, top: float) -> None:
    text = made.words(f"scale {made.drawing.scale}")
    axes.text(WIDTH - MARGIN, top - 1.0, f"mm, N · {text}", fontsize=7, ha="right", va="top")


def _drawing(axes: Axes, drawing: Drawing, top: float) -> float:
    """The drawing below a level, centred between the margins; returns the level that it ends at."""
    u, letters = drawing.unit, 0.62 * LETTERS
    right = max(text.x / u + letters * len(text.text) * (0.5 if text.middle else 1.0) for text in drawing.texts)
    left = min(text.x / u - (0.5 * letters * len(text.text) if text.middle else 0.0) for text in drawing.texts)
    high = max(max(float(points[:, 1].max()) for points, _ in drawing.lines), *(text.y for text in drawing.texts)) / u
    low = min(float(points[:, 1].min()) for points, _ in drawing.lines) / u
    x0, y0 = 0.5 * WIDTH - 0.5 * (left + right), top - 3.0 - high
    for points, layer in drawing.lines:
        x, y = x0 + points[:, 0] / u, y0 + points[:, 1] / u
        axes.plot(x, y, color="k", lw=WEIGHTS[layer], ls=STYLES[layer], solid_joinstyle="round")
    for text in drawing.texts:
        place = "center" if text.middle else "left"
        axes.text(x0 + text.x / u, y0 + text.y / u, text.text, fontsize=0.95 * LETTERS * POINT, ha=place)
    return y0 + low


def _items(made: Document) -> Iterator[Item]:
    for title, lines in made.tables:
        yield title, None
        yield from ((title, line) for line in lines)


def _columns(axes: Axes, items: Sequence[Item], top: float, made: Document) -> list[Item]:
    """Fill two columns below a level with lines; returns those that have no room."""
    rest = list(items)
    for left in (MARGIN, MARGIN + COLUMN + 6.0):
        y = top
        while rest and y - _group(rest) * PITCH > MARGIN:
            title, line = rest.pop(0)
            y -= _height([(title, line)])
            _row(axes, left, y, title, line, made)
    return rest


def _height(items: Sequence[Item]) -> float:
    """Of so many lines in one column, mm."""
    return PITCH * sum(1.0 if line else 1.4 for _, line in items)


def _group(items: Sequence[Item]) -> float:
    """Height of what remains together at a column's foot, in lines: a heading with a line, a line with its parts."""
    if items[0][1] is None:
        return 1.4 + (_group(items[1:]) if len(items) > 1 else 0.0)
    parts = 1
    while parts < len(items) and (line := items[parts][1]) is not None and line.label.startswith(" "):
        parts += 1
    return float(parts)


def _row(axes: Axes, left: float, y: float, title: str, line: Line | None, made: Document) -> None:
    ends = left + COLUMN * (0.69 if made.has_run else 0.85), left + COLUMN * 0.85
    if line is None:
        axes.text(left, y, title, fontsize=SMALL + 0.6, weight="bold")
        for x, text in zip(ends, (made.words("formula"), made.words("run")), strict=True) if made.has_run else ():
            axes.text(x, y, text, fontsize=SMALL - 1.0, ha="right", color="0.4")
        axes.plot([left, left + COLUMN], [y - 0.9] * 2, color="0.3", lw=0.5)
        return
    axes.text(left + 0.8 * (len(line.label) - len(line.label.lstrip())), y, line.label.strip(), fontsize=SMALL)
    alone = not line.unit and not line.found and line.value[:1].isalpha()  # a word, which takes the units' room too
    if alone:
        axes.text(left + COLUMN, y, line.value, fontsize=SMALL, ha="right")
    else:
        axes.text(ends[0], y, line.value, fontsize=SMALL, ha="right")
        axes.text(ends[1], y, line.found, fontsize=SMALL, ha="right")
        axes.text(ends[1] + 1.5, y, line.unit, fontsize=SMALL - 0.6)
    axes.plot([left, left + COLUMN], [y - 0.9] * 2, color="0.85", lw=0.3)


def _diagrams(figure: Figure, made: Document, top: float, columns: int, high: float, start: float = MARGIN) -> float:
    """The diagrams in columns, `high` mm each, from a left edge on; returns the level they end at."""
    wide = (WIDTH - MARGIN - start) / columns
    for k, panel in enumerate(made.panels):
        row, column = divmod(k, columns)
        left, low = start + column * wide + 13.0, top - (row + 1) * high + 12.0
        axes = figure.add_axes((left / WIDTH, low / HEIGHT, (wide - 18.0) / WIDTH, (high - 20.0) / HEIGHT))
        draw(axes, panel)
        axes.set_title(panel.title, fontsize=8.5)
        axes.tick_params(labelsize=6.5)
        axes.xaxis.label.set_size(7)
        axes.yaxis.label.set_size(7)
        axes.legend(fontsize=6)
        for name in (axes.xaxis, axes.yaxis):
            if made.words.language == "de":
                name.set_major_formatter(lambda value, _: made.words.number(value, 6))
    return top - high * -(-len(made.panels) // columns)


def _remark_lines(made: Document) -> list[str]:
    return [part for text in made.remarks for part in textwrap.wrap(f"– {text}", 150, subsequent_indent="   ")]


def _remarks(axes: Axes, made: Document, lines: Sequence[str]) -> None:
    """At the foot of the last page."""
    y = MARGIN + 1.0 + REMARK * len(lines)
    if not lines:
        return
    axes.text(MARGIN, y, made.words("Remarks"), fontsize=SMALL, weight="bold")
    for k, line in enumerate(lines, 1):
        axes.text(MARGIN, y - REMARK * k, line, fontsize=5.8)
