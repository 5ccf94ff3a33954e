"""Where compiled functions are kept between runs, and how they are loaded."""

import contextlib
import functools
import hashlib
import os
import platform
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from coilset.model.core.runtime.switches import enabled

SOURCES = Path(__file__).resolve().parents[2]  # all of model


def folder() -> Path:
    """Where compiled functions of coilset are kept; those of a user's own stay where numba keeps them.

    `NUMBA_CACHE_DIR`, if it is set, is for both.
    """
    if given := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(given)
    cache = os.environ.get("COILSET_CACHE") or Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache", "coilset")
    release = os.environ.get("COILSET_RELEASE")
    return Path(cache).expanduser() / (f"numba-{release}" if release else "numba")


@functools.cache
def version() -> str:
    """Of all compiled functions, by the content of their files, in hexadecimals."""
    content = hashlib.sha256()
    for path in sorted(SOURCES.rglob("*.py")):
        text = path.read_bytes()
        if b"njit" in text:
            content.update(text)
    return content.hexdigest()[:16]


@functools.cache
def toolchain() -> str:
    """What machine code depends on besides its source, in hexadecimals: Python, numba, llvmlite and the processor."""
    parts = [sys.version, sys.prefix, _processor()]
    for package in ("numba", "llvmlite"):
        for folder in getattr(find_spec(package), "submodule_search_locations", None) or ():
            with contextlib.suppress(OSError):  # numba's own index has its version, too
                parts.append((Path(folder) / "_version.py").read_text(encoding="utf-8"))
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


def _processor() -> str:
    """Name and abilities of the first processor, as Linux has them."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            lines = iter(file.readline, "\n")
            return "".join(
                line for line in lines if line.startswith(("vendor", "model name", "flags", "Features", "CPU"))
            )
    except OSError:
        return platform.machine()


def load_without_compiler() -> None:
    """Load compiled functions without setting up numba's compiler first, which takes longer than the rest.

    A version of numba that has no such function, or no such flag, loads as it always does.
    """
    from numba.core import entrypoints

    for name, change in (
        ("compiler", _set_up_when_compiling),
        ("bitcode", _link_when_compiling),
        ("imports", _import_nothing),
    ):
        if enabled(name):
            change()
    if enabled("compiler") and hasattr(entrypoints, "_already_initialized"):
        entrypoints._already_initialized = True  # no extensions of numba: it would look through all installed packages


def _set_up_when_compiling() -> None:
    """Compiled functions need numba's runtime, which is set up here; its compiler is set up before it is used."""
    from numba.core.caching import Cache
    from numba.core.runtime import rtsys

    def load_overload(cache: Any, signature: Any, target: Any) -> Any:
        """As numba's own, but for the compiler."""
        if not ready:
            rtsys.initialize(target)
            ready.append(True)
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(signature, target)

    ready: list[bool] = []
    if all(hasattr(Cache, name) for name in ("load_overload", "_load_overload")):
        Cache.load_overload = load_overload


def _link_when_compiling() -> None:
    """Beside machine code numba keeps bitcode, for callers that are compiled later; it is parsed when there is one.

    It takes twice as long as all else of the loading.
    """
    from llvmlite import binding
    from numba.core.codegen import CPUCodeLibrary, JitEngine
    from numba.core.compiler import CompileResult

    def rebuild(target: Any, kept: tuple, function: Any, *rest: Any) -> Any:
        """As numba's own, with an empty module in place of the bitcode."""
        name, kind, (code, bitcode) = kept
        engine = target.codegen()._engine
        engine._defined_symbols |= {function.llvm_cpython_wrapper_name, function.llvm_cfunc_wrapper_name}
        empty = binding.parse_assembly("").as_bitcode()
        made = own(target, (name, kind, (code, empty)), function, *rest)

        def module_for_linking() -> Any:
            del made.library._get_module_for_linking  # numba's own comes to light again
            made.library._shared_module = binding.parse_bitcode(bitcode)
            engine._load_defined_symbols(made.library._shared_module)
            return made.library._shared_module

        made.library._get_module_for_linking = module_for_linking
        return made

    needed = (
        (CompileResult, "_rebuild"),
        (CPUCodeLibrary, "_get_module_for_linking"),
        (JitEngine, "_load_defined_symbols"),
    )
    if all(hasattr(owner, name) for owner, name in needed):
        own = CompileResult._rebuild
        CompileResult._rebuild = staticmethod(rebuild)


def _import_nothing() -> None:
    """The module of a function that was compiled into another is not loaded.

    Only code that works on Python's objects reads its globals, and none of these functions does.
    """
    from numba.core import environment

    def rebuild(module: str, constants: list, name: str) -> Any:
        """As numba's own, but for the module."""
        found = environment.lookup_environment(name)
        if found is None:
            there = sys.modules.get(module)
            found = environment.Environment(vars(there) if there else {"__name__": module})
            found.consts[:] = constants
            found.env_name = name
            environment.Environment._memo[name] = found
        return found

    if hasattr(environment, "_rebuild_env"):  # under whose name what is kept calls it
        environment._rebuild_env = functools.wraps(environment._rebuild_env)(rebuild)
