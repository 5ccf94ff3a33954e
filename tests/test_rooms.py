"""Rooms of the program: their imports run in one direction, and each stays small enough to be read."""

import ast
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
import rooms

from coilset.model.core.base.errors import EXTRAS

ROOT = rooms.ROOT


def test_each_file_is_in_a_room_and_each_room_has_files():
    assert [path for path in rooms.sources() if rooms.room_of(path) is None] == []
    assert set(rooms.plan()["rooms"]) == {rooms.room_of(path) for path in rooms.sources()}
    named = [one for room in rooms.plan()["rooms"].values() for one in room["files"] if "*" not in one]
    assert [one for one in named if not (ROOT / one).exists()] == []


def test_a_room_imports_what_it_names_and_nothing_above_its_floor():
    floors, plan = rooms.plan()["floors"], rooms.plan()["rooms"]
    for name, room in plan.items():
        level = floors.index(room["floor"])
        for other in room.get("imports", ()):
            assert floors.index(plan[other]["floor"]) <= level, f"{name} imports {other}"


def test_no_import_is_left_that_the_rooms_forbid():
    """A new one needs a door, see docs/architecture.md."""
    assert rooms.forbidden() == {}


def test_a_room_keeps_its_budget_of_lines():
    sizes = rooms.sizes()
    over = {name: sizes[name] for name, room in rooms.plan()["rooms"].items() if sizes[name] > room.get("budget", 1e9)}
    assert over == {}
    budgets = {name: room["budget"] for name, room in rooms.plan()["rooms"].items() if room["floor"] in rooms.PACKAGES}
    assert max(budgets.values()) <= 2500


def test_a_room_imports_only_libraries_of_the_extras_that_it_states():
    of = {module: extra for extra, modules in EXTRAS.items() for module in modules}
    for path, tree in rooms.sources().items():
        room = rooms.plan()["rooms"][rooms.room_of(path)]
        found = {of[name] for name in libraries(tree) if name in of}
        assert room["floor"] == "face" or found <= set(room.get("extras", ())), path


def libraries(tree):
    """Top-level names of all modules that a file imports."""
    for node in ast.walk(tree):
        names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        yield from (name.partition(".")[0] for name in names)


RUN = """
import sys
from coilset.model.core.case import read_case
from coilset.model.compose.analysis import Analysis
Analysis(read_case(sys.argv[1], ["mesh.elements_per_turn=4", "mesh.section={radial: 2, angular: 8}"])).run()
print(*sys.modules)
"""


def test_a_plain_run_loads_no_package_but_those_that_take_part_in_it(example):
    """Names of modules in strings, as of doors, evade the list of imports."""
    command = [sys.executable, "-c", RUN, str(example)]
    loaded = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    found = {rooms.room_of(path) for path in rooms.sources() if rooms.module(path) in loaded}
    assert {room for room in found if rooms.floor_of(room) in rooms.PACKAGES} == set(rooms.plan()["used"])


def test_the_parts_of_equilibrium_are_built_on_each_other():
    parts = {"system": 0, "newton": 1, "path": 2}
    for part, level in parts.items():
        for file in (ROOT / "model" / "equilibrium" / part).glob("*.py"):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                names = (node.module or "").split(".") if isinstance(node, ast.ImportFrom) else []
                if names[:3] == ["coilset", "model", "equilibrium"] and names[3] in parts:
                    assert parts[names[3]] <= level, f"{part}/{file.name} imports {names[3]}"


MOST_FILES, MOST_PARAMETERS = 14, 10
# What is larger still, with its number: it may become smaller, and nothing may be added.
PARAMETERS = {
    "model/core/rod/forms.py": 1,
    "model/physics/warping/condensation.py": 1,
    "model/core/section/fibres.py": 2,
    "model/core/section/integration.py": 1,
    "model/physics/warping/warping.py": 2,
    "model/physics/uniform_coil/rod.py": 1,
}
CTYPES = {"model/core/equilibrium/system/coo.py", "model/physics/own_laws/mfront.py"}


def test_a_folder_has_at_most_fourteen_files():
    sizes = {}
    for path in map(Path, rooms.sources()):
        if path.name != "__init__.py":
            folder = path.parent.as_posix()
            sizes[folder] = sizes.get(folder, 0) + 1
    assert {folder: size for folder, size in sizes.items() if size > MOST_FILES} == {}


def test_no_files_import_each_other_in_a_circle():
    """Imports within functions and for types alone count, too."""
    found = rooms.imports()
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
    for file, tree in rooms.sources().items():
        for function in (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)):
            of = function.args
            names = [one.arg for one in (*of.posonlyargs, *of.args, *of.kwonlyargs) if one.arg not in ("self", "cls")]
            if len(names) > MOST_PARAMETERS and not is_command(function):
                many[file] = many.get(file, 0) + 1
    assert {file: count for file, count in many.items() if count > PARAMETERS.get(file, 0)} == {}


def test_ctypes_are_used_where_they_are_known_to_be():
    users = {
        file
        for file, tree in rooms.sources().items()
        for node in ast.walk(tree)
        if (isinstance(node, ast.Import) and any(one.name == "ctypes" for one in node.names))
        or (isinstance(node, ast.ImportFrom) and node.module == "ctypes")
    }
    assert {file for file in users if not file.startswith("model/core/runtime/")} == CTYPES
