"""The notebook of docs/ makes each of its figures from the data of a run."""

import os
from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).resolve().parents[2] / "docs/notebook/figures.ipynb"
CASE = """
spring: {wire_diameter: 5, mean_diameter: 40, turns: 2.5, pitch: 12}
material: ck15
loading: [{to: block, steps: 4}, {to: {force: 0}, steps: 3}]
mesh: {elements_per_turn: 8, section: {radial: 2, angular: 6}}
"""


def test_every_cell_runs_and_every_figure_is_drawn(tmp_path, monkeypatch):
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    from mpi4py import MPI

    from coilset.scripts.commands.solve import solve

    (tmp_path / "spring.yaml").write_text(CASE)
    solve(tmp_path / "spring.yaml", tmp_path / "run", False, [], comm=MPI.COMM_SELF)
    monkeypatch.setenv("COILSET_RUN", str(tmp_path / "run"))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    book = nbformat.read(NOTEBOOK, as_version=4)
    assert not any(cell.get("outputs") for cell in book.cells)  # what is kept is the source alone
    nbclient.NotebookClient(book, timeout=120, resources={"metadata": {"path": str(tmp_path)}}).execute(env=os.environ)
    outputs = [output for cell in book.cells if cell.cell_type == "code" for output in cell.outputs]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 8
    assert any("xarray.Run" in output.get("data", {}).get("text/plain", "") for output in outputs)
