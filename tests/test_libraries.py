"""What libraries load without using it is not loaded, and is there when it is used."""

import subprocess
import sys
from importlib.util import find_spec

import pytest

WAIT = """
import sys
from coilset.model.core.runtime.libraries import UNUSED, LazyModule
import dolfinx, numba
print(all(type(sys.modules[name]) is LazyModule for name in UNUSED if name in sys.modules))
"""
AGAIN = """
import sys
from coilset.model.core.runtime.libraries import LazyModule, LazyFinder
sys.meta_path.insert(0, LazyFinder(["matplotlib.pyplot"]))
import matplotlib.pyplot
import matplotlib.pyplot as plt
waits = type(plt) is LazyModule
print(waits, callable(plt.figure), type(plt) is LazyModule)
"""
LINK = """
import sys, threading
from coilset.scripts.startup import load_for_solve
load_for_solve()
for thread in threading.enumerate():
    if thread is not threading.current_thread():
        thread.join()
with open("/proc/self/maps") as linked:
    print("/dolfinx/cpp." in linked.read(), [name for name in ("mpi4py.MPI", "petsc4py.PETSc") if name in sys.modules])
"""
UNCHANGED = """
import ctypes
from coilset.scripts.startup import load_for_solve

def beginnings():
    functions = (getattr(ctypes.CDLL(None), name) for name in ("mmap", "munmap", "mremap", "madvise", "brk"))
    return [ctypes.string_at(ctypes.cast(function, ctypes.c_void_p).value, 16) for function in functions]

before = beginnings()
load_for_solve()
from mpi4py import MPI
import dolfinx
print(beginnings() == before)
"""
USE = """
import coilset.model, {0}, inspect
print("def " in inspect.getsource({0}), inspect.getmodule({0}) is {0})
"""


def said(script):
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()


def test_the_commands_are_listed_without_rich():
    """It takes longer to load than everything else for `--help`; a command that imports typer itself loads it."""
    script = "import sys, coilset.scripts.main; print('rich' in sys.modules, 'numba' in sys.modules)"
    assert said(script) == ["False", "False"]


def test_modules_without_use_wait():
    assert said(WAIT) == ["True"]


def test_they_are_there_when_they_are_used():
    assert said(USE.format("dolfinx.plot")) == ["True", "True"]


def test_a_second_import_is_no_use():
    assert said(AGAIN) == ["True", "True", "False"]


@pytest.mark.skipif(find_spec("dolfinx_solver") is not None, reason="wheels are linked in an order of their own")
def test_libraries_are_linked_before_their_modules_are_loaded():
    assert said(LINK) == ["True", "[]"]


@pytest.mark.skipif(find_spec("dolfinx_solver") is not None, reason="nothing is linked beside other work")
def test_no_library_changes_the_functions_of_memory(monkeypatch):
    """Another thread may be in them, and would crash."""
    monkeypatch.delenv("UCX_MEM_EVENTS", raising=False)
    assert said(UNCHANGED) == ["True"]
