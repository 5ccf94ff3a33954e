"""The version of coilset, and those of what its numbers rest on."""

from coilset import __version__

LIBRARIES = {
    "DOLFINx": ("fenics-dolfinx", "dolfinx-solver-real"),
    "petsc4py": ("petsc4py",),
    "numba": ("numba",),
}  # by the names of their packages, whose metadata costs no import


def versions() -> str:
    """One line for people: coilset's version and those of the libraries that its numbers rest on."""
    import platform

    from coilset.model.core.base.content import described

    found = [f"{name} {version}" for name, packages in LIBRARIES.items() if (version := _first(packages))]
    return ", ".join([f"coilset {__version__} ({described()})", *found, f"Python {platform.python_version()}"])


def _first(packages: tuple[str, ...]) -> str:
    from importlib import import_module, metadata

    for package in packages:
        try:
            return metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    try:  # as petsc4py within the wheel of DOLFINx, which has no metadata of its own
        return str(import_module(packages[0]).__version__)
    except (ImportError, AttributeError):
        return ""
