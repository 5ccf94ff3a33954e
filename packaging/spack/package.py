"""Recipe for Spack, of the package py-coilset. Untested: the source needs the address and sum of a release."""

from spack.package import *


class PyCoilset(PythonPackage):
    """How far a coil spring sets, and what stress remains in it: an elasto-plastic rod on FEniCSx and PETSc."""

    version("main", branch="main")

    depends_on("python@3.11:", type=("build", "run"))
    depends_on("py-setuptools@68:", type="build")
    depends_on("fenics-dolfinx@0.9: +petsc +slepc", type="run")
    depends_on("py-fenics-dolfinx@0.9:", type="run")
    depends_on("py-petsc4py", type="run")
    depends_on("py-slepc4py", type="run")
    depends_on("py-mpi4py", type="run")
    depends_on("gmsh", type="run")
    for name in ("h5netcdf", "h5py", "jinja2", "matplotlib", "numba", "numpy", "pillow", "plotly", "pydantic@2.5:"):
        depends_on(f"py-{name}", type=("build", "run"))
    for name in ("pyvista", "pyyaml", "rich", "scipy", "typer", "xarray", "meshio", "cffi"):
        depends_on(f"py-{name}", type=("build", "run"))
