"""The digest of the program's content, and the commit of a checkout."""

import shutil
import subprocess

import pytest

from coilset.model.core.base import content
from coilset.model.core.base.version import versions


@pytest.fixture
def checkout(tmp_path):
    """A small program in a repository of git."""
    if not shutil.which("git"):
        pytest.skip("there is no git")
    (tmp_path / "model").mkdir()
    (tmp_path / "model" / "law.py").write_text("E = 206000\n")
    for words in (["init", "-q"], ["add", "-A"], ["-c", "user.name=x", "-c", "user.email=x@x", "commit", "-qm", "x"]):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    return tmp_path


def git(folder, *words):
    return subprocess.run(["git", *words], cwd=folder, capture_output=True, text=True, check=True).stdout.strip()


def test_a_changed_file_changes_the_digest_and_not_the_commit(checkout):
    before, at = content.digest.__wrapped__(checkout), content.commit(checkout)
    assert at == git(checkout, "rev-parse", "HEAD")[:12]
    assert content.described(checkout) == f"content {before}, commit {at}"
    (checkout / "notes.txt").write_text("no part of the program")
    assert content.digest.__wrapped__(checkout) == before
    (checkout / "model" / "law.py").write_text("E = 206001\n")
    assert content.digest.__wrapped__(checkout) != before
    assert content.commit(checkout) == at


def test_packed_references_and_linked_work_trees_have_their_commit(checkout, tmp_path_factory):
    head = git(checkout, "rev-parse", "HEAD")[:12]
    git(checkout, "pack-refs", "--all")
    assert content.commit(checkout) == head
    linked = tmp_path_factory.mktemp("linked") / "tree"
    git(checkout, "worktree", "add", "-q", str(linked))
    assert content.commit(linked) == head


def test_outside_of_a_checkout_there_is_a_digest_alone(tmp_path):
    assert content.commit(tmp_path) is None
    assert content.described(tmp_path).startswith("content ")
    assert content.digest() in versions()
