"""The console of all commands: texts are printed as they are, though brackets in them may look like rich's markup.

What is to stand out is a `styled` text: names and words of files are never read as markup.
"""

import re
from collections.abc import Iterable
from typing import Any

from rich import console
from rich.table import Table
from rich.text import Text

from coilset.model.core.base.errors import printable
from coilset.model.core.results.quantities import Quantity

ORDERS = re.compile("[\0-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


def without_orders(text: str) -> str:
    """A text that moves no cursor, sets no clipboard and turns no letters round, whatever a name from a file has."""
    return ORDERS.sub(lambda found: printable(found[0]), text)


def styled(style: str, text: str, rest: str = "", before: str = "") -> Text:
    """A text in one of rich's styles, such as `bold`, with the rest of its line and what is before it."""
    return Text.assemble(without_orders(before), (without_orders(text), style), without_orders(rest))


def table(
    columns: Iterable[str],
    rows: Iterable[Iterable[str]] = (),
    title: str | None = None,
    left: int = 1,
    padding: int = 2,
) -> Table:
    """A table without lines, whose numbers end at the right.

    Args:
        columns: their heads; those without a head hold words.
        rows: cells; more can be added.
        title: above it, on the left.
        left: number of columns, from the first on, that hold words, too.
        padding: blanks on both sides of a cell.
    """
    made = Table(title=title, title_justify="left", box=None, padding=(0, padding))
    for number, column in enumerate(columns):
        made.add_column(column, justify="left" if number < left or not column else "right")
    for row in rows:
        made.add_row(*row)
    return made


class Console(console.Console):
    """As rich's, which highlights nothing and reads no markup.

    Args:
        options: of rich's.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(highlight=False, markup=False, **options)
        self._warned: set[tuple[str, str]] = set()

    def render_str(self, text: str, **options: Any) -> Text:
        """A text, of whose letters none is an order to the terminal."""
        return super().render_str(without_orders(text), **options)

    def say(self, text: str, whole: bool = False) -> None:
        """A line with names of the user's, wrapped at the width of the console unless it stays whole."""
        self.print(text, soft_wrap=whole)

    def pairs(self, rows: Iterable[tuple[str, str]], bold: str = "\n") -> None:
        """Names and values, in two columns without heads; long values are wrapped rather than names.

        Args:
            rows: of the table.
            bold: how the names of those begin that stand out.
        """
        rows = list(rows)
        made = Table(show_header=False, box=None, padding=(0, 2))
        made.add_column(no_wrap=all(len(name) <= self.width // 2 for name, _ in rows))
        for row in rows:
            made.add_row(*row, style="bold" if row[0].startswith(bold) else "")
        self.print(made)

    def quantities(self, ones: Iterable[Quantity]) -> None:
        """Numbers of a run, a line each; a remark that does not fit into it follows on a line of its own."""
        ones = list(ones)
        width = max((len(one.words) for one in ones), default=0)
        for one in ones:
            line = f"  {one.words:<{width}}  {one.text}"
            gap = "  " if len(line) + 2 + len(one.remark) <= self.width else "\n      "
            remark = (f"{gap}{one.remark}", "dim") if one.remark else ""
            style = "bold" if one.words == "set" else ""
            self.print(Text.assemble((without_orders(line), style), remark), soft_wrap=True)

    def warn(self, text: str, kind: str = "warning") -> None:
        """A warning, or another line that begins with its kind; once, however often it is given."""
        if (kind, text) in self._warned:
            return
        self._warned.add((kind, text))
        self.print(styled("yellow", f"{kind}:", f" {text}"))
