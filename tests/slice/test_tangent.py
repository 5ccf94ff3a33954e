"""The slice's tangent, by displacements and by both numbers, is the derivative of its forces: Taylor remainders."""

import numpy as np
import pytest
from dolfinx import fem

from coilset.model.slice.bordered import BorderedMatrix
from coilset.model.slice.contact import SelfContact
from coilset.model.slice.forms import RISE, TURN, assemble

NONE = np.zeros(0, int)


def generalised(body, contact):
    """Forces of all unknowns, h̄ and λ last, of body and contact."""
    forces = np.concatenate([body.forces.ravel(), body.resultants()])
    if contact:
        pressure = contact.evaluate()
        forces += np.concatenate([pressure.forces.ravel(), pressure.numbers])
    return forces


def tangent(body, contact):
    """The whole tangent as a dense array."""
    forms = body.forms
    matrix = BorderedMatrix(forms["tangent"], NONE, contact.blocks if contact else None)
    pressure = contact.evaluate() if contact else None
    more = (matrix.places(pressure.rows, pressure.columns), pressure.values) if contact else None
    columns, rows = ([assemble(forms[kind, k]) for k in (RISE, TURN)] for kind in ("column", "row"))
    corner = np.array([[fem.assemble_scalar(forms["corner", i, j]) for j in (RISE, TURN)] for i in (RISE, TURN)])
    matrix.assemble(columns, rows, corner, more)
    return matrix.petsc.convert("dense").getDenseArray().copy()


@pytest.mark.parametrize(
    ("what", "degree", "touching"),
    [("displacements", 2, False), ("rise", 2, False), ("turn", 2, False), ("all", 3, False), ("all", 2, True)],
)
def test_taylor_remainder_in_a_plastic_state(make_slice, moved, what, degree, touching):
    body = make_slice(degree=degree)
    contact = SelfContact(body) if touching else None
    rng = moved(body)
    body.commit()  # the state is plastic and turned, and goes on to flow
    body.u[:] = 5e-3 * rng.normal(size=body.u.shape)
    rise = 4.9 / (2 * np.pi) if touching else body.rise - 0.05
    body.increment[:] = rise * (body.turn + 0.004) - body.rise, 0.004
    assert body.update()
    assert (body.trial[:, 12] > body.state[:, 12]).mean() > 0.7
    if touching:
        assert contact.evaluate().bearing > 0
    direction = np.zeros(body.u.size + 2)
    direction[:-2] = 1e-3 * rng.normal(size=body.u.size) * (what in ("displacements", "all"))
    direction[-2:] = 0.01 * (what in ("rise", "all")), 1e-3 * (what in ("turn", "all"))
    start, along = generalised(body, contact), tangent(body, contact) @ direction
    u, increment = body.u.copy(), body.increment.copy()
    steps, remainders = np.array([4e-2, 2e-2, 1e-2]), []
    for step in steps:
        body.u[:] = u + step * direction[:-2].reshape(-1, 3)
        body.increment[:] = increment + step * direction[-2:]
        assert body.update()
        rest = generalised(body, contact) - start - step * along
        rest[-1] /= body.coil.radius
        remainders.append(np.linalg.norm(rest))
    slope = np.polyfit(np.log(steps), np.log(remainders), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)
    assert remainders[-1] < 2e-2 * steps[-1] * np.linalg.norm(along)  # the linear part itself is not small beside it


def test_shift_along_and_turn_about_the_axis_change_nothing(make_slice, moved):
    body = make_slice()
    moved(body)
    forces, resultants = body.forces.copy(), body.resultants()
    scale = np.linalg.norm(forces)
    # their forces vanish: a shift, and e_z × x
    assert abs(forces[:, 2].sum()) < 1e-12 * scale
    assert abs(np.sum(forces * np.cross([0.0, 0.0, 1.0], body.x))) < 1e-11 * scale * body.coil.radius
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    body.u[:] = body.x @ turn.T + [0.0, 0.0, 1.7] - (body.x - body.u)
    assert body.update()
    assert body.resultants() == pytest.approx(resultants, rel=1e-10)
    assert np.allclose(body.forces, forces @ turn.T, atol=1e-10 * scale)
