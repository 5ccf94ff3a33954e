"""Local numbers of a rod's unknowns; their positions in PETSc's vectors are those of its LineLayout."""

from typing import NamedTuple

import numpy as np
from dolfinx import fem

from coilset.model.core.base.compat import geometry_dofs


class Numbering(NamedTuple):
    """Numbers of the unknowns in the functions of a rod's space.

    Attributes:
        u, rotations: displacements and rotation charts of the local nodes, shape (nodes, 3).
        own: the owned cells' own unknowns, excess shear angles first, shape (cells, own).
        elements: all unknowns of the owned cells, shape (cells, 12 + own).
    """

    u: np.ndarray
    rotations: np.ndarray
    own: np.ndarray
    elements: np.ndarray

    @classmethod
    def of(cls, V: fem.FunctionSpace, cells: int) -> "Numbering":
        """Of a space of coilset.model.core.rod.forms.rod_element.

        Args:
            cells: how many cells this rank owns.
        """
        nodes = geometry_dofs(V.mesh)
        u, rotations = np.empty((2, len(V.mesh.geometry.x), 3), dtype=np.int32)
        nodal, own = V.sub(0), V.sub(1)
        for i in range(3):
            u[nodes, i] = nodal.sub(i).dofmap.list
            rotations[nodes, i] = nodal.sub(i + 3).dofmap.list
        parts = [own.sub(i).dofmap.list[:cells, 0] for i in range(own.num_sub_spaces)]
        return cls(u, rotations, np.stack(parts, axis=1), V.dofmap.list[:cells])
