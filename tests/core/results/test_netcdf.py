"""A file that is written without xarray is what xarray reads, and what it would have written."""

import numpy as np
import xarray as xr

from coilset.model.core.results.files.netcdf import Variable, coordinates, write_netcdf

ATTRS = {"title": "made up"}


def made():
    """Numbers with a gap, whole numbers, words, and a coordinate that no dimension is named after."""
    gap = np.array([[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]])
    return {
        "force": Variable(("end", "step"), gap, {"units": "N", "about": "σ"}),
        "number": Variable(("step",), np.arange(3)),
        "height": Variable((), np.array(7.5), {"units": "mm"}),
        "end": Variable(("end",), np.array(["bottom", "tøp"])),
        "turn": Variable(("step",), np.array([0.0, 0.5, 1.0]), {"units": "1"}, is_beside=True),
    }


def as_xarray(data):
    parts = {name: (one.dims, one.values, dict(one.attrs)) for name, one in data.items()}
    return xr.Dataset(parts, attrs=ATTRS).set_coords(coordinates(data))


def test_the_file_is_read_as_what_was_written(tmp_path):
    write_netcdf(tmp_path / "ours.nc", made(), ATTRS)
    with xr.open_dataset(tmp_path / "ours.nc", engine="h5netcdf") as found:
        xr.testing.assert_identical(found.load(), as_xarray(made()))


def test_the_file_is_coded_as_xarray_codes_it(tmp_path):
    write_netcdf(tmp_path / "ours.nc", made(), ATTRS)
    as_xarray(made()).to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf")
    options = {"engine": "h5netcdf", "decode_cf": False}
    with (
        xr.open_dataset(tmp_path / "ours.nc", **options) as ours,
        xr.open_dataset(tmp_path / "theirs.nc", **options) as theirs,
    ):
        xr.testing.assert_identical(ours.load(), theirs.load())
