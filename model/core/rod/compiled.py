"""The rod's forms, compiled once per process: all rods share them, each with its own fields.

What a form was compiled into is also written down: building the forms in UFL, only to find that FFCx has compiled them
before, takes 30 ms.
"""

import contextlib
import hashlib
import json
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import basix.ufl
import dolfinx
import ffcx
import numpy as np
import ufl
from dolfinx import default_scalar_type, fem, jit
from mpi4py import MPI

from coilset.model.core.rod import element_kernel, elements, forms
from coilset.model.core.rod.element_kernel import PROCESSOR, ElementKernel, Loop
from coilset.model.core.rod.elements import Element

_kept: dict[Element, "CompiledForms"] = {}  # as soon as this process has needed them
SOURCES = tuple(Path(str(module.__file__)) for module in (sys.modules[__name__], forms, element_kernel, elements))


@dataclass(frozen=True)
class Compiled:
    """A form that was compiled.

    Attributes:
        module: the file of its loop over the elements, see element_kernel.
        fields: names in forms.FIELDS of the coefficients that the loop reads, in its order.
    """

    module: str
    fields: tuple[str, ...]


@dataclass(frozen=True)
class CompiledForms:
    """Forms that are not yet bound to a mesh.

    Attributes:
        residual, tangent: Compiled.
        loops: of residual and tangent over the elements.
        unknowns: of an element.
    """

    residual: Compiled
    tangent: Compiled
    loops: tuple[Loop, Loop]
    unknowns: int

    def on(
        self, fields: Mapping[str, np.ndarray], x: np.ndarray, nodes: np.ndarray
    ) -> tuple[ElementKernel, ElementKernel]:
        """Residual and tangent of a rod's elements, shapes (elements, k) and (elements, k, k).

        Args:
            fields: values by their names in forms.FIELDS, shape (cells, …); read at each evaluation.
            x, nodes: positions of the nodes and the cells' nodes, as in ElementKernel.
        """

        def kernel(compiled: Compiled, loop: Loop, rank: int) -> ElementKernel:
            return ElementKernel(loop, [fields[name] for name in compiled.fields], x, nodes, (self.unknowns,) * rank)

        return kernel(self.residual, self.loops[0], 1), kernel(self.tangent, self.loops[1], 2)


def compiled_forms(comm: MPI.Comm, element: Element) -> CompiledForms:
    """The forms for rods of a communicator; collective.

    Where one rank does not have them, all ranks compile them together.

    Args:
        comm: communicator of the rods' mesh.
        element: of the rods.
    """
    if element not in _kept:
        _kept.update(_recorded(element))
    if not comm.allreduce(element in _kept, op=MPI.LAND):
        compiled = _compile(comm, element)
        _kept[element] = _loaded(*compiled, element)
        _write(compiled, element)
    return _kept[element]


def _recorded(element: Element) -> dict[Element, CompiledForms]:
    """What an earlier process has compiled; nothing if there is no record, or none of use."""
    with contextlib.suppress(OSError, ImportError, ValueError, KeyError, TypeError):
        parts = json.loads(_record(element).read_text())
        residual, tangent = (Compiled(one["module"], tuple(one["fields"])) for one in parts)
        return {element: _loaded(residual, tangent, element)}
    return {}


def _write(compiled: tuple[Compiled, Compiled], element: Element) -> None:
    record = _record(element)
    with contextlib.suppress(OSError):  # the next process compiles again
        partial = record.with_suffix(f".{os.getpid()}")
        partial.write_text(json.dumps([vars(one) for one in compiled]))
        os.replace(partial, record)


def _record(element: Element) -> Path:
    """The file that lists what the forms were compiled into; its name depends on all that this depends on."""
    versions = [module.__version__ for module in (ufl, basix, ffcx, dolfinx)]
    options = sorted((name, str(value)) for name, value in ffcx.get_options(_options()).items())
    content = repr([*(path.read_text(encoding="utf-8") for path in SOURCES), versions, options, PROCESSOR, element])
    return jit.get_options()["cache_dir"] / f"coilset_forms_{hashlib.sha256(content.encode()).hexdigest()[:16]}.json"


def _options() -> dict[str, type]:
    return {"scalar_type": default_scalar_type}


def _loaded(residual: Compiled, tangent: Compiled, element: Element) -> CompiledForms:
    loops = element_kernel.load(residual.module), element_kernel.load(tangent.module)
    return CompiledForms(residual, tangent, loops, element.unknowns)


def _compile(comm: MPI.Comm, element: Element) -> tuple[Compiled, Compiled]:
    mesh = ufl.Mesh(basix.ufl.element("Lagrange", "interval", 1, shape=(3,)))
    V = ufl.FunctionSpace(mesh, forms.cell_element((element.unknowns,)))
    spaces = {name: ufl.FunctionSpace(mesh, one) for name, one in forms.field_elements(element).items()}
    fields = {name: ufl.Coefficient(space) for name, space in spaces.items()}
    rod, names = forms.RodForms(element, mesh, V, **fields), {field: name for name, field in fields.items()}

    def compiled(form: ufl.Form) -> Compiled:
        made = fem.compile_form(comm, form, _options())
        places = made.ufcx_form.original_coefficient_positions[0 : made.ufcx_form.num_coefficients]
        used = tuple(names[form.coefficients()[place]] for place in places)
        return Compiled(str(element_kernel.make(comm, made)), used)

    return compiled(rod.residual), compiled(rod.tangent)
