"""The examples that come with coilset, in a checkout as in an installation."""

import re
import shutil
from importlib import resources
from pathlib import Path

from coilset.model.core.base.entry import shortened
from coilset.model.core.base.errors import InputError
from coilset.model.core.results.files.folder import make, refuse_to_replace, whole

EXAMPLES = Path(str(resources.files("coilset.examples")))
SUFFIXES = (".yaml", ".csv", ".sh")


def names() -> list[str]:
    """Paths of all examples below their folder, with `/`, in alphabetical order."""
    found = (path for path in EXAMPLES.rglob("*") if path.suffix in SUFFIXES)
    return sorted(path.relative_to(EXAMPLES).as_posix() for path in found)


def title(name: str) -> str:
    """First line of an example's comment; the columns of data without one."""
    lines = (EXAMPLES / name).read_text(encoding="utf-8").splitlines()
    comments = [line.lstrip("# ").rstrip() for line in lines if line.startswith("# ")]
    return comments[0] if comments else f"Data: {lines[0]}"


def find(name: str) -> str:
    """The example that a user means: its path, or the end of it, with or without its suffix.

    Raises:
        InputError: if there is none, or more than one.
    """
    asked = name.removeprefix("examples/")
    found = [path for path in names() if asked in (path, path.rpartition(".")[0], Path(path).name, Path(path).stem)]
    exact = [path for path in found if path == asked]
    if len(exact or found) != 1:
        problem = (
            f"several of the examples: {', '.join(found)}" if found else "no example; `coilset examples` lists them"
        )
        raise InputError(f"'{shortened(name)}' is {problem}", "examples")
    return (exact or found)[0]


def needs(name: str) -> list[str]:
    """The example and the files that its entries `case` and `file` name, those of theirs included."""
    files, path = [name], EXAMPLES / name
    for entry in re.findall(r"^\s*(?:case|file):\s*([^\s#]+)", path.read_text(encoding="utf-8"), re.MULTILINE):
        named = (path.parent / entry).resolve()
        if named.is_file():
            files += needs(named.relative_to(EXAMPLES.resolve()).as_posix())
    return files


def copy(name: str, folder: Path, replace: bool = False) -> list[Path]:
    """Copy an example, and what it needs, to the places below `folder` that it has below the examples.

    Raises:
        InputError: if a file already exists and is not to be replaced; nothing is copied then.
        CoilsetError: if one cannot be written.
    """
    targets = {EXAMPLES / file: folder / file for file in needs(name)}
    refuse_to_replace(targets.values(), replace)
    for source, target in targets.items():
        make(target.parent)
        with whole(target) as partial:
            shutil.copyfile(source, partial)
    return list(targets.values())
