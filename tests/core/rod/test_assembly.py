"""What the compiled loops over the elements assemble, against DOLFINx's own assembly of the same UFL forms."""

import numpy as np
import pytest
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from coilset.model.core.contact.base import Contribution
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.matrix import TangentMatrix
from coilset.model.core.rod import element_kernel, forms
from coilset.model.core.rod.elements import MIXED, THESIS

ELEMENTS = 11  # no multiple of the elements that go through together


@pytest.fixture(params=[(8, MIXED), (256, THESIS)], ids=["in blocks", "at once"])
def bent(make_rod, request, monkeypatch):
    """A helix that is bent, sheared and plastic: finite rotations at random."""
    monkeypatch.setattr(element_kernel, "BLOCK", request.param[0])
    turns = np.linspace(0.0, 1.3, ELEMENTS + 1)
    stations = np.stack([20.0 * np.cos(2 * np.pi * turns), 20.0 * np.sin(2 * np.pi * turns), 12.0 * turns], axis=1)
    rod = make_rod(stations, element=request.param[1])
    rod.increment.x.array[:] = np.random.default_rng(0).normal(scale=0.02, size=len(rod.increment.x.array))
    assert rod.update()
    assert (rod.point_state[..., 6] > 0.0).any()
    rod.predict(0.1 * rod.increment.x.array)  # other forces than those of the state, so that they are not mixed up
    return rod


def matrix_of(rod, size):
    """A matrix into which DOLFINx and PETSc insert by local numbers."""
    matrix, numbers = rod.create_matrix(size), np.arange(size, dtype=PETSc.IntType)
    matrix.setLGMap(*(PETSc.LGMap().create(numbers, comm=rod.comm) for _ in range(2)))
    return matrix


def by_dolfinx(rod):
    """Residual and tangent as DOLFINx assembles them."""
    elements = forms.field_elements(rod.element).values()
    fields = [fem.Function(fem.functionspace(rod.mesh, one)) for one in elements]
    for function, name in zip(fields, forms.FIELDS, strict=True):
        function.x.array[:] = getattr(rod.coefficients, name).ravel()
    unknowns = rod.element.unknowns
    V = fem.functionspace(rod.mesh, forms.cell_element((unknowns,)))  # each element by itself
    rod_forms = forms.RodForms(rod.element, rod.mesh, V, *fields)
    vector, dofs = np.zeros(len(rod.increment.x.array)), rod.element_dofs
    np.add.at(vector, dofs, fem.assemble_vector(fem.form(rod_forms.residual)).array.reshape(-1, unknowns))
    alone = assemble_matrix(fem.form(rod_forms.tangent))
    alone.assemble()
    matrix, places = matrix_of(rod, len(vector)), np.arange(len(dofs) * unknowns, dtype=PETSc.IntType)
    blocks = np.array([alone.getValues(own, own) for own in places.reshape(-1, unknowns)])
    matrix.setValuesLocalRCV(dofs, dofs, blocks, addv=PETSc.InsertMode.ADD_VALUES)
    matrix.assemble()
    return vector, matrix


def test_the_loops_assemble_what_dolfinx_does(bent):
    """To 1e-13 of the largest entry: the same products and sums in another order."""
    own = matrix_of(bent, len(bent.increment.x.array))
    insert(bent, own)
    assert np.abs(bent.coefficients.predicted - bent.coefficients.s).max() > 0.01 * np.abs(bent.coefficients.s).max()
    vector, matrix = by_dolfinx(bent)
    found = np.zeros_like(vector)
    bent.internal_forces(found)
    np.testing.assert_allclose(found, vector, rtol=0.0, atol=1e-13 * np.abs(vector).max())
    own.assemble()
    own.axpy(-1.0, matrix)
    assert own.norm(PETSc.NormType.INFINITY) < 1e-13 * matrix.norm(PETSc.NormType.INFINITY)


def insert(rod, matrix, share=1.0):
    """The elements' tangents as PETSc inserts them, with the forces predicted after a share of the correction."""
    for cells, tangents in rod.element_tangents(share):
        dofs = rod.element_dofs[cells]
        matrix.setValuesLocalRCV(dofs, dofs, tangents, addv=PETSc.InsertMode.ADD_VALUES)


def test_an_element_does_not_depend_on_those_beside_it(bent):
    """The same bits, whichever elements go through together."""
    first = next(bent.element_tangents())[1][0].copy()
    for name in forms.FIELDS.keys() - {"xi", "timoshenko_factor"}:
        getattr(bent.coefficients, name)[1:] = 1e3
    np.testing.assert_array_equal(next(bent.element_tangents())[1][0], first)


def by_petsc(rod, layout, part, share):
    """Tangent and contacts as PETSc inserts them, dense."""
    matrix = matrix_of(rod, layout.size)
    matrix.setPreallocationNNZ(layout.size)
    insert(rod, matrix, share)
    dofs = layout.contact_dofs[part.dofs]
    matrix.setValuesRCV(dofs, dofs, part.stiffness, addv=PETSc.InsertMode.ADD_VALUES)
    matrix.assemble()
    return dense(matrix, layout.size)


def dense(matrix, n):
    """Entries of the first unknowns."""
    return matrix.getValues(range(n), range(n))


def test_entries_are_added_where_they_lie_as_petsc_inserts_them(bent):
    """Elements as DOLFINx assembles them, contacts as PETSc inserts them, also where they open; where they close at new
    places the rows are allocated anew. Rows that are held are those of the identity."""
    layout, random, held = LineLayout(bent), np.random.default_rng(1), np.array([4, 11])
    matrix, n, size, share = TangentMatrix(bent, layout), len(bent.increment.x.array), layout.size, 0.5
    free = np.setdiff1d(np.arange(size), held)
    dofs = np.array([[0, 1, 2, 27, 28, 29], [3, 4, 5, 30, 31, 32], [6, 7, 8, 33, 34, 35]])
    none = np.empty(3)
    contacts = Contribution(dofs, none, random.normal(scale=1e5, size=(3, 6, 6)), none, none, none, none)
    for closed, version in (([], 1), ([0, 1], 2), ([1, 0], 2), ([1], 2), ([0, 1, 2], 3), ([], 3)):
        part = contacts.only(np.array(closed, dtype=int))
        matrix.fill([part], share=share)
        found, right = dense(matrix.mat, size), by_petsc(bent, layout, part, share)
        np.testing.assert_allclose(found, right, rtol=0.0, atol=1e-13 * np.abs(right).max())
        assert matrix.version == version
        matrix.hold(held)
        by_row = dense(matrix.mat, size)
        np.testing.assert_array_equal(by_row[held], bent.constraint_weight * np.eye(size)[held])
        np.testing.assert_array_equal(by_row[free], found[free])
        share += 0.5
    matrix.fill([], share=share)
    right = dense(by_dolfinx(bent)[1], n)
    np.testing.assert_allclose(dense(matrix.mat, n), right, rtol=0.0, atol=1e-13 * np.abs(right).max())


def test_two_kinds_of_contact_between_the_same_first_and_last_unknown_are_kept_apart(bent):
    """As the friction of a station on both seats: only the unknowns between these differ."""
    layout, random = LineLayout(bent), np.random.default_rng(2)
    matrix, size, none = TangentMatrix(bent, layout), layout.size, np.empty(1)
    parts = [
        Contribution(np.array([[0, seat, 60]]), none, random.normal(scale=1e5, size=(1, 3, 3)), none, none, none, none)
        for seat in (38, 44)
    ]
    matrix.fill(parts, share=0.5)
    bare = TangentMatrix(bent, layout)
    bare.fill([], share=0.5)
    right = dense(bare.mat, size)
    for part in parts:
        unknowns = layout.contact_dofs[part.dofs[0]]
        right[np.ix_(unknowns, unknowns)] += part.stiffness[0]
    np.testing.assert_allclose(dense(matrix.mat, size), right, rtol=0.0, atol=1e-13 * np.abs(right).max())
