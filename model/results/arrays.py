"""Named arrays in a file of NumPy's format npz."""

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np


def write_arrays(file: BinaryIO, arrays: Mapping[str, np.ndarray]) -> None:
    """Write arrays as `np.savez` does, but from where they lie: its copies take longer than all else.

    Args:
        file: open for writing, at its beginning.
        arrays: name → numbers or words.
    """
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            values = np.asarray(array, order="C")
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array_header_1_0(member, np.lib.format.header_data_from_array_1_0(values))
                member.write(values.reshape(-1).view(np.uint8).data)


def read_arrays(path: Path) -> dict[str, np.ndarray]:
    """All arrays of a file; one that is damaged raises errors of many kinds."""
    with open(path, "rb") as content, np.load(content, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}
