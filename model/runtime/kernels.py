"""`njit` for kernels, whose machine code is kept by the content of what it is compiled from."""

import functools
import hashlib
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Self

from numba import njit
from numba.core import caching

__all__ = ["njit"]

ROOT = Path(__file__).resolve().parents[2]  # the folder that is imported as coilset
IMPORTS = re.compile(r"^ *from coilset\.([\w.]+) import (\([^)]*\)|.*)", re.MULTILINE)


class ByContent(caching._CacheLocator):
    """Where numba keeps a kernel: in a folder named by the content of its file and of all that this imports.

    By itself numba goes by path and date of the kernel's own file. It would use old machine code after a change in a
    file whose functions are called, and compile again what is the same in another checkout.

    Args:
        function: the kernel in Python.
        file: which it is in.
    """

    def __init__(self, function: Callable, file: Path) -> None:
        self.line = function.__code__.co_firstlineno
        self.digest = digest(file)
        self.folder = Path(os.environ["NUMBA_CACHE_DIR"]).parent / "kernels" / file.relative_to(ROOT) / self.digest

    def get_cache_path(self) -> str:
        """Its folder."""
        return str(self.folder)

    def get_source_stamp(self) -> str:
        """What changes with the source."""
        return self.digest

    def get_disambiguator(self) -> str:
        """What distinguishes functions of the same name in a file."""
        return str(self.line)

    @classmethod
    def from_function(cls, function: Callable, file: str) -> Self | None:
        """Its place; None for a function that is not coilset's, or if nothing can be stored."""
        path = Path(file).resolve()
        if not path.is_relative_to(ROOT):
            return None
        place = cls(function, path)
        try:
            place.ensure_cache_path()
        except OSError:
            return None
        return place


@functools.cache
def digest(file: Path) -> str:
    """Of the content of a file of coilset and of all that it imports of coilset, directly or not, in hexadecimals."""
    content, found, waiting = hashlib.sha256(), {file}, [file]
    while waiting:
        new = imported(waiting.pop()) - found
        found |= new
        waiting += new
    for path in sorted(found):
        content.update(f"{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
    return content.hexdigest()[:16]


@functools.cache
def imported(file: Path) -> frozenset[Path]:
    """The files of coilset that a file imports."""
    return frozenset(
        path for module, names in IMPORTS.findall(file.read_text()) for path in _files(module, names) if path.exists()
    )


def _files(module: str, names: str) -> Iterator[Path]:
    """Of `from coilset.module import names`, where a name may be a module, too."""
    base = ROOT / module.replace(".", "/")
    yield base.with_suffix(".py")
    yield base / "__init__.py"
    yield from (base / f"{name}.py" for name in re.findall(r"\w+", names))


def keep() -> None:
    """Have numba keep coilset's kernels by content; a version without such places keeps them in its own way."""
    places: Any = getattr(caching.CacheImpl, "_locator_classes", None)
    if places is not None and ByContent not in places:
        places.insert(0, ByContent)


keep()
