"""Compiled functions are kept by the content of all their sources."""

import os

import numba

from coilset.model import caches


def version(monkeypatch, sources, root="kept"):
    monkeypatch.setattr(caches, "SOURCES", sources)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(root))
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    caches.keep_by_content()
    assert os.environ["NUMBA_CACHE_DIR"] == numba.config.CACHE_DIR
    return numba.config.CACHE_DIR


def test_a_changed_callee_gives_a_new_folder(monkeypatch, tmp_path):
    """Numba looks at the caller's file only."""
    (tmp_path / "caller.py").write_text("@njit\ndef a(): return b()")
    callee = tmp_path / "callee.py"
    callee.write_text("@njit\ndef b(): return 1")
    first = version(monkeypatch, tmp_path)
    assert version(monkeypatch, tmp_path) == first
    assert version(monkeypatch, tmp_path, first) == first  # as in a process that this one starts
    (tmp_path / "plain.py").write_text("c = 1")
    assert version(monkeypatch, tmp_path) == first
    callee.write_text("@njit\ndef b(): return 2")
    assert version(monkeypatch, tmp_path) != first
