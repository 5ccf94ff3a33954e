"""`coilset examples`: list the examples, or copy one to start from."""

from pathlib import Path

from coilset.model.run import examples


def show() -> None:
    """List the examples."""
    names = examples.names()
    width = max(map(len, names)) + 2
    for name in names:
        print(f"{name:{width}}{examples.title(name)}")
    print("\ncopy one with: coilset examples NAME")


def copy(name: str, out: str, force: bool) -> None:
    """Copy one, and what it needs, to a folder; see `coilset examples --help`.

    Raises:
        InputError: for an unknown name, or if files exist already.
    """
    for path in examples.copy(examples.find(name), Path(out), force):
        print(path)
