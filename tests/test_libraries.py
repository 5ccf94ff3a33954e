"""What libraries load without using it is not loaded, and is there when it is used."""

import subprocess
import sys

WAIT = """
import sys
from coilset.model.libraries import UNUSED, Waiting
import dolfinx, numba
print(all(type(sys.modules[name]) is Waiting for name in UNUSED if name in sys.modules))
"""
USE = """
import coilset.model, {0}, inspect
print("def " in inspect.getsource({0}), inspect.getmodule({0}) is {0})
"""


def said(script):
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()


def test_modules_without_use_wait():
    assert said(WAIT) == ["True"]


def test_they_are_there_when_they_are_used():
    assert said(USE.format("dolfinx.plot")) == ["True", "True"]
