"""Labelled arrays and their NetCDF file, without the libraries for reading such files, which are slow to load."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coilset.model.core.results.files.child import in_child
from coilset.model.core.results.files.folder import whole

if TYPE_CHECKING:  # slow to load
    from xarray import Dataset

PACKED = 1000  # bytes of numbers for each of the file, at most, as zlib packs zeros
ABOUT = "about/"  # no name of a variable has a slash
HEADER = 1 << 20  # maximum number of bytes of a file besides its numbers


@dataclass(frozen=True)
class Stack:
    """Arrays of one shape along a further, first dimension: a file takes one after the other, without a copy of all.

    Attributes:
        rows: the arrays, one at least.
    """

    rows: Sequence[np.ndarray]

    @property
    def shape(self) -> tuple[int, ...]:
        """Of all of them."""
        return len(self.rows), *self.rows[0].shape

    @property
    def dtype(self) -> np.dtype:
        """Of their numbers."""
        return self.rows[0].dtype

    @property
    def nbytes(self) -> int:
        """Of all of them."""
        return sum(row.nbytes for row in self.rows)


@dataclass(frozen=True)
class Variable:
    """An array with names for its dimensions.

    Attributes:
        dims: a name for each dimension.
        values: numbers, or words; a Stack along the first dimension.
        attrs: texts, such as its `units`.
        is_beside: whether it is a coordinate along its dimensions, none of which has its name.
    """

    dims: tuple[str, ...]
    values: np.ndarray | Stack
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


def read_netcdf(path: str | Path) -> "Dataset":
    """A NetCDF file as xarray's Dataset, read in a child process.

    Raises:
        ValueError: if it is no such file or a damaged one, takes values from other files, or repeats one that it does
            not store, as HDF5 can.
    """
    import h5netcdf  # noqa: F401  here once, not in each child
    import xarray as xr

    arrays = in_child(lambda: _plain(_opened(path)))
    about = json.loads(str(arrays.pop(ABOUT)))
    parts = {name: (dims, arrays[name], attrs) for name, (dims, attrs) in about["variables"].items()}
    return xr.Dataset(parts, attrs=about["attrs"]).set_coords(about["coordinates"])


def _opened(path: str | Path) -> "Dataset":
    import h5py
    import xarray as xr

    with h5py.File(path) as file:
        claimed = 0
        for name in file:
            if not isinstance(file.get(name, getlink=True), h5py.HardLink):
                raise ValueError(f"{name} is a link")
            found = file[name]
            if not isinstance(found, h5py.Dataset):
                raise ValueError(f"{name} is no array")
            if found.external or found.is_virtual:
                raise ValueError(f"{name} has its values in another file")
            claimed += found.nbytes
    if claimed > PACKED * Path(path).stat().st_size:
        raise ValueError(f"its arrays claim {claimed:,} bytes, more than it can hold")
    with xr.open_dataset(path, engine="h5netcdf") as data:
        return data.load()


def _plain(data: "Dataset") -> dict[str, np.ndarray]:
    """The values of a Dataset, words as numpy's, and ABOUT: all else of it, as JSON."""
    arrays = {str(name): np.asarray(one.values) for name, one in data.variables.items()}
    about = {
        "variables": {name: (one.dims, one.attrs) for name, one in data.variables.items()},
        "coordinates": list(data.coords),
        "attrs": data.attrs,
    }
    words = {name: array.astype(str) for name, array in arrays.items() if array.dtype.kind == "O"}
    return {**arrays, **words, ABOUT: np.array(json.dumps(about, default=lambda value: value.tolist()))}


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
                kind = one.values.dtype.kind
                made = file.create_variable(
                    name,
                    one.dims,
                    h5py.string_dtype() if kind in "UO" else one.values.dtype,
                    fillvalue=np.nan if kind == "f" else None,
                )
                _fill(made, one.values)
                made.attrs.update(one.attrs)
                along = [other for other, it in data.items() if it.is_beside and set(it.dims) <= set(one.dims)]
                if along and name not in coordinates(data):
                    made.attrs["coordinates"] = " ".join(along)
            file.attrs.update(attrs)


def _fill(made: Any, values: np.ndarray | Stack) -> None:
    """Write the values of a variable of a file."""
    if isinstance(values, Stack):
        for number, row in enumerate(values.rows):
            made[number] = row
    else:
        made[...] = values.astype(object) if values.dtype.kind in "UO" else values
