"""Local numbers of a rod's unknowns; where they lie in PETSc's vectors is said by its LineLayout."""

from dataclasses import dataclass

import numpy as np
from dolfinx import fem

from coilset.model.base.compat import geometry_dofs


@dataclass(frozen=True)
class Numbering:
    """Numbers of the unknowns in the functions of a rod's space.

    Attributes:
        u, rotations: displacements and rotation charts of the local nodes, shape (nodes, 3).
        shear: excess shear angles of the owned cells, shape (cells, 2).
        elements: all unknowns of the owned cells, shape (cells, 14).
    """

    u: np.ndarray
    rotations: np.ndarray
    shear: np.ndarray
    elements: np.ndarray

    @classmethod
    def of(cls, V: fem.FunctionSpace, cells: int) -> "Numbering":
        """Of a space of coilset.model.rod.forms.rod_element.

        Args:
            cells: how many cells this rank owns.
        """
        nodes = geometry_dofs(V.mesh)
        u, rotations = np.empty((2, len(V.mesh.geometry.x), 3), dtype=np.int32)
        nodal, shear = V.sub(0), V.sub(1)
        for i in range(3):
            u[nodes, i] = nodal.sub(i).dofmap.list
            rotations[nodes, i] = nodal.sub(i + 3).dofmap.list
        angles = np.stack([shear.sub(i).dofmap.list[:cells, 0] for i in range(2)], axis=1)
        return cls(u, rotations, angles, V.dofmap.list[:cells])
