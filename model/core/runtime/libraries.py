"""Import order, linking by a second thread, and lazy imports."""

import ctypes
import os
import sys
import threading
from collections.abc import Callable, Sequence
from importlib.machinery import EXTENSION_SUFFIXES, ModuleSpec, PathFinder
from importlib.util import find_spec
from types import ModuleType
from typing import Any

from coilset.model.core.runtime.apart import thread_elsewhere
from coilset.model.core.runtime.switches import enabled

UNUSED = ("dolfinx.utils", "dolfinx.nls", "dolfinx.plot", "coverage", "meshio._cli")
"""Modules that others import without using them; these take as long to load as all of coilset's own."""


class LazyModule(ModuleType):
    """A module that is loaded at the first use of an attribute; Python's LazyLoader loads at a second import, too."""

    def __getattr__(self, name: str) -> Any:
        """An attribute, once the module is loaded; importing or listing the module does not load it."""
        spec = self.__spec__
        if spec is None or (name.startswith("__") and name not in ("__all__", "__version__")):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        self.__class__ = ModuleType  # type: ignore[assignment]
        spec.loader_state.exec_module(self)
        return getattr(self, name)


class LazyFinder:
    """Finder and loader of modules that wait.

    Args:
        names: of these modules.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names

    def find_spec(self, name: str, path: Any = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """The usual finder's spec with this loader; None for all other modules."""
        spec = PathFinder.find_spec(name, path) if name in self.names else None
        if spec is not None:
            spec.loader, spec.loader_state = self, spec.loader  # type: ignore[assignment]
        return spec

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """An empty one."""
        return LazyModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Nothing yet."""


def load_lazily() -> None:
    """Import the modules in UNUSED lazily."""
    if enabled("modules"):
        sys.meta_path.insert(0, LazyFinder(UNUSED))


def link_beside(then: Callable[[], object]) -> None:
    """Have another thread link the libraries of MPI, PETSc and DOLFINx, for their modules to find them there.

    It takes 0.2 s, half of it a wait: libpsm2, of Open MPI, measures a clock when it is loaded. Meanwhile Python's
    modules can be loaded, but not such as need the linker, which does one thing at a time. Nothing is done where the
    order matters (`load_in_order`), and nothing is lost where a library has another name.

    UCX, of Open MPI, would put its own code into the functions of the C library that give and take memory while another
    thread is in them, which now and then crashes a process (https://github.com/openucx/ucx/pull/9148), and would wait
    40 ms for that. Only networks that read memory of other machines by themselves need it.

    Args:
        then: what that thread does afterwards.
    """
    if enabled("linking") and not find_spec("dolfinx_solver"):
        os.environ.setdefault("UCX_MEM_EVENTS", "n")
        threading.Thread(target=_link, args=(then,), daemon=True).start()


def _link(then: Callable[[], object]) -> None:
    if not thread_elsewhere():  # UCX reads a file of the working directory when it is linked
        return
    link = ctypes.CDLL(None).dlopen  # in contrast to ctypes' own, called without Python's lock
    for package, module in (("mpi4py", "MPI"), ("dolfinx", "cpp")):
        for folder in getattr(find_spec(package), "submodule_search_locations", None) or ():
            link(os.fsencode(f"{folder}/{module}{EXTENSION_SUFFIXES[0]}"), os.RTLD_NOW)
    then()


def load_in_order() -> None:
    """Load what must come before DOLFINx where that is the wheel `dolfinx-solver-real` of PyPI; nothing elsewhere.

    The wheel brings an HDF5 of its own: h5py finds it in place of its own if it comes second, and fails. And it has
    neither MPI nor a path to it: `dolfinx_solver` loads the MPI that mpi4py uses.
    """
    if find_spec("dolfinx_solver"):
        import h5py  # noqa: F401, I001
        import dolfinx_solver  # noqa: F401
