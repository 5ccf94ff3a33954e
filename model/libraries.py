"""How libraries are loaded: in the order that wheels need, and not at all what no command uses."""

import os
import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader, find_spec
from types import ModuleType

UNUSED = ("dolfinx.utils", "dolfinx.nls", "dolfinx.plot", "coverage")
"""Modules that others import without using them; these take as long to load as all of coilset's own."""


class WhenUsed(MetaPathFinder):
    """Finds the modules in UNUSED and has them loaded when something of them is used."""

    def find_spec(self, name: str, path: object = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """As the usual finder's, but with the loader that waits."""
        spec = PathFinder.find_spec(name, path, target) if name in UNUSED else None  # type: ignore[arg-type]
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec


def load_when_used() -> None:
    """Put off what is in UNUSED, and have no library look through all installed ones for its plug-ins."""
    sys.meta_path.insert(0, WhenUsed())
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def load_in_order() -> None:
    """Load what must come before DOLFINx where that is the wheel `dolfinx-solver-real` of PyPI; nothing elsewhere.

    The wheel brings an HDF5 of its own: h5py finds it in place of its own if it comes second, and fails. And it has
    neither MPI nor a path to it: `dolfinx_solver` loads the MPI that mpi4py uses.
    """
    if find_spec("dolfinx_solver"):
        import h5py  # noqa: F401, I001
        import dolfinx_solver  # noqa: F401
