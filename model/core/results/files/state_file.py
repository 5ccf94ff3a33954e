"""The file of a checkpoint's state: .npz, in which all fields of the state are one array.

The head of an entry takes as long to write as 100 kB of numbers, so that two dozen fields of a short spring would cost
more by their number than by their size. They are written one after the other, without another copy of them all.
"""

import json
import math
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

ABOUT, STATE = "about", "state"  # entries besides those of the other arrays


def write(
    file: BinaryIO, about: Mapping[str, Any], fields: Mapping[str, np.ndarray], others: Mapping[str, np.ndarray]
) -> None:
    """Write a state.

    Args:
        file: an empty one.
        about: plain data beside the fields.
        fields: name → numbers of the field.
        others: name → another array, with an entry of its own.
    """
    shapes = {name: values.shape for name, values in fields.items()}
    head = {"descr": np.dtype(float).str, "fortran_order": False, "shape": (sum(map(math.prod, shapes.values())),)}
    with zipfile.ZipFile(file, "w") as archive:
        for name, values in {ABOUT: np.array(json.dumps({**about, "fields": shapes})), **others}.items():
            with _entry(archive, name) as entry:
                np.lib.format.write_array(entry, np.asanyarray(values))
        with _entry(archive, STATE) as entry:
            np.lib.format.write_array_header_1_0(entry, head)
            for values in fields.values():
                entry.write(np.ascontiguousarray(values, dtype=float).data)


def _entry(archive: zipfile.ZipFile, name: str) -> IO[bytes]:
    return archive.open(f"{name}.npy", "w", force_zip64=True)


def read(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray], dict[str, np.ndarray]]:
    """`about`, fields and other arrays of a file by `write`.

    Raises:
        KeyError: if one of its entries is missing.
        Exception: of many kinds, if the file is damaged.
    """
    others = read_arrays(path)
    about = json.loads(str(others.pop(ABOUT)))
    return about, _apart(others.pop(STATE), about.pop("fields")), others


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """All arrays of a file .npz."""
    with open(path, "rb") as content, np.load(content, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _apart(state: np.ndarray, shapes: Mapping[str, Sequence[int]]) -> dict[str, np.ndarray]:
    ends = np.cumsum([math.prod(shape) for shape in shapes.values()])
    parts = np.split(state, ends)
    if len(parts.pop()):
        raise ValueError(f"{len(state)} numbers of {ends[-1]}")
    return {name: part.reshape(shape) for (name, shape), part in zip(shapes.items(), parts, strict=True)}
