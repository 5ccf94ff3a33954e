"""Readers in a child process: arrays come back as they are, reasons in a line, and a crash ends the child only."""

import os
import signal

import numpy as np
import pytest
import xarray as xr

from coilset.model.core.base.errors import InputError
from coilset.model.core.results.files.child import in_child
from coilset.model.core.results.files.netcdf import read_netcdf
from coilset.model.core.results.files.opened import open_run


def crash(number):
    def read():
        os.kill(os.getpid(), number)
        signal.pause()

    return read


def refused():
    raise ValueError("no force in it\nof two lines")


def test_arrays_come_back_to_the_bit():
    made = {"x": np.array([[1 / 3, np.nan]]), "name": np.array(["tøp"]), "count": np.arange(3), "one": np.array(2.5)}
    found = in_child(lambda: made)
    assert found.keys() == made.keys()
    for name, array in made.items():
        assert found[name].dtype == array.dtype
        np.testing.assert_array_equal(found[name], array)


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL])
def test_a_crash_is_an_error(number):
    with pytest.raises(ValueError, match="damaged: the library that reads such files crashes"):
        in_child(crash(number))


def test_the_reason_of_an_error_comes_back():
    with pytest.raises(ValueError, match=r"^no force in it$"):
        in_child(refused)


def test_no_child_is_left_after_an_interrupt():
    """Ctrl-C while the child is within a library."""

    def interrupt(*_about):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(KeyboardInterrupt):
            in_child(signal.pause)
    finally:
        signal.signal(signal.SIGALRM, before)
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


def test_a_data_set_is_what_xarray_reads(tmp_path):
    data = xr.Dataset(
        {"force": (("end", "step"), np.array([[1.0, np.nan], [2.0, 3.0]]), {"units": "N", "about": "σ"})},
        {"end": ["bottom", "tøp"], "turn": ("step", [0.0, 0.5], {"units": "1"}), "height": 7.5},
        {"title": "made up", "count": 3},
    )
    data.to_netcdf(tmp_path / "data.nc", engine="h5netcdf")
    xr.testing.assert_identical(read_netcdf(tmp_path / "data.nc"), data)


@pytest.mark.parametrize("seed", range(3))
def test_a_file_whose_tables_are_overwritten_is_refused_in_a_line(tmp_path, seed):
    """Bytes of the attributes' values, where HDF5 keeps sizes that it does not check."""
    for name in ("summary.json", "history.csv", "seats.csv"):
        (tmp_path / name).write_text("{}" if name == "summary.json" else "step,force_N\n1,2\n")
    parts = {f"x{n}": ("step", np.arange(4.0), {"units": f"a unit of {n}"}) for n in range(20)}
    xr.Dataset(parts).to_netcdf(tmp_path / "points.nc", engine="h5netcdf")
    content = bytearray((tmp_path / "points.nc").read_bytes())
    heap = content.index(b"GCOL") + 16
    content[heap : heap + 256] = np.random.default_rng(seed).bytes(256)
    (tmp_path / "points.nc").write_bytes(content)
    with pytest.raises(InputError, match=r"^[^\n]*points\.nc: is not readable: [^\n]*$"):
        open_run(tmp_path)
