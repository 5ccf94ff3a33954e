"""The slice's tangent, by displacements and by both numbers, is the derivative of its forces: Taylor remainders."""

import numpy as np
import pytest

from coilset.model.physics.slice.contact import SelfContact


def forces(body):
    """Forces of all unknowns, h̄ and λ last."""
    vector = np.zeros(body.u.size + 2)
    body.internal_forces(vector)
    return vector


def tangent(body):
    """The whole tangent as a dense array."""
    matrix = body.create_matrix(body.u.size + 2)
    body.tangent(matrix)
    return matrix.convert("dense").getDenseArray().copy()


@pytest.mark.parametrize(
    ("what", "degree", "touching"),
    [("displacements", 2, False), ("rise", 2, False), ("turn", 2, False), ("all", 3, False), ("all", 2, True)],
)
def test_taylor_remainder_in_a_plastic_state(make_slice, moved, what, degree, touching):
    body = make_slice(degree=degree)
    rng = moved(body)
    body.state.commit()  # the state is plastic and turned, and goes on to flow
    if touching:
        body.contact = SelfContact(body)
    body.u[:] = 5e-3 * rng.normal(size=body.u.shape)
    rise = 4.9 / (2 * np.pi) if touching else body.rise - 0.05
    body.extra.trial[:] = rise * (body.turn + 0.004), (body.turn + 0.004) * body.coil.radius
    assert body.update()
    assert (body.rows[:, 12] > body.state["point_state"].equilibrium[0, :, 12]).mean() > 0.7
    assert (body.pressure.bearing > 0) == touching
    direction = np.zeros(body.u.size + 2)
    direction[:-2] = 1e-3 * rng.normal(size=body.u.size) * (what in ("displacements", "all"))
    direction[-2:] = 0.01 * (what in ("rise", "all")), 1e-3 * body.coil.radius * (what in ("turn", "all"))
    start, along = forces(body), tangent(body) @ direction
    u, extra = body.u.copy(), body.extra.trial.copy()
    steps, remainders = np.array([4e-2, 2e-2, 1e-2]), []
    for step in steps:
        body.u[:] = u + step * direction[:-2].reshape(-1, 3)
        body.extra.trial[:] = extra + step * direction[-2:]
        assert body.update()
        remainders.append(np.linalg.norm(forces(body) - start - step * along))
    slope = np.polyfit(np.log(steps), np.log(remainders), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)
    assert remainders[-1] < 2e-2 * steps[-1] * np.linalg.norm(along)  # the linear part itself is not small beside it


def test_shift_along_and_turn_about_the_axis_change_nothing(make_slice, moved):
    body = make_slice()
    moved(body)
    nodal, resultants = forces(body)[:-2].reshape(-1, 3), body.resultants()
    scale = np.linalg.norm(nodal)
    # their forces vanish: a shift, and e_z × x
    assert abs(nodal[:, 2].sum()) < 1e-12 * scale
    assert abs(np.sum(nodal * np.cross([0.0, 0.0, 1.0], body.x))) < 1e-11 * scale * body.coil.radius
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    body.u[:] = body.x @ turn.T + [0.0, 0.0, 1.7] - (body.x - body.u)
    assert body.update()
    assert body.resultants() == pytest.approx(resultants, rel=1e-10)
    assert np.allclose(forces(body)[:-2].reshape(-1, 3), nodal @ turn.T, atol=1e-10 * scale)
