"""A solid body on its own, without a solver: its forces and its tangent."""

from dolfinx import la
from dolfinx.fem.petsc import assemble_matrix


def internal_forces(solid):
    """Internal forces at the current increment, shape (owned blocks, 3), N."""
    forces = la.vector(solid.V.dofmap.index_map, 3)
    solid.internal_forces(forces.array)
    forces.scatter_reverse(la.InsertMode.add)
    return forces.array.reshape(-1, 3)[: solid.configuration.owned].copy()


def tangent(solid, conditions=()):
    """The tangent at the current increment; constrained rows and columns are those of the identity."""
    A = solid.create_matrix(0)
    if conditions:
        assemble_matrix(A, solid.forms.tangent, bcs=list(conditions))
    else:
        solid.tangent(A)
    A.assemble()
    return A


def commit(solid):
    """Make the trial state the equilibrium."""
    solid.state.commit()
    solid.u[:] = 0.0
