"""A command takes no settings and no modules from the working directory, which may be a folder that somebody sent."""

import contextlib
import json
import os
import subprocess
import sys

import pytest

from coilset.model.core.runtime.apart import OURS, SAFE_PATH, elsewhere

FILES = {
    "petscrc": "-coilset_found 1\n",
    ".petscrc": "-coilset_found_dotted 1\n",
    "matplotlibrc": "figure.dpi: 7\n",
    ".numba_config.yaml": "boundscheck: 1\n",
    "ffcx_options.json": '{"epsilon": 0.25}',
    "dolfinx_jit_options.json": '{"cffi_extra_compile_args": ["-DFOUND"]}',
}
PROGRAM = """
import json, os, sys
before = os.getcwd()
import coilset.model
from coilset.model.core.runtime.libraries import link_beside
import ffcx, matplotlib, numba, dolfinx
from dolfinx import jit
from petsc4py import PETSc
print(json.dumps({
    "petscrc": PETSc.Options().hasName("coilset_found"),
    ".petscrc": PETSc.Options().hasName("coilset_found_dotted"),
    "matplotlibrc": matplotlib.rcParams["figure.dpi"] == 7,
    ".numba_config.yaml": numba.config.BOUNDSCHECK == 1,
    "ffcx_options.json": ffcx.get_options()["epsilon"] == 0.25,
    "dolfinx_jit_options.json": jit.get_options()["cffi_extra_compile_args"] == ["-DFOUND"],
}))
assert os.getcwd() == before
"""


@pytest.mark.parametrize("apart", [True, False])
def test_libraries_find_no_settings_in_the_working_directory(tmp_path, apart):
    """In a command; in a program of the user's own they do, which also shows that these files are what they read."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    environment = {name: value for name, value in os.environ.items() if name != SAFE_PATH}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        cwd=tmp_path,
        env=environment | ({SAFE_PATH: OURS} if apart else {}),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == dict.fromkeys(FILES, not apart)


def test_the_working_directory_returns_also_after_an_error(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with contextlib.suppress(ImportError), elsewhere():
        assert os.getcwd() == "/"
        raise ImportError
    assert os.getcwd() == str(tmp_path)
