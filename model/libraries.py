"""The order in which libraries must be loaded where they come from wheels."""

from importlib.util import find_spec


def load_in_order() -> None:
    """Load what must come before DOLFINx where that is the wheel `dolfinx-solver-real` of PyPI; nothing elsewhere.

    The wheel brings an HDF5 of its own: h5py finds it in place of its own if it comes second, and fails. And it has
    neither MPI nor a path to it: `dolfinx_solver` loads the MPI that mpi4py uses.
    """
    if find_spec("dolfinx_solver"):
        import h5py  # noqa: F401, I001
        import dolfinx_solver  # noqa: F401
