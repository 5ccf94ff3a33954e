"""What the rod's forms were compiled into is found again, as long as they would be compiled into the same."""

import json

import pytest
import ufl
from mpi4py import MPI

from coilset.model.core.rod import compiled
from coilset.model.core.rod.elements import MIXED, THESIS


@pytest.fixture
def record(tmp_path, monkeypatch):
    """A place for the record of this test, and how often the forms were built."""
    built, build = [], compiled._compile
    monkeypatch.setattr(compiled, "_record", lambda element: tmp_path / "forms.json")
    monkeypatch.setattr(compiled, "_compile", lambda *which: built.append(which) or build(*which))
    yield tmp_path / "forms.json", built
    compiled._kept.clear()


def forms_of_a_new_process():
    compiled._kept.clear()
    return compiled.compiled_forms(MPI.COMM_SELF, THESIS)


def test_forms_are_built_once(record):
    first, again = forms_of_a_new_process(), forms_of_a_new_process()
    assert len(record[1]) == 1
    assert (again.residual, again.tangent) == (first.residual, first.tangent)
    assert first.residual.fields == ("xi", "timoshenko_factor", "l", "E", "T", "s")


@pytest.mark.parametrize("damage", ["", "{", "[]", '[{"fields": []}, {}]', "gone"])
def test_a_record_of_no_use_is_written_anew(record, damage):
    file, built = record
    first = forms_of_a_new_process()
    if damage == "gone":  # the compiled loop is
        damage = file.read_text().replace("coilset_elements_", "no_elements_")
    file.write_text(damage)
    again = forms_of_a_new_process()
    assert len(built) == 2
    assert again.tangent == first.tangent
    assert json.loads(file.read_text())[0] == {"module": first.residual.module, "fields": list(first.residual.fields)}


def test_another_version_or_source_or_processor_has_another_record(monkeypatch, tmp_path):
    names = {compiled._record(THESIS)}
    with monkeypatch.context() as change:
        change.setattr(ufl, "__version__", "of tomorrow")
        names.add(compiled._record(THESIS))
    with monkeypatch.context() as change:
        change.setattr(compiled, "PROCESSOR", "another one")
        names.add(compiled._record(THESIS))
    source = tmp_path / "forms.py"
    source.write_text(compiled.SOURCES[1].read_text() + "# and more\n")
    monkeypatch.setattr(compiled, "SOURCES", (compiled.SOURCES[0], source, *compiled.SOURCES[2:]))
    assert len({*names, compiled._record(THESIS), compiled._record(MIXED)}) == 5
