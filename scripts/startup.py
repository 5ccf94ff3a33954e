"""The start of a command: typer without rich, the first line, and the libraries of a solve."""

import os
import sys
from pathlib import Path

from coilset.model.core.base.version import __version__
from coilset.model.core.runtime.libraries import link_beside
from coilset.model.core.runtime.processes import first_rank
from coilset.model.core.runtime.switches import enabled
from coilset.scripts.terminal.target import results_folder

# rich takes longer to load than everything else that `--help` needs
if enabled("rich"):
    os.environ.setdefault("TYPER_USE_RICH", "0")  # for typer >= 0.17
_LOADED = "rich" in sys.modules or not enabled("rich")
if not _LOADED:
    sys.modules["rich"] = None  # type: ignore[assignment]  # to older ones: rich is not installed

import typer  # noqa: E402

if not _LOADED:
    del sys.modules["rich"]

__all__ = ["announce_begin", "load_for_solve", "typer"]


def announce_begin(file: str, out: str | None) -> None:
    """Print the name of the file that is read, if it exists, before the libraries are loaded.

    Raises:
        InputError: if the results folder cannot be made or written to.
    """
    if os.path.isfile(file) and first_rank():
        results_folder(out, Path(file).stem)
        print(f"coilset {__version__} reads {Path(file).name}", flush=True)


def load_for_solve() -> None:
    """Load the libraries of a solve in an order in which two threads can load them.

    First what needs the linker itself; then another thread links MPI, PETSc and DOLFINx, while this one loads what does
    not need them. That thread then sets up what numba's compiled functions call, which takes LLVM 15 ms.
    """
    import decimal  # noqa: F401
    import queue  # noqa: F401
    import zoneinfo  # noqa: F401

    import pydantic_core  # noqa: F401
    from numba.core.registry import cpu_target
    from numba.core.runtime import rtsys

    target = cpu_target.target_context  # made when it is requested, with LLVM
    link_beside(lambda: rtsys.initialize(target))
    import pydantic.main  # noqa: F401
    import ufl  # noqa: F401

    from coilset.model.compose.parts import installed

    for module in ("physics.accuracy.finer_path", "tools.limits.case_warnings"):
        installed(module)
