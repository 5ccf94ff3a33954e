"""A body that snaps: where it comes to rest, and what energy it loses."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.integrate import quad
from scipy.optimize import brentq

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.case import read_case
from coilset.model.core.equilibrium.path.step_sizes import Position
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.equilibrium.system.load import Drag, Load
from coilset.model.core.material import library
from coilset.model.core.section.rules import abramowitz9
from coilset.model.physics.stability import branch_switching
from coilset.model.physics.stability.branch_switching import Snap
from coilset.model.physics.stability.stability import Stability
from coilset.verification.frame import Frame

HALF_SPAN, RISE, RADIUS = 100.0, 5.0, 0.3  # mm, of Mises's truss
LAW = library.load("elastic")


def force(w):
    """Of the truss at a deflection w: two hinged bars of logarithmic strain, −2 E A ln(l/l0) (h − w)/l."""
    l0, l = np.hypot(HALF_SPAN, RISE), np.hypot(HALF_SPAN, RISE - w)
    return -2.0 * LAW.E * np.pi * RADIUS**2 * np.log(l / l0) * (RISE - w) / l


LIMIT = max(force(w) for w in np.linspace(0.0, RISE, 501))


def truss():
    hinges = [(0, (0, 1, 2, 3, 5)), (2, (0, 1, 2, 3, 5)), (1, (1, 3, 5))]
    nodes = [[-HALF_SPAN, 0, 0], [0, 0, RISE], [HALF_SPAN, 0, 0]]
    return Frame(nodes, [(0, 1), (1, 2)], RADIUS, LAW, abramowitz9(), hinges)


def load(frame, factor):
    return Load.of(frame.layout, frame.held, {frame.dof(1, 2): -factor * LIMIT})


def near_limit():
    """A truss at 0.999 of its limit, and its deflection."""
    frame = truss()
    for factor in (0.8, 0.95, 0.999):
        assert frame.step(forces={frame.dof(1, 2): -factor * LIMIT}).converged
    deflection = -frame.moved(1)[2]
    assert deflection < RISE
    return frame, deflection


def let_go(frame, factor, unstable=None):
    newton = frame.continuation.newton
    snap = Snap(Stability(newton.iteration), StepControl(), newton.solve)
    return snap.go(lambda: load(frame, factor), unstable)


@pytest.mark.parametrize("factor", [1.01, 1.3])
def test_beyond_its_limit_a_truss_snaps_to_the_other_side(factor):
    """What is set free is the area between the dead load and the truss's force, but for the trapezoidal rule's error.

    0.5 % of the way are for the stiff joints, see test_arc_length_goes_past_a_limit_point.
    """
    frame, before = near_limit()
    outcome = let_go(frame, factor)
    assert outcome.converged
    assert outcome.negative_pivots == 0
    after = -frame.moved(1)[2]
    assert after == pytest.approx(brentq(lambda w: force(w) - factor * LIMIT, 2.0 * RISE, 4.0 * RISE), rel=5e-3)
    area = quad(lambda w: factor * LIMIT - force(w), before, after)[0]
    assert outcome.released == pytest.approx(area, rel=0.03)


def test_an_unstable_truss_falls_back_to_where_it_came_from():
    """At half its limit it is released from the unstable equilibrium between its two stable ones."""
    frame, before = near_limit()
    there = brentq(lambda w: force(w) - 0.5 * LIMIT, 0.5 * RISE, RISE)
    start = frame.layout.vector()
    start.setValue(frame.dof(1, 2), before - there)
    start.assemble()
    outcome = let_go(frame, 0.5, start)
    assert outcome.converged
    after = -frame.moved(1)[2]
    assert after == pytest.approx(brentq(lambda w: force(w) - 0.5 * LIMIT, 0.0, 0.4 * RISE), rel=5e-3)
    assert outcome.released == pytest.approx(quad(lambda w: 0.5 * LIMIT - force(w), there, after)[0], rel=0.03)


def test_what_does_not_come_to_rest_can_be_taken_back(monkeypatch):
    monkeypatch.setattr(branch_switching, "SNAP_STEPS", 8)
    frame, before = near_limit()
    state, saved = frame.system.state, frame.system.state.copy()
    assert not let_go(frame, 1.3).converged
    assert -frame.moved(1)[2] > before
    state.put_back(saved)
    frame.system.restore()
    assert -frame.moved(1)[2] == before
    assert all(np.array_equal(field.equilibrium, saved[name]) for name, field in state.items())


def test_drag_resists_and_its_derivative_is_in_the_tangent():
    """Residual and tangent with drag, minus those without, are c (x − x₀) and c, but in held rows."""
    frame = truss()
    system, matrix = frame.system, frame.continuation.newton.iteration.matrix
    free_of_drag, n = load(frame, 0.0), frame.layout.size
    rng = np.random.default_rng(2)
    x, origin, stiffness = 1e-3 * rng.normal(size=n), 1e-3 * rng.normal(size=n), rng.uniform(1.0, 2.0, n)
    found = []
    for each in (free_of_drag, free_of_drag.resisted(Drag(stiffness, origin))):
        F, X = frame.layout.vector(), frame.layout.vector(x.copy())
        system.residual(X, each, 1.0, F)
        system.tangent(X, each, matrix)
        found.append((F.getArray().copy(), matrix.mat.getDiagonal().getArray().copy()))
    free = np.setdiff1d(np.arange(n), free_of_drag.held)
    (F0, K0), (F1, K1) = found
    np.testing.assert_allclose((F1 - F0)[free], (stiffness * (x - origin))[free], atol=1e-9 * np.abs(F0).max())
    np.testing.assert_allclose((K1 - K0)[free], stiffness[free], atol=1e-9 * np.abs(K0).max())
    held = free_of_drag.held
    assert np.array_equal(F1[held], F0[held])
    assert np.array_equal(K1[held], K0[held])


def hourglass():
    """To where its coils first touch, and on; its coarse mesh forks there with the thesis's element."""
    settings = ["mesh.section.rule=abramowitz9", "mesh.elements_per_turn=8", "mesh.element=thesis", "accuracy=none"]
    program = "loading=[{to: {travel: 25.93}, steps: 6}, {to: {travel: 30.25}, steps: 1}]"
    return Analysis(read_case(EXAMPLES / "springs/hourglass.yaml", [*settings, program]), MPI.COMM_SELF).run().steps


def test_a_yielding_path_forks_without_a_snap(monkeypatch):
    """A stable state without a jump of force, and no energy from nothing; so does one found beside it at once."""
    steps = hourglass()
    forks = [number for number, step in enumerate(steps) if step.left_branch]
    assert forks
    assert all(step.negative_pivots == 0 for step in steps)
    for number in forks:
        before, fork = steps[number - 1], steps[number]
        assert fork.released_energy_Nmm == 0.0
        # found: 0.0035, over 0.07 mm of travel
        assert fork.force_N == pytest.approx(before.force_N, rel=5e-3)
    monkeypatch.setattr(Position, "has_left_branch", property(lambda position: True))
    beside = hourglass()
    assert sum(step.cuts for step in beside) < sum(step.cuts for step in steps)
    assert all(step.negative_pivots == 0 for step in beside)
    assert sum(step.released_energy_Nmm for step in beside) == 0.0
    assert beside[-1].force_N == pytest.approx(steps[-1].force_N, rel=5e-3)
