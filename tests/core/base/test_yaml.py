"""The reader of YAML: one reading of words and numbers, and one line for every text that cannot be read."""

import time

import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.base.yaml import load_yaml, read_data


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e6", 1e6),
        ("1.0E-6", 1e-6),
        ("-.5", -0.5),
        ("+12", 12),
        ("010", 10),
        ("0x1F", 31),
        ("0o17", 15),
        ("3.", 3.0),
        ("0b11", "0b11"),
        ("-.inf", float("-inf")),
        ("1e5x", "1e5x"),
        ("{null: 1, 5: 2}", {"null": 1, "5": 2}),
        ("true", True),
        ("FALSE", False),
        ("yes", "yes"),
        ("on", "on"),
        ("12:30:00", "12:30:00"),
        ("1_000", "1_000"),
        ("2001-12-14", "2001-12-14"),
        ("~", None),
        ("", None),
        ("'5'", "5"),
        ("!!str 5", "5"),
        ("!!float 5", 5.0),
    ],
)
def test_words_and_numbers_are_those_of_yaml_1_2(text, value):
    found = load_yaml(text)
    assert found == value
    assert type(found) is type(value)


def test_what_an_alias_repeats_is_data_of_its_own():
    data = load_yaml("a: &one {steps: 3}\nb: *one\n")
    data["a"]["steps"] = 5
    assert data["b"] == {"steps": 3}


BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" for k in range(1, 30)
)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: 2\na: 3", "line 3, column 1: not readable as YAML: the entry 'a' is given twice"),
        ("a: {b: {c: 1, c: 2}}", "line 1, column 15: not readable as YAML: the entry 'c' is given twice"),
        ("a: " + "{b: " * 1500 + "}" * 1500, "nested deeper than 40 levels"),
        ("a: " + "[" * 1500, "nested deeper than 40 levels"),
        (BOMB, "more than 1,000,000 values; are aliases repeated by aliases?"),
        ("&a [*a]", "does an alias refer to what contains it?"),
        ("a: *b", "line 1, column 4: not readable as YAML: found undefined alias 'b'"),
        ("a: b\0c", "not readable as YAML"),
        ("a:\n\tb: 1", "line 2, column 1: not readable as YAML: there is a tab at the start; indent with spaces"),
        ('a: "b\\0c"', "line 1, column 4: not readable as YAML: there is a character in this text that is none"),
        ('a: "\\uD800"', "there is a character in this text that is none"),
        ("a: !!python/object/apply:os.system ['true']", "the tag tag:yaml.org,2002:python/object/apply:os.system is"),
        ("a: !!int five", "'five' cannot be read as the number"),
        ("? [1, 2]\n: 3", "an entry's name must be a word"),
        ("a: 1\n---\nb: 2", "expected a single document in the stream, but found another document"),
        ("a: " + "9" * 5000, "cannot be read as the number"),
    ],
    ids=lambda text: text[:20] if isinstance(text, str) else "",
)
def test_what_cannot_be_read_gets_one_short_line(text, words):
    began = time.process_time()
    with pytest.raises(InputError) as caught:
        load_yaml(text, "case.yaml")
    assert words in str(caught.value)
    assert str(caught.value).startswith("case.yaml: ")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300
    assert time.process_time() - began < 20.0  # the bomb had no end


@pytest.mark.parametrize(("content", "words"), [(b"\xff\xfe\x00", "not a text file"), (b"- 1", "must hold entries")])
def test_files_without_entries_are_refused(tmp_path, content, words):
    (tmp_path / "x.yaml").write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_data(tmp_path / "x.yaml")
    with pytest.raises(InputError, match="the name of the file is empty"):
        read_data("")
    with pytest.raises(InputError, match="No such file"):
        read_data(tmp_path / "none.yaml")
