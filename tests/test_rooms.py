"""Rooms of the program: their imports run in one direction."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def room(module):
    """`coilset.model.rod.forms` → model.rod; a file of model itself is a room of its own."""
    parts = module.split(".")[1:]
    return ".".join(parts[:2]) if parts[0] == "model" else parts[0]


def imports():
    """The rooms that each room imports from."""
    found = {}
    for top in ("meshes", "model", "verification", "scripts"):
        for file in (ROOT / top).rglob("*.py"):
            own = room(".".join(["coilset", *file.relative_to(ROOT).with_suffix("").parts]))
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
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


def test_meshes_import_only_the_base_of_the_model():
    assert {one for one in imports()["meshes"] if one.startswith("model")} == {"model.base"}
