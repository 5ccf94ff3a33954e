"""Ranks compile the rod's forms together where one of them does not have them."""

import pytest
from mpi4py import MPI

from coilset.model.rod import compiled


@pytest.mark.parametrize("lacking", [(), (0,), (-1,), (0, -1)])
def test_one_rank_without_forms_has_all_compile(lacking, monkeypatch):
    comm, built, build = MPI.COMM_WORLD, [], compiled._compile
    before = compiled.compiled_forms(comm)
    kept = [] if comm.rank in [rank % comm.size for rank in lacking] else [before]
    monkeypatch.setattr(compiled, "_kept", kept)
    monkeypatch.setattr(compiled, "_recorded", list)
    monkeypatch.setattr(compiled, "_write", lambda forms: None)
    monkeypatch.setattr(compiled, "_compile", lambda comm: built.append(comm) or build(comm))
    forms = [compiled.compiled_forms(comm) for _ in range(2)]
    assert len(built) == bool(lacking)
    assert (forms[1].residual, forms[1].tangent) == (before.residual, before.tangent)
