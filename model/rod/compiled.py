"""The rod's forms, compiled once in a process: every rod has the same ones, on a mesh and with fields of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import basix.ufl
import ufl
from dolfinx import default_scalar_type, fem
from mpi4py import MPI

from coilset.model.rod import forms


@dataclass(frozen=True)
class CompiledForms:
    """Forms that stand for no mesh yet.

    Attributes:
        coefficients: of the fields, in the order of RodForms.
        residual, tangent: compiled.
    """

    coefficients: Sequence[ufl.Coefficient]
    residual: Any
    tangent: Any

    def on(self, V: fem.FunctionSpace, fields: Sequence[fem.Function]) -> tuple[fem.Form, fem.Form]:
        """Residual and tangent of a rod.

        Args:
            V: its space of rod_element.
            fields: its fields, in the order of RodForms.
        """
        mapped = dict(zip(self.coefficients, fields, strict=True))

        def create(compiled: Any, rank: int) -> fem.Form:
            used = {one: mapped[one] for one in compiled.ufl_form.coefficients()}
            return fem.create_form(compiled, [V] * rank, V.mesh, {}, used, {})

        return create(self.residual, 1), create(self.tangent, 2)


def compiled_forms(comm: MPI.Comm, elements: tuple[Any, ...]) -> CompiledForms:
    """The forms for rods of a communicator; collective.

    Several ranks look for them each time: what one rank keeps, another one may not have met.

    Args:
        comm: communicator of the rods' mesh.
        elements: of the fields, in the order in which their functions are made: the generated code depends on it.
    """
    return _kept(elements) if comm.size == 1 else _compile(comm, elements)


@lru_cache
def _kept(elements: tuple[Any, ...]) -> CompiledForms:
    return _compile(MPI.COMM_SELF, elements)


def _compile(comm: MPI.Comm, elements: tuple[Any, ...]) -> CompiledForms:
    mesh = ufl.Mesh(basix.ufl.element("Lagrange", "interval", 1, shape=(3,)))
    V = ufl.FunctionSpace(mesh, forms.rod_element())
    *others, D, foreseen = (ufl.Coefficient(ufl.FunctionSpace(mesh, element)) for element in elements)
    fields = [*others, foreseen, D]
    rod = forms.RodForms(mesh, V, *fields)
    residual, tangent = (
        fem.compile_form(comm, form, {"scalar_type": default_scalar_type})
        for form in (rod.residual, rod.material_stiffness + rod.frame_stiffness)
    )
    return CompiledForms(fields, residual, tangent)
