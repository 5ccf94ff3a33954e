"""Ranks compile the rod's forms together where one of them does not have them."""

import pytest
from mpi4py import MPI

from coilset.model.core.rod import compiled
from coilset.model.core.rod.elements import THESIS


@pytest.mark.parametrize("lacking", [(), (0,), (-1,), (0, -1)])
def test_one_rank_without_forms_has_all_compile(lacking, monkeypatch):
    comm, built, build = MPI.COMM_WORLD, [], compiled._compile
    before = compiled.compiled_forms(comm, THESIS)
    kept = {} if comm.rank in [rank % comm.size for rank in lacking] else {THESIS: before}
    monkeypatch.setattr(compiled, "_kept", kept)
    monkeypatch.setattr(compiled, "_recorded", lambda element: {})
    monkeypatch.setattr(compiled, "_write", lambda *which: None)
    monkeypatch.setattr(compiled, "_compile", lambda *which: built.append(which) or build(*which))
    forms = [compiled.compiled_forms(comm, THESIS) for _ in range(2)]
    assert len(built) == bool(lacking)
    assert (forms[1].residual, forms[1].tangent) == (before.residual, before.tangent)
