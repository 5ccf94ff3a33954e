"""Results with labels and units, as `coilset.open` gives them."""

import json

import pytest
from mpi4py import MPI

import coilset.open
from coilset.model.core.base.errors import InputError
from coilset.model.core.results.files.opened import table
from coilset.scripts.commands.solve import solve

CASE = """
spring: {wire_diameter: 5, mean_diameter: 40, turns: 1.5, pitch: 12}
ends: clamped
accuracy: none
loading: [{to: {travel: 4}, steps: 2}, {to: {force: 0}, steps: 1}]
mesh: {elements_per_turn: 6, section: {radial: 2, angular: 4}}
"""


def test_a_run_comes_with_its_numbers_and_units(tmp_path):
    (tmp_path / "spring.yaml").write_text(CASE)
    solve(tmp_path / "spring.yaml", tmp_path / "out", False, [], comm=MPI.COMM_SELF)
    data = coilset.open(tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert float(data["summary_set_mm"]) == summary["set_mm"]
    assert data["travel_mm"].sel(step=2).item() == pytest.approx(4.0, rel=1e-12)
    assert data["step_position"].dims == ("step", "station", "axis")
    units = {name: data[name].attrs["units"] for name in ("travel_mm", "force_N", "summary_rate_N_per_mm", "surface")}
    assert units == {"travel_mm": "mm", "force_N": "N", "summary_rate_N_per_mm": "N/mm", "surface": "MPa"}
    assert json.loads(data.attrs["case"])["spring"]["wire_diameter"] == 5.0
    with pytest.raises(InputError, match="no results of a run"):
        coilset.open(tmp_path)


def test_a_table_that_a_spreadsheet_saved_is_the_same(tmp_path):
    rows = "step,travel_mm,force_N,torque_Nmm\n1,2.5,80.25,\n2,-5e-07,0.125,nan\n"
    (tmp_path / "history.csv").write_text(rows)
    (tmp_path / "saved.csv").write_bytes(b"\xef\xbb\xbf" + rows.replace(",", ";").replace(".", ",").encode())
    first, second = (table(tmp_path / name) for name in ("history.csv", "saved.csv"))
    assert first.identical(second)
    assert first["travel_mm"].values.tolist() == [2.5, -5e-7]
    assert first["torque_Nmm"].isnull().all()
    assert first["step"].values.tolist() == [1, 2]
