"""The journal: what is written stays, what is torn does not count, and nobody else writes to it."""

import json

import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.tools.sweep.journal import Journal, read_records, whole_length


def record(key):
    return {"key": key, "status": "done", "summary": {"text": "é" * 50}}


def test_torn_line_is_cut_off_and_what_follows_is_whole(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Journal(path)
    for key in "ab":
        journal.append(record(key))
    journal.close()
    whole = path.read_bytes()
    torn = json.dumps(record("c")).encode()
    for length in (1, len(torn) // 2, len(torn)):
        path.write_bytes(whole + torn[:length])
        assert [entry["key"] for entry in read_records(path)] == ["a", "b"]
        journal = Journal(path)
        journal.append(record("d"))
        journal.close()
        assert [entry["key"] for entry in read_records(path)] == ["a", "b", "d"]


@pytest.mark.parametrize("size", [0, 10, 65536, 200_000])
def test_whole_length_finds_the_last_line_at_any_distance(tmp_path, size):
    path = tmp_path / "file"
    path.write_bytes(b"first\n" + size * b"x")
    assert whole_length(path) == 6
    path.write_bytes(size * b"x")
    assert whole_length(path) == 0


def test_second_writer_is_refused(tmp_path):
    journal = Journal(tmp_path / "journal.jsonl")
    with pytest.raises(InputError, match="another sweep is writing"):
        Journal(tmp_path / "journal.jsonl")
    journal.close()
    Journal(tmp_path / "journal.jsonl").close()


def test_foreign_line_is_named(tmp_path):
    path = tmp_path / "journal.jsonl"
    path.write_text(json.dumps(record("a")) + "\nnonsense\n")
    with pytest.raises(InputError, match="line 2"):
        list(read_records(path))


def test_no_journal_has_no_records(tmp_path):
    assert list(read_records(tmp_path / "none")) == []
