"""Compiled functions are kept by the content of all their sources."""

import os
import subprocess
import sys

import numba

from coilset.model.runtime import caches


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
from coilset.model.runtime.caches import load_without_compiler
load_without_compiler()
import numpy as np
from adding import add
print(add(np.arange(4.0)), sum(add.stats.cache_hits.values()), "scipy.linalg" in sys.modules, add(np.arange(4)))
"""
TWICE = """
from numba import njit
from adding import add

@njit(cache=True)
def twice(x):
    return 2.0 * add(x)
"""
CALL = """
import sys
from coilset.model.runtime.caches import load_without_compiler
load_without_compiler()
import numpy as np
from doubling import add, twice
if len(sys.argv) > 1:
    add(np.arange(4.0))
print(twice(np.arange(4.0)), *(sum(one.stats.cache_hits.values()) for one in (add, twice)))
"""


def test_what_is_compiled_is_loaded_without_the_compiler(tmp_path):
    """Which is there when it is needed: for whole numbers, after the function of floating-point numbers was loaded."""
    run = with_functions_kept_in(tmp_path)
    assert run(LOAD) == ["6.0", "0", "True", "6"]
    assert run(LOAD) == ["6.0", "1", "False", "6"]


def test_what_is_loaded_becomes_part_of_callers_that_are_compiled_later(tmp_path):
    """Which are kept, and need it no more."""
    run = with_functions_kept_in(tmp_path)
    assert run(LOAD)[1] == "0"
    assert run(CALL, "add") == ["12.0", "1", "0"]
    assert run(CALL) == ["12.0", "0", "1"]


def with_functions_kept_in(folder):
    """A function that runs a script, for which ADD and TWICE are there, and gives the words that it prints."""
    (folder / "adding.py").write_text(ADD)
    (folder / "doubling.py").write_text(TWICE)
    paths = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONPATH": paths}

    def run(*script):
        command = [sys.executable, "-c", *script]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()

    return run
