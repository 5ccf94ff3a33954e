"""The reference page of the commands: their arguments and options, as the program's own help has them."""

from pathlib import Path

import click
import typer
from entry_pages import replace

from coilset.scripts.main import app

HEAD = """# Commands

In a checkout every command is `scripts/coilset COMMAND`, in an installation `coilset COMMAND`. Exit codes: 0 all is
well; 1 a number of `verify` is off, or a test failed; 2 something that the user gave is wrong, and nothing was written;
3 a solve found no equilibrium, or cases of a sweep failed, and what was found is kept; 130 Ctrl-C, 141 a closed output.
"""


def write(folder: Path) -> None:
    """Write the page into a folder."""
    root = typer.main.get_command(app)
    parts = [HEAD, *(section("coilset", name, command) for name, command in commands(root))]
    replace(folder / "commands.md", "\n".join(parts))


def commands(group: click.Group) -> list[tuple[str, click.Command]]:
    """All commands, those of groups with the group's name before theirs; the options before a command first."""
    found: list[tuple[str, click.Command]] = [("", group)] if group.name == "coilset" else []
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            found += [(f"{name} {inner}", one) for inner, one in commands(command)]
        else:
            found.append((name, command))
    return found


def section(program: str, name: str, command: click.Command) -> str:
    """One command: what it does, and a row for each argument and option."""
    lines = [f"## {program} {name}".rstrip(), "", (command.help or "").strip(), ""]
    rows = [row(item) for item in command.params if item.name not in ("help",)]
    if rows:
        lines += ["| argument or option | meaning | default |", "|---|---|---|", *rows, ""]
    return "\n".join(lines)


def row(item: click.Parameter) -> str:
    """An argument or an option."""
    if isinstance(item, click.Option) or item.param_type_name == "option":
        names = ", ".join([*item.opts, *item.secondary_opts])
        takes = "" if item.is_flag else f" {item.metavar or item.type.name.upper().removesuffix(' RANGE')}"
    else:
        names, takes = (item.name or "").upper(), ""
    default = item.default
    shown = "" if default is None or default is False or callable(default) or default == [] else f"`{default}`"
    if default is True:
        shown = "yes"
    meaning = (getattr(item, "help", None) or "").replace("|", "\\|")
    return f"| `{names}{takes}` | {meaning} | {'required' if item.required else shown} |"
