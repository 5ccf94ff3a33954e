"""Iteration methods as PETSc SNES option sets, and the solve of one step."""
