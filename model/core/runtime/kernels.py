"""How kernels are compiled, and where they are kept: by the content of what they are compiled from, and by what."""

import functools
import hashlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, Self

from numba import njit
from numba.core import caching

from coilset.model.core.runtime import caches

__all__ = ["COMPILED", "INLINE", "KERNEL", "PASTED", "njit"]

# A version of numba without such places would keep kernels by path and date; ByContent takes the first of them.
PLACES: list[type] | None = getattr(caching.CacheImpl, "_locator_classes", None)
# No checks of divisors; no wrapper for C, which nothing calls and takes a tenth of the time.
COMPILED = {"cache": PLACES is not None, "error_model": "numpy", "no_cfunc_wrapper": True}
KERNEL = COMPILED | {"fastmath": {"contract"}}  # the material's: multiply-add contracted
INLINE = KERNEL | {"forceinline": True}  # put into their caller
# Put into their few callers before these are compiled: numba optimises a function once more with each that calls it.
PASTED = KERNEL | {"inline": "always"}

ROOT = Path(__file__).resolve().parents[3]  # the folder that is imported as coilset
IMPORTS = re.compile(r"^ *from coilset\.([\w.]+) import (\([^)]*\)|.*)", re.MULTILINE)


class ByContent(caching._CacheLocator):
    """Where numba keeps a kernel: in a folder named by the content of its file and of all that this imports.

    By itself numba goes by path and date of the kernel's own file. It would use old machine code after a change in a
    file whose functions are called, and compile again what is the same in another checkout. Environments with another
    numba or llvmlite, which cannot read each other's code, have folders of their own.

    Args:
        function: the kernel in Python.
        file: which it is in.
    """

    def __init__(self, function: Callable, file: Path) -> None:
        self.line = function.__code__.co_firstlineno
        self.digest = digest(file)
        self.folder = caches.folder() / "kernels" / file.relative_to(ROOT) / self.digest

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
    """Of a file of coilset, all that it imports of coilset, directly or not, and what compiles it, in hexadecimals."""
    found, waiting = {file}, [file]
    while waiting:
        new = source(waiting.pop()).imported - found
        found |= new
        waiting += new
    contents = b"".join(source(path).digest for path in sorted(found))
    return hashlib.sha256(contents + caches.toolchain().encode()).hexdigest()[:16]


class Source(NamedTuple):
    """A file of coilset: the digest of its path and content, and the files of coilset that it imports."""

    digest: bytes
    imported: frozenset[Path]


@functools.cache
def source(file: Path) -> Source:
    """What a file holds, read once."""
    text = file.read_text(encoding="utf-8")
    files = (path for module, names in IMPORTS.findall(text) for path in _files(module, names) if path.exists())
    return Source(hashlib.sha256(f"{file.relative_to(ROOT)}\n{text}".encode()).digest(), frozenset(files))


def _files(module: str, names: str) -> Iterator[Path]:
    """Of `from coilset.module import names`, where a name may be a module, too."""
    base = ROOT / module.replace(".", "/")
    if base.is_dir():
        yield base / "__init__.py"
        yield from (base / f"{name}.py" for name in re.findall(r"\w+", names))
    else:
        yield base.with_suffix(".py")


def _none_if_damaged(owner: Any, name: str, otherwise: Callable[[], Any]) -> None:
    """A file of the cache that cannot be read, as after a crash of the machine, is not there: it is compiled again."""
    if (own := getattr(owner, name, None)) is None:
        return  # a version of numba without it

    @functools.wraps(own)
    def read(*arguments: Any) -> Any:
        try:
            return own(*arguments)
        except Exception:
            return otherwise()

    setattr(owner, name, read)


_none_if_damaged(caching.IndexDataCacheFile, "_load_index", dict)
_none_if_damaged(caching.Cache, "_load_overload", lambda: None)

if PLACES is not None:
    PLACES.insert(0, ByContent)
