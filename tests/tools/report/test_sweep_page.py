"""The page of a sweep: every case is in it, with the numbers of its record and the file that makes it."""

import base64
import gzip
import json
import re
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from mpi4py import MPI

from coilset.model.core.case.settings import put
from coilset.model.tools.report.render import packed
from coilset.model.tools.report.sweep_page import write_sweep_report
from coilset.model.tools.report.warning_words import KINDS
from coilset.model.tools.sweep import dataset
from coilset.model.tools.sweep.evaluate import evaluate
from coilset.model.tools.sweep.journal import Journal, read_records
from coilset.model.tools.sweep.plan import Plan

REPOSITORY = Path(__file__).resolve().parents[3]
CASE = {
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.5, "pitch": 12.0},
    "ends": "clamped",
    "mesh": {"elements_per_turn": 6, "section": {"radial": 2, "angular": 4}},
    "loading": [{"to": {"travel": 6}, "steps": 3}, {"to": {"force": 0}, "steps": 2}],
}
VARY = {"spring.wire_diameter": [4.0, 4.5, 5.0], "material": ["ck15", "voce"]}


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "case.yaml").write_text(yaml.safe_dump(CASE))
    (folder / "sweep.yaml").write_text(yaml.safe_dump({"case": "case.yaml", "vary": VARY}, sort_keys=False))
    return Plan(folder / "sweep.yaml")


@pytest.fixture(scope="module")
def folder(plan):
    """Three cases solved, two failed, one missing."""
    out = plan.path.parent / "out"
    out.mkdir()
    with closing(Journal(out / "journal.jsonl")) as journal:
        for number, (row, key) in enumerate(zip(list(plan.rows)[:5], plan.keys, strict=False)):
            record = (
                evaluate(**plan.task(row, key), comm=MPI.COMM_SELF)
                if number < 3
                else {
                    "status": "failed",
                    "reason": "stopped at the time limit",
                    "summary": {},
                    "steps": {},
                    "seconds": 9.0,
                }
            )
            journal.append(record | {"key": key})
    dataset.write(out / "sweep.nc", dataset.collect(plan, out))
    return out


@pytest.fixture(scope="module")
def data(folder):
    page = write_sweep_report(folder).read_text(encoding="utf-8")
    kept = re.search(r'<script type="text/plain" id="data">(.*?)</script>', page).group(1)
    return json.loads(gzip.decompress(base64.b64decode(kept)))


@pytest.mark.parametrize("shape", [(2, 3), (6,), (40,)])
def test_a_page_holds_no_number_that_json_has_not(shape):
    """Characteristics that are shorter than the longest end with NaN: None in text, its bits in a long array."""
    values = np.ones(shape)
    values[..., -1] = np.nan
    kept = packed({"curve": values, "height": np.float64("inf")})
    json.dumps(kept, allow_nan=False)
    assert kept["height"] is None
    if values.size < 24:
        assert kept["curve"] == np.where(np.isnan(values), None, values).tolist()
    else:
        bits = np.frombuffer(base64.b64decode(kept["curve"]["f4"]), "<f4")
        assert np.array_equal(bits, values.ravel(), equal_nan=True)


def test_every_case_has_the_numbers_of_its_record(folder, data):
    columns = {column["name"]: column for column in data["columns"]}
    assert columns["status"]["values"] == ["done"] * 3 + ["failed"] * 2 + ["missing"]
    assert columns["reason"]["values"][3] == "stopped at the time limit"
    for row, record in enumerate(read_records(folder / "journal.jsonl")):
        for name, value in record["summary"].items():
            if isinstance(value, float):
                assert columns[name]["values"][row] == value
    assert columns["spring.wire_diameter"]["unit"] == "mm"
    assert [column["name"] for column in data["columns"][:3]] == ["case", *VARY]


def test_the_file_of_a_case_is_that_of_the_plan(plan, data):
    """As the page puts it together: the base case, with the case's inputs at their entries."""
    columns, files = {column["name"]: column["values"] for column in data["columns"]}, data["files"]
    for row in range(len(plan)):
        case = json.loads(json.dumps(files["base"]))
        for name, entries in files["entries"].items():
            value = columns[name][row]
            for entry in entries:
                put(case, entry, files["choices"].get(name, {}).get(value, value), "")
        assert case == plan.data(plan.rows[row])


def test_warnings_are_counted_in_words(folder):
    """No internal name: every kind of warning that the program gives has its words."""
    path = folder / "sweep.nc"
    before = path.read_bytes()
    data = xr.load_dataset(path, engine="h5netcdf")
    data["warnings"] = ("case", np.array(["estimate"] * 5 + ["estimate, unknown error"], dtype=object))
    dataset.write(path, data)
    try:
        page = write_sweep_report(folder).read_text(encoding="utf-8")
    finally:
        path.write_bytes(before)
    assert "the hardening of the wire is an estimate from its tensile strength (in all 6 cases)" in page
    assert "the error of the steps could not be estimated (in 1 of 6 cases)" in page
    assert "estimate:" not in page
    sources = [path.read_text(encoding="utf-8") for path in (REPOSITORY / "model").rglob("*.py")]
    kinds = {kind for text in sources for kind in re.findall(r'Warning\(\s*"([a-z -]+)"', text)}
    assert len(kinds) > 20
    assert kinds <= KINDS.keys()


def test_limits_have_their_table_and_histogram(tmp_path):
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(CASE | {"limits": {"set_mm": [0.0, 2.0]}}))
    vary = {"spring.pitch": {"from": 11.0, "to": 13.0, "count": 40}}
    (tmp_path / "sweep.yaml").write_text(yaml.safe_dump({"case": "case.yaml", "vary": vary}))
    plan = Plan(tmp_path / "sweep.yaml")
    with closing(Journal(tmp_path / "journal.jsonl")) as journal:
        for number, key in enumerate(plan.keys):
            record = {"status": "done", "reason": "", "summary": {"set_mm": 1.0 + 0.03 * number}, "steps": {}}
            journal.append(record | {"key": key, "seconds": 1.0})
    dataset.write(tmp_path / "sweep.nc", dataset.collect(plan, tmp_path))
    page = write_sweep_report(tmp_path).read_text(encoding="utf-8")
    table = re.search(r'aria-label="limits and capability">.*?</table>', page, re.DOTALL).group()
    assert "<td>15 % " in table  # 6 of 40
    assert "tighten pitch (100" in table
    assert '"limits_set_mm"' in page  # its histogram
    assert 'id="table"' in page  # saves the cases


def test_a_sample_states_the_number_of_all_cases(plan, folder, tmp_path):
    dataset.write(tmp_path / "sweep.nc", dataset.collect(plan, folder, most=2))
    page = write_sweep_report(tmp_path).read_text(encoding="utf-8")
    assert "A sample of 2 of the 6 cases, evenly spread over the plan" in page
    assert "Cases of a sample" in page
    kept = re.search(r'<script type="text/plain" id="data">(.*?)</script>', page).group(1)
    assert json.loads(gzip.decompress(base64.b64decode(kept)))["columns"][0]["values"] == [1, 4]


def test_an_entry_of_a_table_is_named_by_its_turn(tmp_path):
    spring = CASE["spring"] | {"pitch": {"turns": [0, 0.7, 1.5], "values": [9, 9, 12], "interpolation": "linear"}}
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(CASE | {"spring": spring}))
    vary = {"spring.pitch.values.2": [11.0, 12.0], "loading.0.to.travel": [1.0, 2.0], "spring.pitch.values.1": [9.5]}
    (tmp_path / "sweep.yaml").write_text(yaml.safe_dump({"case": "case.yaml", "vary": vary}))
    data = dataset.collect(Plan(tmp_path / "sweep.yaml"), tmp_path / "none.jsonl")
    named = {name: (data[name].attrs["long_name"], data[name].attrs["units"]) for name in vary}
    assert named == {
        "spring.pitch.values.2": ("pitch at turn 1.5", "mm"),
        "loading.0.to.travel": ("travel of phase 1", "mm"),
        "spring.pitch.values.1": ("pitch at turn 0.7", "mm"),
    }
