"""No input file, however spoilt, gets a traceback, a silent wrong reading, a long wait or much memory."""

import pytest
from fuzz_effort import looks
from fuzz_files import EXAMPLES, KINDS, texts
from fuzz_judge import judge
from fuzz_results import CASE, spoilt_folder
from fuzz_schema import breaches
from fuzz_tables import TABLES, table_texts
from hypothesis import given
from hypothesis import strategies as st
from mpi4py import MPI

from coilset.scripts.commands.report import report
from coilset.scripts.commands.solve import solve

SHARES = {"case": 0.4, "material": 0.13, "program": 0.04, "sweep": 0.08, "design": 0.08, "nest": 0.02}
SHARES |= {"measured": 0.06, "test": 0.04, "press": 0.02, "compare": 0.02, "relaxation": 0.02, "motion": 0.01}
SHARES |= {"journal": 0.01, "results": 0.06, "page": 0.01}
OF_RESULTS = ("results", "page")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with what files name by a relative path."""
    folder = tmp_path_factory.mktemp("fuzz") / "springs"
    folder.mkdir()
    for path in [*EXAMPLES.glob("*.yaml"), *EXAMPLES.glob("springs/*.*"), *EXAMPLES.glob("nested/nested_*.yaml")]:
        for place in (folder, folder.parent):
            (place / path.name).write_bytes(path.read_bytes())
    (folder.parent / "sheet").mkdir()
    (folder.parent / "sheet" / "valve.yaml").write_bytes((EXAMPLES / "sheet" / "valve.yaml").read_bytes())
    return folder


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A results folder, with the case. A page is made once, as plotly changes Python's limit of recursion."""
    folder = tmp_path_factory.mktemp("results")
    (folder / "case.yaml").write_text(CASE)
    solve(folder / "case.yaml", folder, False, [], comm=MPI.COMM_SELF, voice="quiet")
    report(folder)
    (folder / "report.html").unlink()
    return folder


def test_all_files_have_their_share():
    assert {*SHARES} == {*KINDS, *TABLES, *OF_RESULTS}
    assert abs(sum(SHARES.values()) - 1.0) < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_spoilt_files(folder, kind):
    path = folder / f"spoilt-{kind}.yaml"

    @looks(SHARES[kind])
    @given(st.data())
    def spoil(data):
        text = data.draw(texts(kind))
        path.write_text(text, encoding="utf-8")
        judge(kind, str(path), text)

    spoil()


@pytest.mark.parametrize("kind", TABLES)
def test_spoilt_tables(tmp_path, kind):
    path = tmp_path / "spoilt.csv"

    @looks(SHARES[kind])
    @given(table_texts(kind))
    def spoil(content):
        path.write_bytes(content)
        judge(kind, str(path))

    spoil()


@pytest.mark.parametrize("kind", OF_RESULTS)
def test_spoilt_results(results, tmp_path, kind):
    @looks(SHARES[kind])
    @given(st.data())
    def spoil(data):
        judge(kind, str(data.draw(spoilt_folder(results, tmp_path / "spoilt"))))

    spoil()


def test_the_reader_of_schemas_sees_breaches():
    """Else the fuzzer would take all for right."""
    schema = {
        "type": "object",
        "required": ["a"],
        "additionalProperties": False,
        "properties": {
            "a": {"anyOf": [{"type": "integer", "exclusiveMinimum": 0}, {"const": "auto"}]},
            "b": {"$ref": "#/$defs/b"},
            "c": {"type": "number", "exclusiveMaximum": 0.5},
        },
    }
    defs = {"b": {"type": "array", "items": {"type": "number", "maximum": 2}, "minItems": 1}}
    for right in ({"a": 1}, {"a": "auto"}, {"a": 3.0, "b": [2, 1.5]}, {"a": 1, "c": 0}):
        assert breaches(right, schema, defs) == []
    for wrong in (
        {},
        {"a": 0},
        {"a": True},
        {"a": "x"},
        {"a": 1, "c": 1},
        {"a": 1, "d": 1},
        {"a": 1, "b": []},
        {"a": 1, "b": [3]},
        {"a": 1, "b": [float("nan")]},
    ):
        assert breaches(wrong, schema, defs) != []
