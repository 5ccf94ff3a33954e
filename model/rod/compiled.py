"""The rod's forms, compiled once per process: all rods share them, each with its own fields."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import default_scalar_type, fem
from mpi4py import MPI

from coilset.model.rod import element_kernel, forms
from coilset.model.rod.element_kernel import ElementKernel, Loop

UNKNOWNS = 14  # of an element: two nodes with 6, and two shear angles


@dataclass(frozen=True)
class CompiledForms:
    """Forms that are not yet bound to a mesh.

    Attributes:
        coefficients: of the fields by their names in forms.FIELDS.
        residual, tangent: DOLFINx's CompiledForm.
        loops: of residual and tangent over the elements.
    """

    coefficients: Mapping[str, ufl.Coefficient]
    residual: Any
    tangent: Any
    loops: tuple[Loop, Loop]

    def on(
        self, fields: Mapping[str, np.ndarray], x: np.ndarray, nodes: np.ndarray
    ) -> tuple[ElementKernel, ElementKernel]:
        """Residual and tangent of a rod's elements, shapes (elements, 14) and (elements, 14, 14).

        Args:
            fields: values by their names in forms.FIELDS, shape (cells, …); read at each evaluation.
            x, nodes: positions of the nodes and the cells' nodes, as in ElementKernel.
        """
        of = {coefficient: fields[name] for name, coefficient in self.coefficients.items()}

        def kernel(compiled: Any, loop: Loop, rank: int) -> ElementKernel:
            used = [of[coefficient] for coefficient in compiled.ufl_form.coefficients()]
            return ElementKernel(compiled, loop, used, x, nodes, (UNKNOWNS,) * rank)

        return kernel(self.residual, self.loops[0], 1), kernel(self.tangent, self.loops[1], 2)


def compiled_forms(comm: MPI.Comm) -> CompiledForms:
    """The forms for rods of a communicator; collective.

    On several ranks they are looked up each time, since one rank's cache may hold forms that another's does not.

    Args:
        comm: communicator of the rods' mesh.
    """
    return _kept() if comm.size == 1 else _compile(comm)


@lru_cache
def _kept() -> CompiledForms:
    return _compile(MPI.COMM_SELF)


def _compile(comm: MPI.Comm) -> CompiledForms:
    mesh = ufl.Mesh(basix.ufl.element("Lagrange", "interval", 1, shape=(3,)))
    V = ufl.FunctionSpace(mesh, forms.rod_element())
    fields = {name: ufl.Coefficient(ufl.FunctionSpace(mesh, element())) for name, element in forms.FIELDS.items()}
    rod = forms.RodForms(mesh, V, **fields)
    residual, tangent = (
        fem.compile_form(comm, form, {"scalar_type": default_scalar_type})
        for form in (rod.residual, rod.material_stiffness + rod.frame_stiffness)
    )
    loops = element_kernel.load(comm, residual), element_kernel.load(comm, tangent)
    return CompiledForms(fields, residual, tangent, loops)
