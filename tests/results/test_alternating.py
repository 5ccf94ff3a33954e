"""A file of which two take turns is complete at any moment."""

import pytest

from coilset.model.base.errors import CoilsetError
from coilset.model.results.files import alternating
from coilset.model.results.files.alternating import TwoFiles


class Half(Exception):
    """Ends what is being written."""


def write_half(file):
    with file.next() as next_one:
        next_one.write(b"half of the next")
        next_one.flush()
        raise Half


@pytest.mark.parametrize("exchange", [alternating._exchange, lambda one, other: False])
def test_what_is_written_in_turns_is_always_complete(tmp_path, monkeypatch, exchange):
    """Also if it becomes shorter, ends half way, or the file system cannot exchange names."""
    monkeypatch.setattr(alternating, "_exchange", exchange)
    file = TwoFiles(tmp_path / "state.npz")
    for content in (b"first", b"a longer second", b"3", b"the longest of all", b"fifth"):
        with file.next() as next_one:
            next_one.write(content)
        assert file.path.read_bytes() == content
        with pytest.raises(Half):
            write_half(file)
        assert file.path.read_bytes() == content
    file.over()
    assert list(tmp_path.iterdir()) == [file.path]


def test_what_cannot_be_written_is_said(tmp_path):
    with pytest.raises(CoilsetError, match=r"state\.npz: cannot be written: No such file"):
        write_half(TwoFiles(tmp_path / "missing" / "state.npz"))


def test_files_change_names_where_the_system_can(tmp_path):
    """It is not only the fallback that was tested."""
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_text("one")
    other.write_text("other")
    if not alternating._exchange(one, other):
        pytest.skip("this file system cannot exchange names")
    assert (one.read_text(), other.read_text()) == ("other", "one")
