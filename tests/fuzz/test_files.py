"""No input file, however spoilt, gets a traceback, a silent wrong reading, a long wait or much memory."""

import pytest
from fuzz_effort import looks
from fuzz_files import EXAMPLES, KINDS, texts
from fuzz_judge import judge
from fuzz_schema import breaches
from hypothesis import given
from hypothesis import strategies as st

SHARES = {"case": 0.6, "material": 0.2, "program": 0.1, "sweep": 0.1}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with what files name by a relative path."""
    folder = tmp_path_factory.mktemp("fuzz") / "springs"
    folder.mkdir()
    for path in [*EXAMPLES.glob("*.yaml"), *EXAMPLES.glob("springs/*.*")]:
        for place in (folder, folder.parent):
            (place / path.name).write_bytes(path.read_bytes())
    return folder


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
