"""What a page says to type works after what it said before, and the files that it names are there."""

import ast
import importlib
import itertools
import re
import shlex
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
PAGES = {
    path.relative_to(REPOSITORY).as_posix(): path.read_text(encoding="utf-8")
    for path in [REPOSITORY / "README.md", *sorted((REPOSITORY / "docs").rglob("*.md"))]
    if "generated" not in path.parts
}
ROOMS = ("model", "meshes", "scripts", "verification", "tests", "examples", "docs")
WRITES = {"solve": "", "slice": "-slice", "sweep": "", "design": ""}  # into a folder without results: suffix
STEP_BY_STEP = [name for name in PAGES if name.startswith(("docs/how-to/", "docs/tutorial/"))]


def commands(page):
    """Words of each command on a page."""
    for line in re.findall(r"^    scripts/coilset (.*)$", page, re.MULTILINE):
        yield shlex.split(line.partition(" | ")[0], comments=True)


def test_every_source_that_a_page_names_is_there():
    sources = [path.relative_to(REPOSITORY).as_posix() for room in ROOMS for path in (REPOSITORY / room).rglob("*.py")]
    sources += [path.name for path in REPOSITORY.glob("*.py")]
    missing = {}
    for name, page in PAGES.items():
        saved = re.findall(r"[Ss]ave (?:this|it) as `(\S+)`", page)  # by the reader
        for named in set(re.findall(r"`([\w./-]+\.py)`", page)) - set(saved):
            if not any(f"/{source}".endswith(f"/{named}") for source in sources):
                missing.setdefault(name, []).append(named)
    assert missing == {}


@pytest.mark.parametrize("name", STEP_BY_STEP)
def test_commands_follow_each_other(name):
    """None meets the results of one before it, unless it says what is to be done with them; the examples are there."""
    taken = set()
    for words in commands(PAGES[name]):
        for word in words:
            assert not word.startswith("examples/") or (REPOSITORY / word).exists(), word
        if words[0] not in WRITES:
            continue
        default = f"results/{Path(words[1]).stem}{WRITES[words[0]]}"
        folder = dict(itertools.pairwise(words)).get("--out", default)
        assert folder not in taken or {"--overwrite", "--resume", "--collect"} & set(words), words
        taken.add(folder)


def imported(page):
    """Module and name of each import from coilset in a page's blocks of Python."""
    for block in re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        for node in ast.walk(ast.parse(block)):
            if isinstance(node, ast.ImportFrom) and node.module.partition(".")[0] == "coilset":
                yield from ((node.module, alias.name) for alias in node.names)
            if isinstance(node, ast.Import):
                yield from ((alias.name, None) for alias in node.names if alias.name.startswith("coilset"))


def test_what_a_page_imports_is_there():
    """A name is an attribute of its module, or a module in it."""
    found = {pair for page in PAGES.values() for pair in imported(page)}
    assert len(found) > 10
    missing = []
    for module, name in sorted(found, key=str):
        try:
            owner = importlib.import_module(module)
            if name is not None and not hasattr(owner, name):
                importlib.import_module(f"{module}.{name}")
        except ImportError:
            missing.append((module, name))
    assert missing == []
