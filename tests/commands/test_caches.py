"""Compiled functions are kept by the content of their sources."""

import os
import subprocess
import sys
import types
from pathlib import Path

import pytest

from coilset.model.core.runtime import caches, kernels
from coilset.model.physics.time.stage import evaluate


def version(monkeypatch, sources):
    monkeypatch.setattr(caches, "SOURCES", sources)
    return caches.version.__wrapped__()


def test_a_changed_callee_gives_a_new_version(monkeypatch, tmp_path):
    """Numba looks at the caller's file only."""
    (tmp_path / "caller.py").write_text("@njit\ndef a(): return b()")
    callee = tmp_path / "callee.py"
    callee.write_text("@njit\ndef b(): return 1")
    first = version(monkeypatch, tmp_path)
    assert version(monkeypatch, tmp_path) == first
    (tmp_path / "plain.py").write_text("c = 1")
    assert version(monkeypatch, tmp_path) == first
    callee.write_text("@njit\ndef b(): return 2")
    assert version(monkeypatch, tmp_path) != first


IMPORT = """
import os, sys
{0}
from adding import add
print(add._cache._cache_path, len(os.environ), os.environ.get("NUMBA_CACHE_DIR"))
"""


@pytest.mark.parametrize("given", [None, "elsewhere"])
def test_functions_of_a_user_stay_where_numba_keeps_them(tmp_path, given):
    """And the environment, which processes that are started inherit, as it is."""
    run = with_functions_kept_in(tmp_path, given and str(tmp_path / given))
    assert run(IMPORT.format("import coilset.api, coilset.open")) == run(IMPORT.format("import numba"))


@pytest.fixture
def sources(monkeypatch, tmp_path):
    """A function that writes a file of a program in a checkout, and gives its path."""
    monkeypatch.setattr(kernels, "ROOT", tmp_path)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept" / "version"))

    def write(path, text):
        kernels.source.cache_clear()
        kernels.digest.cache_clear()
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    return write


def test_a_kernel_is_kept_by_all_that_it_imports(sources):
    """Also by what its imports import, modules or names of modules, and constants; not by the rest."""
    caller = sources("model/caller.py", "from coilset.model.law import (\n    yields,\n)\nx = 1")
    sources("model/law/yields.py", "    from coilset.model.constants import K")
    sources("model/constants.py", "K = 1\nfrom coilset.model.caller import x")
    first = kernels.digest(caller)
    sources("model/other.py", "y = 1")
    assert kernels.digest(caller) == first
    sources("model/constants.py", "K = 2\nfrom coilset.model.caller import x")
    assert kernels.digest(caller) not in (first, None)


def test_environments_with_other_compilers_share_none(sources, monkeypatch):
    file = sources("model/caller.py", "def f(): pass")
    found = set()
    for version in ("numba 1", "numba 2"):
        kernels.digest.cache_clear()
        monkeypatch.setattr(caches, "toolchain", lambda version=version: version)
        found.add(kernels.digest(file))
    assert len(found) == 2


def test_the_toolchain_is_that_of_this_process():
    """Its versions are read without an import of numba, which `coilset --help` would wait for."""
    program = (
        "import sys; from coilset.model.core.runtime.caches import toolchain;print(toolchain(), 'numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [caches.toolchain(), "False"]


@pytest.mark.parametrize("file", ["sys.version", "sys.prefix", "numba", "llvmlite", "processor"])
def test_each_part_of_the_toolchain_counts(monkeypatch, tmp_path, file):
    before = caches.toolchain.__wrapped__()
    if file == "processor":
        monkeypatch.setattr(caches, "_processor", lambda: "another")
    elif file.startswith("sys."):
        monkeypatch.setattr(sys, file[4:], "another")
    else:
        own = caches.find_spec
        (tmp_path / "_version.py").write_text("version = 'another'")
        other = types.SimpleNamespace(submodule_search_locations=[str(tmp_path)])
        monkeypatch.setattr(caches, "find_spec", lambda name: other if name == file else own(name))
    assert caches.toolchain.__wrapped__() != before


def test_checkouts_share_kernels(sources, monkeypatch, tmp_path):
    """And all that is coilset's has such a place."""
    places = []
    for checkout in ("one", "two"):
        file = sources(f"{checkout}/model/caller.py", "def f(): pass")
        monkeypatch.setattr(kernels, "ROOT", tmp_path / checkout)
        places.append(kernels.ByContent.from_function(version, str(file)).get_cache_path())
    assert places[0] == places[1]
    assert kernels.ByContent.from_function(version, "/elsewhere/model/caller.py") is None


def test_kernels_of_this_checkout_are_kept_by_content():
    folder = Path(evaluate._cache._cache_path)
    assert folder.name == kernels.digest(kernels.ROOT / "model/physics/time/stage.py")


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
from coilset.model.core.runtime.caches import load_without_compiler
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
from coilset.model.core.runtime.caches import load_without_compiler
load_without_compiler()
import numpy as np
from doubling import add, twice
if len(sys.argv) > 1:
    add(np.arange(4.0))
print(twice(np.arange(4.0)), *(sum(one.stats.cache_hits.values()) for one in (add, twice)))
"""


def test_what_is_compiled_is_loaded_without_the_compiler(tmp_path):
    """Which is there when it is needed: for whole numbers, after the function of floating-point numbers was loaded."""
    run = with_functions_kept_in(tmp_path, str(tmp_path / "cache"))
    assert run(LOAD) == ["6.0", "0", "True", "6"]
    assert run(LOAD) == ["6.0", "1", "False", "6"]


def test_what_is_loaded_becomes_part_of_callers_that_are_compiled_later(tmp_path):
    """Which are kept, and need it no more."""
    run = with_functions_kept_in(tmp_path, str(tmp_path / "cache"))
    assert run(LOAD)[1] == "0"
    assert run(CALL, "add") == ["12.0", "1", "0"]
    assert run(CALL) == ["12.0", "0", "1"]


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize(
    "damage", [lambda data: b"", lambda data: data[: len(data) // 2], lambda data: bytes(len(data))]
)
def test_what_cannot_be_read_is_compiled_again(tmp_path, suffix, damage):
    """And kept: the next process loads it."""
    run = with_functions_kept_in(tmp_path, str(tmp_path / "cache"))
    program = "import coilset.model.core.runtime.kernels\n" + LOAD
    assert run(program)[:2] == ["6.0", "0"]
    assert run(program)[:2] == ["6.0", "1"]
    kept = list((tmp_path / "cache").rglob(f"*{suffix}"))
    assert kept
    for path in kept:
        path.write_bytes(damage(path.read_bytes()))
    assert run(program)[:2] == ["6.0", "0"]
    assert run(program)[:2] == ["6.0", "1"]


def with_functions_kept_in(folder, cache):
    """A function that runs a script, for which ADD and TWICE are there, and gives the words that it prints.

    Args:
        folder: of the functions.
        cache: NUMBA_CACHE_DIR; None: it is not set.
    """
    (folder / "adding.py").write_text(ADD)
    (folder / "doubling.py").write_text(TWICE)
    paths = os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")])
    kept = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment = kept | {"PYTHONPATH": paths} | ({} if cache is None else {"NUMBA_CACHE_DIR": cache})

    def run(*script):
        command = [sys.executable, "-c", *script]
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout.split()

    return run
