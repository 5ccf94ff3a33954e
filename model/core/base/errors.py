"""All errors that a user may see; the text of each is one line."""

import contextlib
from collections.abc import Iterator
from typing import Any

LONGEST_REASON = 200  # characters


def printable(text: str) -> str:
    """A line with unprintable and control characters escaped; names of files may contain any."""
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)


class CoilsetError(Exception):
    """Base of the errors that end a run with one clear line; `exit_code` is the command's exit code."""

    exit_code = 1


class InputError(CoilsetError):
    """Wrong input: names the file, the place in it, the value, and what would be right.

    Args:
        problem: the error and how to correct it, without a full stop.
        place: the entry, as in ``spring.wire_diameter``, or a column or line; empty if there is none.
        file: the file's path as the user gave it; empty if the input came from elsewhere.
    """

    exit_code = 2

    def __init__(self, problem: object, place: str = "", file: object = "") -> None:
        self.problem, self.place, self.file = problem, place, file
        text = ": ".join(str(part) for part in (file, place, problem) if part)
        super().__init__(printable(text))


@contextlib.contextmanager
def reading(file: object) -> Iterator[None]:
    """Context in which whatever a reader of a file raises becomes the error for it, with the reason's first line.

    A damaged file, or one of another version, can fail in any way, also within libraries.
    """
    try:
        yield
    except CoilsetError:
        raise
    except Exception as error:
        raise InputError(f"is not readable: {reason(error)}", "", file) from error


def reason(error: Exception) -> str:
    """Why a file cannot be read, from a reader's exception, which may repeat its bytes: a line of limited length."""
    if isinstance(error, TypeError | AttributeError):  # whose words are about objects of the program
        return "it is damaged, or was written by another version of coilset"
    said = printable(str(error).partition("\n")[0]) or type(error).__name__
    if isinstance(error, KeyError):  # a name, or what a library says of one
        said = said.strip("'\"").partition(". ")[0] if " " in said else f"{said} is missing"
    return said if len(said) <= LONGEST_REASON else f"{said[:LONGEST_REASON]} ..."


@contextlib.contextmanager
def naming(file: object) -> Iterator[None]:
    """Context in which wrong input that names no file is that of this one."""
    try:
        yield
    except InputError as error:
        raise InputError(error.problem, error.place, error.file or file) from None


class SolveError(CoilsetError):
    """A solve that did not converge or cannot continue; the results up to that point are kept.

    Attributes:
        result: the Result up to there, of `coilset.api.solve`; None elsewhere, or without a step.
    """

    exit_code = 3
    result: Any = None


EXTRAS = {
    "mesh": ("gmsh", "meshio"),
    "pictures": ("matplotlib", "PIL", "pyvista", "vtk", "vtkmodules"),
    "report": ("jinja2", "plotly"),
    "sweep": ("pyarrow",),
    "modes": ("slepc4py",),
    "cluster": ("dask", "distributed"),
    "search": ("optuna", "SALib"),
}
"""The libraries that a run does without: the modules of each extra of pyproject.toml."""


def how_to_install(error: ModuleNotFoundError) -> str | None:
    """One line on the library that could not be imported; None if it belongs to no extra."""
    library = (error.name or "").partition(".")[0]
    extra = next((name for name, modules in EXTRAS.items() if library in modules), None)
    return extra and f"this needs {library}, which is not installed: pip install 'coilset[{extra}]'"
