"""A file that is written without xarray is what xarray reads, and what it would have written."""

import numpy as np
import xarray as xr

from coilset.model.results.files.netcdf import LabelledData, Variable, write_netcdf


def made():
    """Numbers with a gap, whole numbers, words, and a coordinate that no dimension is named after."""
    gap = np.array([[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]])
    variables = {
        "force": Variable(("end", "step"), gap, {"units": "N", "about": "σ"}),
        "number": Variable(("step",), np.arange(3)),
        "height": Variable((), np.array(7.5), {"units": "mm"}),
    }
    coordinates = {
        "end": Variable(("end",), np.array(["bottom", "tøp"])),
        "turn": Variable(("step",), np.array([0.0, 0.5, 1.0]), {"units": "1"}),
    }
    return LabelledData(variables, coordinates, {"title": "made up"})


def as_xarray(data):
    def parts(variables):
        return {name: (one.dims, one.values, dict(one.attrs)) for name, one in variables.items()}

    return xr.Dataset(parts(data.variables), parts(data.coordinates), dict(data.attrs))


def test_the_file_is_read_as_what_was_written(tmp_path):
    write_netcdf(tmp_path / "ours.nc", made())
    with xr.open_dataset(tmp_path / "ours.nc", engine="h5netcdf") as found:
        xr.testing.assert_identical(found.load(), as_xarray(made()))


def test_the_file_is_coded_as_xarray_codes_it(tmp_path):
    write_netcdf(tmp_path / "ours.nc", made())
    as_xarray(made()).to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf")
    options = {"engine": "h5netcdf", "decode_cf": False}
    with (
        xr.open_dataset(tmp_path / "ours.nc", **options) as ours,
        xr.open_dataset(tmp_path / "theirs.nc", **options) as theirs,
    ):
        xr.testing.assert_identical(ours.load(), theirs.load())


def test_merged_data_have_the_variables_and_coordinates_of_both():
    more = LabelledData(
        {"n": Variable(("k",), np.arange(2))}, {"k": Variable(("k",), np.array(["a", "b"]))}, {"x": "y"}
    )
    both = made().merged(more)
    assert set(both.variables) == {"force", "number", "height", "n"}
    assert set(both.coordinates) == {"end", "turn", "k"}
    assert both.attrs == {"title": "made up"}
