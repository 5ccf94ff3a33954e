"""Where a command will write, checked before it starts: an impossible folder or file is reported immediately."""

import os
import re
from pathlib import Path

from coilset.model.core.base.errors import InputError

OVERWRITE = ("--overwrite", "--force")
"""Names of the option that replaces existing results; the second is its earlier name."""
SHEETS = (".html", ".pdf", ".csv", ".dxf", ".step")
"""Suffixes of the files of a data sheet."""
FILE = re.compile(r"\.[A-Za-z]{2,5}")  # suffix of a file rather than part of a folder's name
UNFIT = re.compile(r"[/\0]|^\.+$")  # in the name of a folder


def folder_target(out: str | None) -> str | None:
    """Callback of an option that names a folder; returns it.

    Raises:
        InputError: if the folder cannot be made or written to.
    """
    if out is None:
        return None
    out = os.path.expanduser(out)  # shells leave the ~ of --out=~/x to us
    _check(Path(_named(out, "--out")), "--out")
    return out


def sheet_targets(paths: list[str] | None) -> list[str]:
    """Callback of an option that names files of SHEETS and a folder; returns them; raises as the others."""
    of_sheet = [path for path in paths or [] if os.path.splitext(path)[1].lower() in SHEETS]
    for path in paths or []:
        if path not in of_sheet:
            if FILE.fullmatch(os.path.splitext(path)[1]) and not os.path.isdir(path):
                raise InputError(f"'{path}' must end in {', '.join(SHEETS)}, or be a folder", "--out")
            folder_target(path)
    return [_file(path, "--out") if path in of_sheet else os.path.expanduser(path) for path in paths or []]


def results_folder(out: str | Path | None, name: str, *above: str) -> Path:
    """The folder that the user names, or results/ABOVE/NAME if none is named.

    Args:
        out: path given by the user.
        name: of the case, material or other source of the results; characters not allowed in folder names become `_`.
        above: folders in between.

    Raises:
        InputError: if the folder cannot be made or written to.
    """
    if out is not None:
        return Path(out)  # `folder_target` has checked it
    folder = Path("results", *above, UNFIT.sub("_", name) or "_")
    _check(folder, "--out")
    return folder


def file_targets(paths: list[str] | None) -> list[str]:
    """Callback of `--write`, which names files; returns them.

    Raises:
        InputError: if one is a folder, or its folder cannot be made or written to.
    """
    return [_file(path, "--write") for path in paths or []]


def page_target(path: str | None) -> str | None:
    """Callback of `--page`, which names a file; returns it; raises as `file_targets`."""
    return None if path is None else _file(path, "--page")


def _file(path: str, option: str) -> str:
    path = os.path.expanduser(_named(path, option))
    if os.path.isdir(path):  # of a path, as Path.is_dir fails on a name that is too long
        raise InputError("is a folder; give a file", option, path)
    _check(Path(path).parent, option, Path(path))
    return path


def _named(path: str, option: str) -> str:
    """A path that is not empty: Path would turn an empty one into the current folder."""
    if not path:
        raise InputError("is empty; give a name", option)
    return path


def _is_there(path: Path) -> bool:
    """Does it exist? From Python 3.14 on, Path.exists is False for a name that is too long; here that is an OSError."""
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


def _check(folder: Path, option: str, target: Path | None = None) -> None:
    target = target or folder
    try:
        there = next(one for one in (folder, *folder.absolute().parents) if _is_there(one))
        _is_there(target)
    except (OSError, ValueError) as error:  # ValueError: the name contains a null character
        shown = str(target) if len(str(target)) <= 80 else f"{str(target)[:77]}..."
        raise InputError(f"cannot be made: {getattr(error, 'strerror', error)}", option, shown) from None
    if not there.is_dir():
        raise InputError(
            f"{there} is a file; give a folder" if there != folder else "is a file; give a folder", option, target
        )
    if not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"{there} cannot be written to; give another", option, target)
