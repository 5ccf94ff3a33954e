"""Coiling at a section: closed forms, the shape that is asked for, and wires that cannot keep one."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material import library
from coilset.model.core.material.point.points import initial_state
from coilset.model.core.section.rules import polar
from coilset.model.physics.manufacture.coiling import bent, coil
from coilset.model.physics.manufacture.wire import Wire
from coilset.model.physics.time.creep.law import CreepLaw
from coilset.verification.references.springback import Bar

RADIUS = 2.5


def coiled(law, curvature, torsion=0.0, rule=None, **options):
    return coil(law.parameters(), rule or polar(), RADIUS, curvature, torsion, initial_state(law, 1), **options)


def test_closed_form_at_other_curvatures():
    """Slightly and strongly bent, without and with hardening; `coiling` of verification judges D/d = 8 within 0.1 %."""
    for name, slope in (("ideal_plastic", 0.0), ("linear_isotropic", 2000.0)):
        law = library.load(name)
        bar = Bar(law.yield_stress, law.E, law.E * slope / (law.E + slope), RADIUS)
        for curvature in (1e-3, 0.1):
            ours = coiled(law, curvature, rule=polar(32, 64), curved=False)
            exact = bar.straight(curvature)
            assert (ours.curvature, ours.moments[0]) == pytest.approx(exact[:2], rel=1e-3)
            assert ours.surface[0, 0] == pytest.approx(exact[2], rel=1e-3)


def test_the_wire_is_at_rest_afterwards():
    """Neither force nor moment is left; bending back by what sprang back gives the moments again."""
    law = library.load("ck15")
    rule, ours = polar(), coiled(law, 0.05, 0.005)
    y, z = RADIUS * rule.points.T
    s11, t12, t13 = ours.points[:, :3].T
    area = np.pi * RADIUS**2 * rule.weights
    largest = area @ np.abs(s11)
    assert np.abs([area @ s11, area @ t12, area @ t13]).max() < 1e-3 * largest
    assert np.abs([area @ (s11 * y), area @ (s11 * z), area @ (t13 * y - t12 * z)]).max() < 1e-9 * largest
    assert ours.curvature > 0.05
    assert ours.torsion > 0.005
    left = coiled(law, 0.05, -0.005)
    assert left.torsion == pytest.approx(-ours.torsion, rel=1e-9)
    np.testing.assert_allclose(left.surface[0, :3], ours.surface[0, :3] * [1, 1, -1], atol=1e-6 * law.yield_stress)


def test_an_elastic_wire_keeps_no_shape():
    with pytest.raises(SolveError, match="springs back to another shape"):
        coiled(library.load("elastic"), 0.05)


def relief(law, hours, temperature, intervals):
    """The law over the intervals of a relief at constant temperature."""
    creep = CreepLaw(law.data.creep, law.parts())
    clocks = [creep.clock(0.0, 293.15), creep.clock(0.0, temperature)]
    clocks += [creep.clock(t, temperature) for t in hours * np.linspace(0.0, 1.0, intervals + 1)[1:] ** 4]
    for clock in clocks[2:]:
        clock[2] = creep.worth(clock[0], temperature, temperature)
    return [creep.over(*pair) for pair in pairwise(clocks)]


def test_relief_against_fibres_that_creep():
    """A bent bar, relieved warm and free of moment: its fibres, integrated by scipy, end at the same stress."""
    law, rule, warm, hours = library.load("creeping"), polar(8, 16), 523.15, 0.5
    row = np.append(initial_state(law, 1), [[293.15, 0.0]], axis=1)
    ours = coil(law.parameters(), rule, RADIUS, 0.05, 0.0, row, curved=False, relief=relief(law, hours, warm, 24))
    tight = coiled_with(law, rule, row, ours.turned)
    y, w, k = RADIUS * rule.points[:, 0], rule.weights, law.data.creep
    part = (warm - 293.15) / 280.0
    E = [2.0 * 1.29 * G for G in (79000.0, 79000.0 - part * 7900.0)]
    worth = CreepLaw(law.data.creep, law.parts()).worth(1.0, warm, warm)

    def rates(_, state):
        s, c = state.reshape(2, -1)
        rate = k.time_exponent * (k.strain * (np.abs(s) / k.stress) ** k.exponent) ** (1 / k.time_exponent)
        rate = rate * worth * c ** (1 - 1 / k.time_exponent)
        flow = np.sign(s) * rate
        stretched, bent = w @ flow, (w @ (flow * y)) / (w @ (y * y))
        return np.concatenate([E[1] * (stretched + bent * y - flow), rate])

    start = np.concatenate([tight * E[1] / E[0], np.full(len(y), 1e-9)])
    end = solve_ivp(rates, (0.0, hours), start, "LSODA", rtol=1e-8, atol=1e-12).y[: len(y), -1]
    greatest = np.abs(tight).max()
    np.testing.assert_allclose(ours.points[:, 0], end, atol=5e-3 * greatest)
    assert np.abs(end).max() < 0.8 * greatest


def coiled_with(law, rule, row, turned):
    """Stress of a bar that was turned so and let go, before its relief."""
    wire = Wire.of_disk(law.parameters(), rule, RADIUS, False, row)
    return bent(wire, np.array(turned), 0.05, ())[0].states[: len(rule), 0]
