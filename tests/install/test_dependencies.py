"""What the program imports is declared: what comes with something else today may not tomorrow."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import yaml

REPOSITORY = Path(__file__).resolve().parents[2]
ROOMS = ("model", "meshes", "scripts", "verification", "examples")
DISTRIBUTIONS = {"PIL": "pillow", "yaml": "pyyaml", "vtkmodules": "vtk"}  # that have another name than their modules
FENICS = {"dolfinx", "basix", "ffcx", "ufl"}  # of fenics-dolfinx; from a distribution or conda, as those that follow
OF_A_DISTRIBUTION = {"petsc4py", "mpi4py", "gmsh"}
WHERE_IT_IS = {
    "dolfinx_solver": "model/core/runtime/libraries.py",
    "paraview": "verification/solid_study/paraview_view.py",
}


def imported() -> Iterator[tuple[str, str]]:
    """Each module of others that is imported anywhere, and the file."""
    for file in (*REPOSITORY.glob("*.py"), *(file for room in ROOMS for file in (REPOSITORY / room).rglob("*.py"))):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module or ""]
            for name in {name.partition(".")[0] for name in names} - set(sys.stdlib_module_names) - {"coilset"}:
                yield name, str(file.relative_to(REPOSITORY))


def declared() -> set[str]:
    """Distributions in pyproject.toml, in the spelling of PEP 503."""
    with open(REPOSITORY / "pyproject.toml", "rb") as file:
        project = tomllib.load(file)["project"]
    groups = [project["dependencies"], *project["optional-dependencies"].values()]
    required = [one for group in groups for one in group]
    return {re.sub(r"[-_.]+", "-", re.split(r"[\s<>=!~;\[]", one)[0]).lower() for one in required}


def test_every_import_is_declared():
    from_elsewhere, listed = FENICS | OF_A_DISTRIBUTION, declared()
    missing = {
        (name, file)
        for name, file in imported()
        if name not in from_elsewhere and WHERE_IT_IS.get(name) != file
        if DISTRIBUTIONS.get(name, name).lower().replace("_", "-") not in listed
    }
    assert missing == set()


def test_conda_has_what_pip_does_not_install():
    with open(REPOSITORY / "environment.yml", encoding="utf-8") as file:
        listed = {re.split(r"[<>=]", one)[0] for one in yaml.safe_load(file)["dependencies"]}
    assert {"fenics-dolfinx", "petsc4py", "mpi4py", "python-gmsh"} <= listed
