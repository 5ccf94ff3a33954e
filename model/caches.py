"""Where compiled functions are kept between runs, and how they are loaded."""

import functools
import hashlib
import os
import sys
from pathlib import Path
from typing import Any

SOURCES = Path(__file__).resolve().parent


def keep_by_content() -> None:
    """Give each version of the compiled functions a folder of its own in numba's cache.

    Numba compiles a function anew when its own file changes, but not when one that it calls does, and would go on with
    what it compiled against the old one.
    """
    content = hashlib.sha256()
    for path in sorted(SOURCES.rglob("*.py")):
        text = path.read_bytes()
        if b"njit" in text:
            content.update(text)
    root = os.environ.get("NUMBA_CACHE_DIR") or Path.home() / ".cache" / "coilset" / "numba"
    version = content.hexdigest()[:16]
    if Path(root).name != version:  # a process started by this one has it already
        os.environ["NUMBA_CACHE_DIR"] = str(Path(root) / version)
    if "numba" in sys.modules:  # it has read its environment
        sys.modules["numba"].config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]


def load_without_compiler() -> None:
    """Have numba load what it has compiled without setting up its compiler first, which takes longer than all else.

    Compiled functions need numba's runtime, which is set up here. The compiler is set up when it is used: by numba
    itself, before it compiles anything. So are the modules of numba whose functions were compiled into ours.
    """
    from numba.core import caching, entrypoints, environment
    from numba.core.runtime import rtsys

    def load_overload(cache: Any, signature: Any, target: Any) -> Any:
        """As numba's own, but for the compiler."""
        if not ready:
            rtsys.initialize(target)
            ready.append(True)
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(signature, target)

    @functools.wraps(environment._rebuild_env)  # under whose name it is called by what was kept
    def rebuild(module: str, constants: list, name: str) -> Any:
        """As numba's own, but for the module of a function that was compiled into another, which is not loaded.

        Only code that works on Python's objects reads its globals, and none of these functions does.
        """
        found = environment.lookup_environment(name)
        if found is None:
            there = sys.modules.get(module)
            found = environment.Environment(vars(there) if there else {"__name__": module})
            found.consts[:] = constants
            found.env_name = name
            environment.Environment._memo[name] = found
        return found

    ready: list[bool] = []
    if all(hasattr(caching.Cache, name) for name in ("load_overload", "_load_overload")):
        caching.Cache.load_overload = load_overload
    environment._rebuild_env = rebuild
    entrypoints._already_initialized = True  # no extensions of numba: it would look through all installed packages
