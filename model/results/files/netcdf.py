"""Labelled arrays and their NetCDF file, without the libraries for reading such files, which are slow to load."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
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
    """

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class LabelledData:
    """Like `xarray.Dataset`: variables, coordinates along their dimensions, and attributes."""

    variables: Mapping[str, Variable]
    coordinates: Mapping[str, Variable]
    attrs: Mapping[str, str] = field(default_factory=dict)

    def merged(self, other: "LabelledData") -> "LabelledData":
        """A copy with the variables and coordinates of another one added."""
        return replace(
            self, variables={**self.variables, **other.variables}, coordinates={**self.coordinates, **other.coordinates}
        )

    def all(self) -> Iterator[tuple[str, Variable]]:
        """Names and variables, the coordinates last."""
        yield from self.variables.items()
        yield from self.coordinates.items()

    def beside(self, name: str) -> str:
        """Names of a variable's auxiliary coordinates, in the text form of the CF conventions."""
        dims = set(self.variables[name].dims)
        return " ".join(
            one
            for one, coordinate in self.coordinates.items()
            if coordinate.dims != (one,) and dims.issuperset(coordinate.dims)
        )


def reserve(path: Path, size: int) -> None:
    """Make sure that the disk has room for a file of `size` bytes of numbers; the NetCDF library crashes otherwise.

    Raises:
        OSError: if it does not.
    """
    if hasattr(os, "posix_fallocate"):
        with open(path, "wb") as file:
            os.posix_fallocate(file.fileno(), 0, size + HEADER)


def write_netcdf(target: str | Path, data: LabelledData) -> None:
    """Write a NetCDF 4 file by the conventions of CF, which xarray follows too.

    Raises:
        CoilsetError: if it cannot be written.
    """
    import h5netcdf
    import h5py

    with whole(target) as path:
        reserve(path, sum(one.values.nbytes for _, one in data.all()))
        with h5netcdf.File(path, "w") as file:
            for _, one in data.all():
                for dim, size in zip(one.dims, one.values.shape, strict=True):
                    if dim not in file.dimensions:
                        file.dimensions[dim] = size
            # Coordinates first: they replace the places held for their dimensions, also in what has these already.
            for name, one in sorted(data.all(), key=lambda each: each[1].dims != (each[0],)):
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
                if name in data.variables and (beside := data.beside(name)):
                    made.attrs["coordinates"] = beside
            file.attrs.update(data.attrs)
