"""Libraries look for settings in the working directory when they are loaded; in a command they find none.

A folder that somebody sent could hold such files: `petscrc`, `matplotlibrc`, `.numba_config.yaml`, `ucx.conf`,
`ffcx_options.json`; `dolfinx_jit_options.json` gives the C compiler its arguments, which can run code.
Settings in the user's home folder and in the environment hold as ever.
"""

import contextlib
import ctypes
import os
import sys
from collections.abc import Callable, Iterator
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

SAFE_PATH = "PYTHONSAFEPATH"
"""Variable with which Python does not look for modules in the working directory; commands set it."""
OURS = "coilset"
"""Its value where a command has set it, and not the user."""
CLONE_FS = 0x200  # of Linux's unshare
AFTERWARDS: dict[str, Callable[[Any], object]] = {
    "mpi4py.MPI": bool,
    "petsc4py.PETSc": bool,
    "matplotlib": bool,
    "numba.core.config": bool,
    "dolfinx.jit": lambda module: module._load_options(),  # kept from then on
    "ffcx.options": lambda module: module._load_options(),
}
"""Modules that look for settings, and what is done with each once it is loaded."""


@contextlib.contextmanager
def elsewhere() -> Iterator[None]:
    """The working directory is the root folder, to which strangers do not write."""
    here = os.open(".", getattr(os, "O_PATH", os.O_RDONLY))
    os.chdir("/")
    try:
        yield
    finally:
        os.fchdir(here)
        os.close(here)


def thread_elsewhere() -> bool:
    """Give this thread alone the root folder as working directory; False where Linux refuses, elsewhere nothing."""
    if sys.platform == "linux":
        if ctypes.CDLL(None).unshare(CLONE_FS):
            return False
        os.chdir("/")
    return True


class ApartFinder:
    """Finder and loader of the modules of AFTERWARDS."""

    def find_spec(self, name: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """The usual finder's spec with this loader; None for all other modules."""
        spec = PathFinder.find_spec(name, path) if name in AFTERWARDS else None
        if spec is not None:
            spec.loader, spec.loader_state = self, spec.loader  # type: ignore[assignment]
        return spec

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """As by the usual loader, which links a library here."""
        with elsewhere():
            return spec.loader_state.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """As by the usual loader, which then is the module's own again."""
        spec = module.__spec__
        assert spec is not None
        spec.loader, spec.loader_state = spec.loader_state, None
        module.__loader__ = spec.loader
        with elsewhere():
            spec.loader.exec_module(module)
            with contextlib.suppress(AttributeError):  # a version that has no such function
                AFTERWARDS[module.__name__](module)


def load_apart() -> None:
    """Load what looks for settings in the working directory apart from it, where Python looks for no modules there."""
    if os.environ.get(SAFE_PATH):
        sys.meta_path.insert(0, ApartFinder())
