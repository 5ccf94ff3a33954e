"""Labelled arrays and their NetCDF file, without the libraries for reading such files, which are slow to load."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.results.files.folder import whole

HEADER = 1 << 20  # maximum number of bytes of a file besides its numbers


@dataclass(frozen=True)
class Variable:
    """An array with names for its dimensions.

    Attributes:
        dims: a name for each dimension.
        values: numbers, or words.
        attrs: texts, such as its `units`.
        is_beside: whether it is a coordinate along its dimensions, none of which has its name.
    """

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: Mapping[str, str] = field(default_factory=dict)
    is_beside: bool = False


def coordinates(data: Mapping[str, Variable]) -> list[str]:
    """Names of the coordinates among variables."""
    return [name for name, one in data.items() if one.dims == (name,) or one.is_beside]


def reserve(path: Path, size: int) -> None:
    """Make sure that the disk has room for a file of `size` bytes of numbers; the NetCDF library crashes otherwise.

    Raises:
        OSError: if it does not.
    """
    if hasattr(os, "posix_fallocate"):
        with open(path, "wb") as file:
            os.posix_fallocate(file.fileno(), 0, size + HEADER)


def write_netcdf(target: str | Path, data: Mapping[str, Variable], attrs: Mapping[str, str]) -> None:
    """Write variables and attributes as a NetCDF 4 file by the conventions of CF, which xarray follows too.

    Raises:
        CoilsetError: if it cannot be written.
    """
    import h5netcdf
    import h5py

    with whole(target) as path:
        reserve(path, sum(one.values.nbytes for one in data.values()))
        with h5netcdf.File(path, "w") as file:
            for one in data.values():
                for dim, size in zip(one.dims, one.values.shape, strict=True):
                    if dim not in file.dimensions:
                        file.dimensions[dim] = size
            # Coordinates first: they replace the places held for their dimensions, also in what has these already.
            for name, one in sorted(data.items(), key=lambda each: (each[1].dims != (each[0],), each[1].is_beside)):
                words = one.values.dtype.kind in "UO"
                values: Any = one.values.astype(object) if words else one.values
                made = file.create_variable(
                    name,
                    one.dims,
                    h5py.string_dtype() if words else values.dtype,
                    data=values,
                    fillvalue=np.nan if values.dtype.kind == "f" else None,
                )
                made.attrs.update(one.attrs)
                along = [other for other, it in data.items() if it.is_beside and set(it.dims) <= set(one.dims)]
                if along and name not in coordinates(data):
                    made.attrs["coordinates"] = " ".join(along)
            file.attrs.update(attrs)
