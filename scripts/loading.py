"""What a solve loads, in an order in which two threads can load it."""

from coilset.model.runtime.libraries import link_beside


def load_for_solve() -> None:
    """Load what needs the linker itself, have MPI, PETSc and DOLFINx linked, and load what needs neither.

    The thread that links then sets up what numba's compiled functions call, which takes LLVM 15 ms.
    """
    import decimal  # noqa: F401
    import queue  # noqa: F401
    import zoneinfo  # noqa: F401

    import pydantic_core  # noqa: F401
    from numba.core.registry import cpu_target
    from numba.core.runtime import rtsys

    target = cpu_target.target_context  # made when it is asked for, with LLVM
    link_beside(lambda: rtsys.initialize(target))
    import pydantic.main  # noqa: F401
    import ufl  # noqa: F401

    import coilset.model.contact.build
    import coilset.model.rod.finer_path
    import coilset.model.standards.case_warnings  # noqa: F401
