"""Rooms of the program: their imports run in one direction, and each stays small enough to be read."""

import ast
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TOPS = ("meshes", "model", "verification", "scripts")


@cache
def sources():
    """Each file of the program with its syntax tree."""
    files = [file for top in TOPS for file in sorted((ROOT / top).rglob("*.py"))]
    return [(file.relative_to(ROOT), ast.parse(file.read_text(encoding="utf-8"))) for file in files]


def room(module):
    """`coilset.model.rod.forms` → model.rod; a file of model itself is a room of its own."""
    parts = module.split(".")[1:]
    return ".".join(parts[:2]) if parts[0] == "model" else parts[0]


@cache
def imports():
    """The rooms that each room imports from."""
    found = {}
    for file, tree in sources():
        own = room(".".join(["coilset", *file.with_suffix("").parts]))
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("coilset."):
                names = [f"{node.module}.{one.name}" for one in node.names]
                if node.module != "coilset.model":
                    names = [node.module]
                found.setdefault(own, set()).update(room(name) for name in names if room(name) != own)
    return found


def test_no_rooms_import_each_other_in_a_circle():
    rooms = imports()
    assert len(rooms) > 15
    try:
        TopologicalSorter(rooms).prepare()
    except CycleError as error:
        pytest.fail(f"a circle of imports: {' → '.join(error.args[1])}")


def test_the_parts_of_equilibrium_are_built_on_each_other():
    parts = {"system": 0, "newton": 1, "path": 2}
    for part, level in parts.items():
        for file in (ROOT / "model" / "equilibrium" / part).glob("*.py"):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                names = (node.module or "").split(".") if isinstance(node, ast.ImportFrom) else []
                if names[:3] == ["coilset", "model", "equilibrium"] and names[3] in parts:
                    assert parts[names[3]] <= level, f"{part}/{file.name} imports {names[3]}"


def test_meshes_import_only_the_base_of_the_model():
    assert {one for one in imports()["meshes"] if one.startswith("model")} == {"model.base"}


MOST_FILES, MOST_PARAMETERS = 14, 10
# What is larger still, with its number: it may become smaller, and nothing may be added.
PARAMETERS = {
    "model/rod/forms.py": 1,
    "model/section/condensation.py": 1,
    "model/section/fibres.py": 2,
    "model/section/integration.py": 1,
    "model/section/warping.py": 2,
    "model/uniform_coil/rod.py": 1,
}
CTYPES = {"model/equilibrium/system/aij.py", "model/runtime/processes.py"}


def test_a_folder_has_at_most_fourteen_files():
    sizes = {}
    for file, _ in sources():
        if file.name != "__init__.py":
            folder = file.parent.as_posix()
            sizes[folder] = sizes.get(folder, 0) + 1
    assert {folder: size for folder, size in sizes.items() if size > MOST_FILES} == {}


def test_no_files_import_each_other_in_a_circle():
    """Imports within functions and for types alone count, too."""
    files = {".".join(file.with_suffix("").parts): tree for file, tree in sources()}
    found = {}
    for name, tree in files.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("coilset."):
                module = node.module.removeprefix("coilset.")
                named = {f"{module}.{one.name}" for one in node.names}
                found.setdefault(name, set()).update((named | {module}) & files.keys())
    assert sum(map(len, found.values())) > 1000
    try:
        TopologicalSorter(found).prepare()
    except CycleError as error:
        pytest.fail(f"a circle of files: {' → '.join(error.args[1])}")


def is_command(function):
    """`@app.command()`: its parameters are the options of a command, which nobody passes by position."""
    return any("command" in ast.dump(decorator) for decorator in function.decorator_list)


def test_a_function_has_at_most_ten_parameters():
    many = {}
    for file, tree in sources():
        for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
            of = function.args
            names = [one.arg for one in (*of.posonlyargs, *of.args, *of.kwonlyargs) if one.arg not in ("self", "cls")]
            if len(names) > MOST_PARAMETERS and not is_command(function):
                many[file.as_posix()] = many.get(file.as_posix(), 0) + 1
    assert {file: count for file, count in many.items() if count > PARAMETERS.get(file, 0)} == {}


def test_ctypes_are_used_where_they_are_known_to_be():
    users = {
        file.as_posix()
        for file, tree in sources()
        for node in ast.walk(tree)
        if isinstance(node, ast.Import) and any(one.name == "ctypes" for one in node.names)
    }
    assert {file for file in users if not file.startswith("model/runtime/")} <= CTYPES
