"""Finite rotations: rotation vectors, their matrices, and the chart in which PETSc may add them."""
