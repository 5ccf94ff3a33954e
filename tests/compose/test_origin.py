"""Results stand by themselves: the case in them runs again, and gives the same."""

import json

import numpy as np
import pytest
import xarray as xr
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.version import __version__
from coilset.model.core.case import check, read_case
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.results.records.provenance import origin
from coilset.scripts.commands.solve import solve

PROGRAM = "loading=[{to: {travel: 3}, steps: 2}]"
COARSE = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "accuracy=none", PROGRAM]


@pytest.fixture(scope="module")
def folder(example, tmp_path_factory):
    out = tmp_path_factory.mktemp("run") / "out"
    solve(example, out, False, COARSE, comm=MPI.COMM_SELF)
    return out


def test_the_case_in_a_summary_runs_again(folder, ck15):
    summary = json.loads((folder / "summary.json").read_text())
    again = Analysis(check(summary["origin"]["case"]), MPI.COMM_SELF)
    found = summarise(again.setup, again.run())
    found = json.loads(json.dumps(found))
    assert found == {name: value for name, value in summary.items() if name != "origin"}
    assert MaterialFile.model_validate(summary["origin"]["material"]) == ck15.data


def test_points_hold_the_same(folder):
    summary = json.loads((folder / "summary.json").read_text())
    made_with, warnings = summary["origin"], summary["warnings"]
    with xr.open_dataset(folder / "points.nc", engine="h5netcdf") as data:
        assert json.loads(data.attrs["case"]) == made_with["case"]
        assert json.loads(data.attrs["material_file"]) == made_with["material"]
        assert {name: data.attrs[name] for name in ("date", "platform", "versions")}.items() <= made_with.items()
        found = json.loads(data.attrs["warnings"])
    assert found
    assert found == warnings
    assert __version__ in made_with["versions"]
    assert np.datetime64(made_with["date"].removesuffix("+00:00")) > np.datetime64("2020-01-01")


def test_the_file_of_a_measured_spring_is_identified_by_its_content(example):
    made_with = origin(read_case(example.parent / "springs" / "measured.yaml"))
    assert set(made_with["contents"]) == {"material", "spring.file"}
