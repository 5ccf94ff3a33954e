"""What the compiled loops over the elements assemble, against DOLFINx's own assembly of the same UFL forms."""

import numpy as np
import pytest
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from coilset.model.rod import forms

ELEMENTS = 11  # no multiple of the elements that go through together


@pytest.fixture
def bent(make_rod):
    """A helix that is bent, sheared and plastic: finite rotations at random."""
    turns = np.linspace(0.0, 1.3, ELEMENTS + 1)
    stations = np.stack([20.0 * np.cos(2 * np.pi * turns), 20.0 * np.sin(2 * np.pi * turns), 12.0 * turns], axis=1)
    rod = make_rod(stations)
    rod.increment.x.array[:] = np.random.default_rng(0).normal(scale=0.02, size=len(rod.increment.x.array))
    assert rod.update()
    assert (rod.point_state[..., 6] > 0.0).any()
    rod.foreseen.values[:] *= 1.1  # other forces than those of the state, so that they cannot be taken for each other
    return rod


def by_dolfinx(rod):
    """Residual and tangent as DOLFINx assembles them."""
    fields = [fem.Function(fem.functionspace(rod.mesh, element())) for element in forms.FIELDS.values()]
    own = (rod.xi, rod.timoshenko_factor, rod.triads, rod.T, rod.P, rod.W, rod.e, rod.s, rod.foreseen, rod.D)
    for function, field in zip(fields, own, strict=True):
        function.x.array[:] = field.values.ravel()
    rod_forms = forms.RodForms(rod.mesh, rod.V, *fields)
    vector = fem.assemble_vector(fem.form(rod_forms.residual)).array
    matrix = rod.create_matrix(len(vector))
    assemble_matrix(matrix, fem.form(rod_forms.material_stiffness + rod_forms.frame_stiffness))
    matrix.assemble()
    return vector, matrix


def test_the_loops_assemble_what_dolfinx_does(bent):
    """To 1e-13 of the largest entry: the same products and sums in another order."""
    vector, matrix = by_dolfinx(bent)
    found = np.zeros_like(vector)
    bent.internal_forces(found)
    np.testing.assert_allclose(found, vector, rtol=0.0, atol=1e-13 * np.abs(vector).max())
    own = bent.create_matrix(len(vector))
    bent.tangent(own)
    own.assemble()
    own.axpy(-1.0, matrix)
    assert own.norm(PETSc.NormType.INFINITY) < 1e-13 * matrix.norm(PETSc.NormType.INFINITY)


def test_an_element_does_not_depend_on_those_beside_it(bent):
    """The same bits, whichever elements go through together."""
    whole = bent._tangent().copy()
    for field in (bent.triads, bent.T, bent.P, bent.W, bent.e, bent.s, bent.foreseen, bent.D):
        field.values[1:] = 1e3
    np.testing.assert_array_equal(bent._tangent()[0], whole[0])
