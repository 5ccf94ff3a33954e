"""The version of coilset, which pyproject.toml reads from here, and those of what its numbers rest on."""

import platform
from importlib import metadata

__version__ = "0.1.0"
LIBRARIES = {"DOLFINx": ("fenics-dolfinx", "dolfinx-solver-real"), "petsc4py": ("petsc4py",),
             "numba": ("numba",)}  # by the names of their packages, whose metadata costs no import  # fmt: skip


def versions() -> str:
    """One line for people: coilset's version and those of the libraries that its numbers rest on."""
    found = [f"{name} {version}" for name, packages in LIBRARIES.items() if (version := _first(packages))]
    return ", ".join([f"coilset {__version__}", *found, f"Python {platform.python_version()}"])


def _first(packages: tuple[str, ...]) -> str:
    for package in packages:
        try:
            return metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return ""
