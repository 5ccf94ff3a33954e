"""`coilset material fit --spring`: constants of a wire from springs that were pressed and released."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coilset.model.core.base.errors import InputError
from coilset.scripts.commands.fitting.files import files_to_write, write_material, write_picture
from coilset.scripts.compiling import announce_compiling
from coilset.scripts.startup import typer
from coilset.scripts.terminal.target import OVERWRITE, folder_target

if TYPE_CHECKING:
    from coilset.model.tools.spring_fit.pressing import Pressing

FLAG, NAME = "--spring", "fit-springs"
DATA = typer.Argument(
    help="tester's files (CSV: travel, force; or height, force; or height, free_length), and after them the case file "
    "(YAML) of their spring; several springs one after the other"
)
KNOWN = typer.Option([], metavar="NAME=VALUE", help="a constant or a property of the tester that is given")
UNKNOWN = typer.Option([], metavar="NAME", help="fit friction, compliance or offset of the tester, too")


class MaterialGroup(typer.core.TyperGroup):
    """The commands of `coilset material`; `fit --spring` is `fit-springs`."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """See typer's own, whose types belong to a library that only some of its versions come with."""
        if args[:1] == ["fit"] and FLAG in args:
            args = [NAME, *(arg for arg in args[1:] if arg != FLAG)]
        return super().resolve_command(ctx, args)


def fit_springs(
    data: list[str] = DATA,
    law: str = typer.Option("voce", help="voce, or thesis: how hardening saturates"),
    known: list[str] = KNOWN,
    tester: list[str] = UNKNOWN,
    force_error: float = typer.Option(0.005, min=1e-6, max=0.5, help="relative error of the tester's force"),
    travel_error: float = typer.Option(0.02, min=1e-6, help="error of its travel, or of a measured length, mm"),
    name: str = typer.Option("fitted", help="name of the material"),
    out: str = typer.Option(None, callback=folder_target, help="results folder [default: results/material/NAME]"),
    force: bool = typer.Option(False, *OVERWRITE, help="overwrite existing files"),
) -> None:
    """Identify yield, hardening and G of a wire from springs that are pressed and released; also `fit --spring`."""
    from rich.table import Table

    from coilset.model.tools.spring_fit.figure import figure
    from coilset.model.tools.spring_fit.fit import fit_springs as fit
    from coilset.model.tools.spring_fit.model import TESTER, Errors
    from coilset.model.tools.spring_fit.next_press import next_press, words
    from coilset.scripts.terminal.console import Console

    announce_compiling()
    file, picture = files_to_write(out, name, force, f"{name}.yaml", "fit.png")
    pressings = _read(data)
    console = Console()
    found = fit(pressings, law, known_values(known), tester, Errors(force_error, travel_error))
    units = found.model.form.units | TESTER
    table = Table("constant", "value", "from", "to", "unit", "", box=None, padding=(0, 2))
    for one in found.intervals.values():
        mark = "not determined" if one.undetermined else ""
        table.add_row(one.name, f"{one.value:.5g}", f"{one.low:.4g}", f"{one.high:.4g}", units[one.name], mark)
    console.print(table)
    console.print("from, to: all constants lie within with 95 % confidence")
    names, matrix = found.model.fitted, found.correlation
    rows = Table("correlation", *names, box=None, padding=(0, 2))
    for constant, row in zip(names, matrix, strict=True):
        rows.add_row(constant, *("-" if value != value else f"{value:.2f}" for value in row))
    console.print(rows)
    console.print(f"rms residual {found.scatter:.3g} of the tester's errors, {found.model.readings} readings")
    for warning in filter(None, (found.misfit, found.caution)):
        console.warn(warning)
    for sentence in words(next_press(found), found.doubtful):
        console.print(sentence, soft_wrap=True)
    write_material(file, found.material(name), console)
    write_picture(figure(found), picture, console)


def known_values(texts: list[str]) -> dict[str, float]:
    """Numbers of `--known NAME=VALUE`.

    Raises:
        InputError: one that is not of this form.
    """
    from coilset.model.core.base.columns import number

    found = {}
    for text in texts:
        name, _, value = text.partition("=")
        found[name] = number(value)
        if found[name] != found[name]:
            raise InputError("give it as NAME=VALUE, as in G=79500", f"--known {text}")
    return found


def _read(paths: list[str]) -> "list[Pressing]":
    """The presses of the files, each with the case that follows it."""
    from coilset.model.core.case import UnloadedCase, read_case
    from coilset.model.tools.spring_fit.pressing import read_pressing

    found = []
    for path, case in with_cases(paths):
        if case is None:
            raise InputError("no case file of its spring follows; give press.csv spring.yaml", FLAG, path)
        found.append(read_pressing(path, read_case(case, kind=UnloadedCase)))
    return found


def with_cases(paths: Sequence[str]) -> Iterator[tuple[str, str | None]]:
    """Each tester's file with the case file (YAML) of its spring, the next one after it; None if there is none.

    Raises:
        InputError: a case file that no other file stands before.
    """
    waiting: list[str] = []
    for path in paths:
        if Path(path).suffix.lower() not in (".yaml", ".yml"):
            waiting.append(path)
            continue
        if not waiting:
            raise InputError("no tester's file stands before it; give press.csv spring.yaml", "", path)
        yield from ((one, path) for one in waiting)
        waiting = []
    yield from ((one, None) for one in waiting)
