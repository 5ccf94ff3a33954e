"""The results folder: nothing is overwritten without permission, and files are written whole or not at all."""

import contextlib
import csv
import errno
import json
import os
import re
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from coilset.model.core.base.columns import as_text
from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.results.records.record import SeatReactions, Step

UNFINISHED = ".*.partial*"  # of a run that was killed, see `whole`
LEFT = 60.0  # seconds without a byte more after which a partial file is one of a killed process
RECORDS = (
    "summary.json",
    "history.csv",
    "seats.csv",
    "points.nc",
    "checkpoint*/*.npz",
    "checkpoint*/*.jsonl",
    UNFINISHED,
)
DERIVED = (
    "fields/*.vtu",
    "fields/*.pvd",
    "fields/*.vtkhdf",
    "modes/*",
    "surge/*",
    "characteristic.png",
    "springs.png",
    "cross_section.png",
    "force_centre.png",
    "force_line.png",
    "seat_pressure.png",
    "buckling_mode.png",
    "section.png",
    "goodman.png",
    "fatigue.png",
    "animation.gif",
    "report.html",
)
RESULTS = RECORDS + DERIVED
DRAWN = ("drawing.png", "spring.png")
"""Pictures of the unloaded spring by `coilset mesh`."""


def not_linked(path: str | Path, flags: int) -> int:
    """Opener of a file of results that is written in place: a link there, which may lead anywhere, is an OSError."""
    return os.open(path, flags | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)


def _remove_left(path: Path) -> None:
    """Remove the partial files of `path` to which nobody has written for some time: those of killed processes."""
    partial = re.compile(rf"\.{re.escape(path.stem)}\.[0-9a-f]{{16}}\.partial{re.escape(path.suffix)}")
    with contextlib.suppress(OSError), os.scandir(path.parent) as entries:
        for entry in entries:
            if partial.fullmatch(entry.name) and entry.stat(follow_symlinks=False).st_mtime < time.time() - LEFT:
                os.unlink(entry)


@contextlib.contextmanager
def whole(path: str | Path) -> Iterator[Path]:
    """A temporary path, moved to `path` once it is complete; a full disk is reported in one line.

    Its name cannot be foreseen: a folder that somebody sent has no link of this name, and two processes that write
    the same file do not meet. What killed processes have left of this file is removed.

    Raises:
        CoilsetError: if the file cannot be written.
    """
    path = Path(path)
    partial = path.with_name(f".{path.stem}.{os.urandom(8).hex()}.partial{path.suffix}")
    try:
        _remove_left(path)
        os.close(not_linked(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
        yield partial
        if not partial.exists() or not partial.stat().st_size:
            # VTK reports nothing, and removes what it did not finish
            raise OSError(errno.EIO, "nothing of it was written; is the disk full?")
        os.replace(partial, path)
    except OSError as error:
        raise CoilsetError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


def make(folder: str | Path) -> None:
    """Make a folder, unless it exists.

    Raises:
        CoilsetError: if it cannot be made.
    """
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CoilsetError(f"{folder}: cannot be made: {error.strerror}") from None


def subfolder(folder: str | Path, name: str) -> Path:
    """Make a folder within one of results, unless it exists.

    Raises:
        CoilsetError: if it cannot be made, or is a link, through which a run would replace what is elsewhere.
    """
    path = Path(folder) / name
    if path.is_symlink():
        raise CoilsetError(f"{path}: is a link, and results are written into folders only; remove it")
    make(path)
    return path


@contextlib.contextmanager
def making(folder: Path) -> Iterator[None]:
    """Context that reports errors of the file system as errors of --out."""
    try:
        yield
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", "--out", folder) from None


def refuse_obstacles(folder: str | Path, files: Iterable[str], folders: Iterable[str] = ()) -> None:
    """Check whether all files can be written, before any is.

    Raises:
        InputError: if a folder has the name of a file, or a file that of a folder.
    """
    names = [
        *((name, os.path.isdir, "folder") for name in files),
        *((name, os.path.isfile, "file") for name in folders),
        *((name, os.path.islink, "link") for name in folders),
    ]
    for name, is_other, kind in names:
        if is_other(os.path.join(folder, name)):
            raise InputError(
                f"there is a {kind} named {name} in it, in the way of a result; move it, or give another --out",
                "--out",
                folder,
            )


def refuse_to_replace(paths: Iterable[Path], force: bool) -> None:
    """Check whether files can be written, before any is.

    Raises:
        InputError: if one of them exists already and `force` is not given.
    """
    for path in paths:
        if path.exists() and not force:
            raise InputError("already exists; use --overwrite to overwrite it", "", path)


def _complete(folder: Path) -> bool:
    """Whether a folder holds the results of a complete run."""
    try:
        return bool(json.loads((folder / "summary.json").read_text(encoding="utf-8"))["complete"])
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return False


def refuse_results(folder: str | Path, force: bool) -> None:
    """Check whether a run may write into a folder, and leave it as it is.

    Raises:
        InputError: if it already holds results or an interrupted run and `force` is not given.
    """
    plain = [name for name in RESULTS if "*" not in name]
    refuse_obstacles(
        folder, [*plain, "log.txt", "checkpoint/state.npz", "checkpoint/steps.jsonl"], ["checkpoint", "fields"]
    )
    folder = Path(folder)
    with making(folder):
        interrupted = (folder / "checkpoint" / "state.npz").exists() and not _complete(folder)
        if (folder / "summary.json").exists() and not (force or interrupted):
            raise InputError(
                "already holds results; use --overwrite to replace them, or another --out", "--out", folder
            )
        if interrupted and not force:
            raise InputError(
                "holds an interrupted run; use --resume to continue it, --overwrite to start again, or another --out",
                "--out",
                folder,
            )


def prepare(folder: str | Path, force: bool) -> Path:
    """Make the results folder.

    Raises:
        InputError: if it already holds results or an interrupted run and `force` is not given, or cannot be made.
    """
    refuse_results(folder, force)
    folder = Path(folder)
    with making(folder):
        folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot be written to; give another --out", "--out", folder)
    return folder


def clear(folder: str | Path, patterns: Sequence[str] = RESULTS) -> None:
    """Remove the results of an earlier run, the summary first, so that a folder never mixes two runs.

    Args:
        folder: results folder.
        patterns: which files; `DERIVED` are those made from the others, which a continued run makes out of date.

    Raises:
        CoilsetError: if a file cannot be removed.
    """
    for pattern in patterns:
        for path in Path(folder).glob(pattern):
            if path.parent != Path(folder) and path.parent.is_symlink():
                continue  # not of a run's: it makes no links
            try:
                path.unlink()
            except OSError as error:
                raise CoilsetError(f"{path}: cannot be removed: {error.strerror}") from None


def write_summary(folder: str | Path, summary: Mapping[str, Any]) -> None:
    """summary.json."""
    with whole(Path(folder) / "summary.json") as path:
        path.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def write_history(folder: str | Path, steps: Sequence[Any], kind: type[Any] = Step) -> None:
    """history.csv: one row per step; numbers with all their digits; `kind` is the dataclass of the steps."""
    names = [column.name for column in fields(kind)]
    write_table(Path(folder) / "history.csv", names, (asdict(step).values() for step in steps))


def write_seats(folder: str | Path, seats: Sequence[SeatReactions]) -> None:
    """seats.csv: one row per step."""
    rows = [one.row() for one in seats]
    write_table(Path(folder) / "seats.csv", list(rows[0]) if rows else ["step"], (row.values() for row in rows))


def write_table(target: Path, columns: Sequence[str], rows: Iterable[Iterable[object]]) -> None:
    """A file of comma-separated values: a line of names, then the rows, numbers with all their digits.

    Raises:
        CoilsetError: if it cannot be written.
    """
    with whole(target) as path, open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(as_text(columns))
        writer.writerows(map(as_text, rows))
