"""The results folder: nothing is overwritten unasked, and no file is ever half written."""

import contextlib
import csv
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from coilset.model.errors import CoilsetError, InputError
from coilset.model.results.record import SeatReactions, Step


@contextlib.contextmanager
def whole(path: str | Path) -> Iterator[Path]:
    """A path to write to, moved to `path` when all is written; a disk that is full is said in one line.

    Raises:
        CoilsetError: if the file cannot be written.
    """
    path = Path(path)
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        yield partial
        os.replace(partial, path)
    except OSError as error:
        raise CoilsetError(f"{path}: cannot be written: {error.strerror or error}") from None
    finally:
        partial.unlink(missing_ok=True)


def prepare(folder: str | Path, force: bool) -> Path:
    """Make the results folder.

    Raises:
        InputError: if it holds results already and `force` is not given, or cannot be made.
    """
    folder = Path(folder)
    if (folder / "summary.json").exists() and not force:
        raise InputError("holds results already; give --force to replace them, or another --out", "--out", folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror}", "--out", folder) from None
    return folder


def write_summary(folder: str | Path, summary: Mapping[str, Any]) -> None:
    """summary.json."""
    with whole(Path(folder) / "summary.json") as path:
        path.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def write_history(folder: str | Path, steps: Sequence[Step]) -> None:
    """history.csv: one row a step; numbers with all their digits."""
    _write_table(Path(folder) / "history.csv", [item.name for item in fields(Step)], [asdict(step) for step in steps])


def write_seats(folder: str | Path, seats: Sequence[SeatReactions]) -> None:
    """seats.csv: one row a step."""
    rows = [one.row() for one in seats]
    _write_table(Path(folder) / "seats.csv", list(rows[0]) if rows else ["step"], rows)


def _write_table(target: Path, columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> None:
    with whole(target) as path, open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
