"""The results folder: nothing is overwritten unasked, and no file is ever half written."""

import contextlib
import csv
import json
import os
from dataclasses import asdict, fields
from pathlib import Path

from coilset.model.errors import CoilsetError, InputError
from coilset.model.loading.stepper import Step


@contextlib.contextmanager
def whole(path):
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


def prepare(folder, force):
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


def write_summary(folder, summary):
    """summary.json."""
    with whole(Path(folder) / "summary.json") as path:
        path.write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def write_history(folder, steps):
    """history.csv: one row a step; numbers with all their digits."""
    with whole(Path(folder) / "history.csv") as path, open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [column.name for column in fields(Step)])
        writer.writeheader()
        writer.writerows(asdict(step) for step in steps)
