"""A small sweep: a clamped spring of one turn, quick to run; and a process that tests share, as each starts slowly."""

import os
import textwrap

import pytest

from coilset.model.tools.sweep.engines.processes import Workers

CASE = """
    spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 1.5, pitch: 12.0}
    ends: clamped
    mesh: {elements_per_turn: 6, section: {radial: 2, angular: 4}}
    loading:
      - {to: {travel: 6}, steps: 3}
      - {to: {force: 0}, steps: 2}
"""


@pytest.fixture
def write_sweep(tmp_path):
    """Write the case and a sweep file with the given text beside it; returns its path."""

    def write(text, name="small"):
        (tmp_path / "case.yaml").write_text(textwrap.dedent(CASE))
        path = tmp_path / f"{name}.yaml"
        path.write_text("case: case.yaml\n" + textwrap.dedent(text))
        return path

    return write


@pytest.fixture(scope="session")
def workers():
    """One process, for as many sweeps as there are."""
    with Workers(1, dict(os.environ)) as process:
        yield process
