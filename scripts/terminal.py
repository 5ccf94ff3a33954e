"""What a run prints: lines broken to the terminal's width, colours on a terminal only.

The same as by rich, which takes as long to load as Python and typer together.
"""

import os
import shutil
import sys
import textwrap

CODES = {"bold": 1, "dim": 2, "yellow": 33}  # of ECMA-48, "select graphic rendition"


def styled(text: str, style: str) -> str:
    """The text in a style of CODES; unchanged where standard output is no terminal or shows no styles."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM", "dumb") in ("dumb", "unknown")
    return text if plain or not sys.stdout.isatty() else f"\x1b[{CODES[style]}m{text}\x1b[0m"


def say(text: str) -> None:
    """Print lines as they are."""
    print(text, flush=True)


def broken(text: str) -> str:
    """Lines of at most the terminal's width, 80 where there is none."""
    width = shutil.get_terminal_size().columns
    return "\n".join(textwrap.fill(line, width, break_on_hyphens=False) for line in text.split("\n"))


def columns(rows: list[tuple[str, str]], strong: str) -> str:
    """Two columns, the row that begins with the word `strong` in bold."""
    width = max(len(name) for name, _ in rows)
    lines = {name: f"  {name:{width}}    {value}" for name, value in rows}
    return "\n".join(styled(line, "bold") if name == strong else line for name, line in lines.items())
