"""A small run, shared by the tests of its page; `browser` lies beside the tests."""

import sys
from pathlib import Path

import pytest
from mpi4py import MPI

from coilset.scripts.commands.solve import solve

sys.path.insert(0, str(Path(__file__).parent))

CASE = """
spring: {wire_diameter: 5, mean_diameter: 40, turns: 2.5, pitch: 12}
material: ck15
loading: [{to: block, steps: 4}, {to: {force: 0}, steps: 2}]
mesh: {elements_per_turn: 8, section: {kind: curved, radial: 2, angular: 8}}
"""


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Results of six steps, to block and back."""
    place = tmp_path_factory.mktemp("run")
    (place / "spring.yaml").write_text(CASE)
    solve(place / "spring.yaml", place / "spring", False, [], comm=MPI.COMM_SELF)
    return place / "spring"
