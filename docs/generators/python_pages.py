"""Reference pages of the Python API: one for each package of `model` and `meshes`, read off the docstrings."""

import importlib
import tomllib
from pathlib import Path

from entry_pages import replace

REPOSITORY = Path(__file__).resolve().parents[2]
ROOMS = ("coilset.model", "coilset.meshes")


def write(folder: Path) -> None:
    """Write the page of every package into a folder, and the list of them."""
    names = packages()
    for name in names:
        replace(folder / f"{name}.md", page(name))
    entries = "\n".join(names)
    replace(
        folder / "index.md",
        "# Python\n\nEvery module of the program's library, by packages. The README shows how "
        f"a case is run from Python.\n\n```{{toctree}}\n:maxdepth: 1\n\n{entries}\n```\n",
    )


def packages() -> list[str]:
    """Packages of the library that hold modules, as pyproject.toml lists them."""
    with open(REPOSITORY / "pyproject.toml", "rb") as file:
        listed = tomllib.load(file)["tool"]["setuptools"]["packages"]
    return [name for name in listed if name.startswith(ROOMS) and modules(name)]


def modules(package: str) -> list[str]:
    """Names of a package's modules, without those of packages in it."""
    folder = REPOSITORY.joinpath(*package.split(".")[1:])
    return sorted(f"{package}.{path.stem}" for path in folder.glob("*.py") if path.stem != "__init__")


def page(package: str) -> str:
    """A package: what it says of itself, and all its modules."""
    about = importlib.import_module(package).__doc__ or ""
    parts = [f"# {package}", "```{eval-rst}\n" + about.strip() + "\n```"]
    for name in modules(package):
        parts += [f"## {name.removeprefix('coilset.')}", f"```{{eval-rst}}\n.. automodule:: {name}\n```"]
    return "\n\n".join(parts) + "\n"
