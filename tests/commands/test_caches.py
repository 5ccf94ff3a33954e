"""Compiled functions are kept by the content of all their sources."""

import os
import subprocess
import sys

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


ADD = """
from numba import njit

@njit(cache=True)
def add(x):
    total = x[0]
    for k in range(1, x.size):
        total += x[k]
    return total
"""
LOAD = """
import sys
from coilset.model.caches import load_without_compiler
load_without_compiler()
import numpy as np
from adding import add
print(add(np.arange(4.0)), sum(add.stats.cache_hits.values()), "scipy.linalg" in sys.modules, add(np.arange(4)))
"""


def test_what_is_compiled_is_loaded_without_the_compiler(tmp_path):
    """Which is there when it is needed: for whole numbers, after the function of floating-point numbers was loaded."""
    (tmp_path / "adding.py").write_text(ADD)
    paths = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": paths}

    def run():
        done = subprocess.run([sys.executable, "-c", LOAD], env=environment, capture_output=True, text=True, check=True)
        return done.stdout.split()

    assert run() == ["6.0", "0", "True", "6"]
    assert run() == ["6.0", "1", "False", "6"]
