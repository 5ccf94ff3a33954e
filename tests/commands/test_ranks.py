"""Checkpoints and written files on 1, 2 and 3 ranks: begun on some, ended on others, compared with one."""

import csv
import json
import logging
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from mpi4py import MPI

from coilset.model.tools.further_runs.error_estimates import BALANCE
from coilset.scripts.commands.solve import solve

pytestmark = pytest.mark.mpi
COMM = MPI.COMM_WORLD
AGREEMENT = 1e-10
RADIUS = 20.0  # of the coils, mm
WHOLES = "history force_N", "history seat_height_mm", "summary residual_shear_max_MPa"
# The tolerance of the solve is tightened, as it bounds the agreement; to block with coils in contact, and back.
SETTINGS = ["mesh.elements_per_turn=10", "mesh.section.angular=6", "solver.tolerance=1e-11"]
DOWN, UP = "{to: block, steps: 6}", "{to: {force: 0}, steps: 3}"


@pytest.fixture(autouse=True)
def _close_logs():
    yield
    logger = logging.getLogger("coilset")
    for handler in list(logger.handlers):
        logger.removeHandler(handler)
        handler.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One folder for all ranks."""
    return Path(COMM.bcast(str(tmp_path_factory.mktemp("ranks")) if COMM.rank == 0 else None))


def run(example, out, ranks, phases, resume=False):
    """`coilset solve` on the first `ranks` ranks; all wait for its end."""
    part = COMM.Split(0 if COMM.rank < ranks else 1, COMM.rank)
    if COMM.rank < ranks:
        solve(example, out, False, [*SETTINGS, f"loading=[{', '.join(phases)}]"], resume=resume, comm=part)
    part.Free()
    COMM.barrier()


def numbers(out):
    """Every number in history.csv, summary.json and points.nc by name."""
    with open(out / "history.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = {f"history {name}": np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}
    summary = json.loads((out / "summary.json").read_text())
    found |= {f"summary {name}": np.array(value) for name, value in summary.items() if isinstance(value, float)}
    with xr.open_dataset(out / "points.nc", engine="h5netcdf") as data:
        found |= {name: values.values for name, values in data.variables.items() if values.dtype.kind == "f"}
    return found


@pytest.fixture(scope="module")
def alone(example, folder):
    """What one rank finds without a stop."""
    run(example, folder / "alone", 1, [DOWN, UP])
    return numbers(folder / "alone")


@pytest.mark.parametrize(
    ("begun", "ended"),
    sorted({(COMM.size, 1), (1, COMM.size), (COMM.size, COMM.size)}),
)
def test_begun_and_ended_on_any_ranks(example, folder, alone, begun, ended):
    """All files agree to 1e-10 of the largest magnitude of each quantity; what is counted agrees exactly.

    An estimated error is a difference of forces, heights or stresses to those of a companion balanced to BALANCE,
    and the torque on a free seat one of the moments F R of its contacts: these agree to that, and to 1e-10, of what
    they are differences of.
    """
    out = folder / f"{begun} {ended}"
    run(example, out, begun, [DOWN])
    run(example, out, ended, [DOWN, UP], resume=True)
    found = numbers(out)
    assert found.keys() == alone.keys()
    assert alone["history contacts"].max() > 2
    for name, expected in alone.items():
        size, agreement = np.nanmax(np.abs(expected), initial=0.0), AGREEMENT
        if "estimated" in name or "error" in name:
            unit, agreement = name.rpartition("_")[2], BALANCE
            size = max([size, *(np.nanmax(np.abs(alone[whole])) for whole in WHOLES if whole.endswith(f"_{unit}"))])
        elif "torque" in name:
            size = max(size, RADIUS * np.abs(alone["history force_N"]).max())
        np.testing.assert_allclose(found[name], expected, rtol=0, atol=agreement * size, err_msg=name)
    for name in ("history number", "history contacts", "history cuts"):
        np.testing.assert_array_equal(found[name], alone[name])
