"""The rooms of model/rooms.toml, and what the program's imports make of them.

`python3 tests/rooms.py` prints the table: what one must own to press one spring, and for a result; imports against the
rooms; lines opened for ten changes; the largest packages. Imports within functions and for types alone count, too.
"""

import ast
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOPS = "meshes", "model", "verification", "scripts"
ALONE = "api.py", "open.py"
RUN, RESULT = "model/compose/analysis.py", "model/core/results/records/record.py"
CORE, PACKAGES = "core", ("physics", "tools")
# files that somebody opens for a typical change
CHANGES = {
    "a hardening curve": ["model/core/material/law/hardening_curves.py", "model/core/material/law/file.py"],
    "a kind of contact": ["model/core/contact/base.py", "model/core/contact/seat.py", "model/compose/contacts.py"],
    "step control": ["model/core/equilibrium/path/step_sizes.py", "model/core/equilibrium/settings.py"],
    "a column of history.csv": ["model/core/results/records/record.py", "model/compose/recorder.py"],
    "a number shown everywhere": [
        "model/core/results/records/summary_entries.py",
        "model/compose/summary.py",
        "model/core/results/quantities.py",
    ],
    "a shape of a spring": ["meshes/springs/shapes.py"],
    "a part of a law": [
        "model/physics/time/stage.py",
        "model/physics/time/increment.py",
        "model/core/material/law/file.py",
    ],
    "a warning": [
        "model/compose/run_warnings.py",
        "model/core/results/order_of_warnings.py",
        "model/tools/report/warning_words.py",
    ],
    "a figure": [
        "model/tools/figures/panels/panel.py",
        "model/tools/report/run_page.py",
        "model/tools/figures/pictures.py",
    ],
    "a command": ["scripts/main.py", "scripts/commands/report.py"],
}


@cache
def plan() -> dict:
    """Content of model/rooms.toml."""
    return tomllib.loads((ROOT / "model" / "rooms.toml").read_text(encoding="utf-8"))


@cache
def sources() -> dict[str, ast.Module]:
    """Each file of the program, by its path, as a syntax tree."""
    files = [file for top in TOPS for file in sorted((ROOT / top).rglob("*.py"))]
    files += [ROOT / name for name in ALONE]
    return {file.relative_to(ROOT).as_posix(): ast.parse(file.read_text(encoding="utf-8")) for file in files}


@cache
def imports() -> dict[str, set[str]]:
    """The files of the program that each file imports."""
    modules = {module(path): path for path in sources()}
    found: dict[str, set[str]] = {}
    for path, tree in sources().items():
        found[path] = set(_imported(tree, modules)) - {path}
    return found


def module(path: str) -> str:
    """Name of the module in a file."""
    return "coilset." + path.removesuffix(".py").replace("/", ".").removesuffix(".__init__")


def _imported(tree: ast.Module, modules: dict[str, str]) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            for name in node.names:
                target = modules.get(f"{node.module}.{name.name}") or modules.get(node.module or "")
                if target:
                    yield target
        elif isinstance(node, ast.Import):
            yield from (modules[name.name] for name in node.names if name.name in modules)


@cache
def room_of(path: str) -> str | None:
    """The room of a file: the one that names it, else the one with its folder."""
    found = None
    for name, room in plan()["rooms"].items():
        if path in room["files"]:
            return name
        if any("*" in one and one.count("/") == path.count("/") and fnmatch(path, one) for one in room["files"]):
            found = name
    return found


def floor_of(room: str) -> str:
    """Name of a room's floor."""
    return plan()["rooms"][room]["floor"]


def forbidden() -> dict[str, set[str]]:
    """The imports, by files, that no room's entry `imports` allows; the face may import everything."""
    found: dict[str, set[str]] = {}
    for path, targets in imports().items():
        own = room_of(path)
        room = plan()["rooms"][own]
        if room["floor"] == "face":
            continue
        outside = {target for target in targets if room_of(target) not in (own, *room["imports"])}
        if outside:
            found[path] = outside
    return found


def closure(path: str) -> set[str]:
    """A file with all that it imports, directly or not."""
    seen, todo = set[str](), [path]
    while todo:
        one = todo.pop()
        if one not in seen:
            seen.add(one)
            todo += imports()[one]
    return seen


def lines(*paths: str) -> int:
    """Number of lines of files."""
    return sum((ROOT / path).read_text(encoding="utf-8").count("\n") for path in paths)


def sizes() -> dict[str, int]:
    """Lines of each room."""
    return {name: lines(*(path for path in sources() if room_of(path) == name)) for name in plan()["rooms"]}


def main() -> None:
    """Print the table."""
    run, result = closure(RUN), closure(RESULT)
    core = [path for path in run if floor_of(room_of(path) or "") in (CORE, "compose")]
    packages = sorted((size, name) for name, size in sizes().items() if floor_of(name) in PACKAGES)
    program = [path for path in sources() if not path.startswith("verification/")]
    opened = {change: lines(*files) for change, files in CHANGES.items()}
    print(f"what one must own to press one spring   {len(run):4d} files {lines(*run):6,d} lines")
    print(f"  of it core and compose                {len(core):4d} files {lines(*core):6,d} lines")
    print(f"for a result                            {len(result):4d} files {lines(*result):6,d} lines")
    print(f"imports that no room allows             {sum(map(len, forbidden().values())):4d}")
    print(f"model, meshes, scripts, api                        {lines(*program):6,d} lines")
    print(f"opened for ten changes                             {sum(opened.values()):6,d} lines")
    for change, count in opened.items():
        print(f"  {change:48s} {count:6,d}")
    print(
        "largest packages                                 ",
        ", ".join(f"{name} {size:,d}" for size, name in packages[:-6:-1]),
    )


if __name__ == "__main__":
    main()
