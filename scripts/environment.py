"""Answers to environment.sh about a Python: its files and folders, a line each, and whether it has all requirements.

Any Python 3 answers, from its standard input, so that this folder is none of those in which it looks for modules.
"""

import sys

sys.path[:] = filter(None, sys.path)  # without the working directory

import importlib.metadata  # noqa: E402
import importlib.util  # noqa: E402
import os  # noqa: E402

LEAST = (0, 9)  # DOLFINx

print(os.path.realpath(sys.executable), *(path for path in sys.path if os.path.isdir(path)), sep="\n")
try:
    version = importlib.metadata.version("fenics-dolfinx")
except importlib.metadata.PackageNotFoundError:
    version = importlib.metadata.version("dolfinx-solver-real")  # its wheel on PyPI
missing = [name for name in sys.argv[1:] if importlib.util.find_spec(name) is None]
if tuple(map(int, version.split(".")[:2])) < LEAST:
    print(f"has DOLFINx {version}; {LEAST[0]}.{LEAST[1]} or later is needed")
else:
    print(f"has DOLFINx, but not {', '.join(missing)}" if missing else "enough")
