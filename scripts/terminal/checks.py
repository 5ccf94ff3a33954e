"""The table of checks of a spring on the terminal."""

from collections.abc import Sequence

from rich.text import Text

from coilset.model.tools.checks.check import HEADS, Check, Verdict, sentence
from coilset.scripts.terminal.console import Console, styled

STYLES = {Verdict.NOT_PERMITTED: "bold red", Verdict.NOT_KNOWN: "yellow"}


def check_lines(console: Console, made: Sequence[Check]) -> None:
    """The table of checks, what they say together first; where limits are from follows on a line of its own."""
    if not made:
        return
    failed = any(one.verdict is Verdict.NOT_PERMITTED for one in made)
    console.print(styled("bold red" if failed else "bold", sentence(made)), soft_wrap=True)
    rows = [HEADS, *(one.cells for one in made)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(HEADS))]
    for one, row in zip((None, *made), rows, strict=True):
        name, verdict, *numbers = (f"{cell:{'<' if k < 2 else '>'}{widths[k]}}" for k, cell in enumerate(row))
        line, rest = f"  {name}  ", f"  {'  '.join(numbers)}"
        if one is None:
            console.print(styled("dim", f"{line}{verdict}{rest}"), soft_wrap=True)
            continue
        fits = len(line) + len(verdict) + len(rest) + 2 + len(one.why) <= console.width
        why = f"{'  ' if fits else chr(10) + 6 * ' '}{one.why}".rstrip()
        text = Text.assemble(line, (verdict, STYLES.get(one.verdict, "")), rest, (why, "dim"))
        console.print(text, soft_wrap=True)
