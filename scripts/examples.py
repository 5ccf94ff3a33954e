"""`coilset examples`: list the examples, or copy one to start from."""

from pathlib import Path

from rich.console import Console
from rich.table import Table

from coilset.model import examples


def show() -> None:
    """List the examples."""
    table = Table(box=None, padding=(0, 2), show_header=False)
    for name in examples.names():
        table.add_row(name, examples.title(name))
    console = Console(highlight=False)
    console.print(table)
    console.print("copy one with: coilset examples NAME")


def copy(name: str, out: str, force: bool) -> None:
    """Copy one, and what it needs, to a folder; see `coilset examples --help`.

    Raises:
        InputError: for a name that is none, and for files that are there.
    """
    for path in examples.copy(examples.find(name), Path(out), force):
        print(path)
