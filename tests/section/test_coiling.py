"""Coiling at a section: closed forms, the shape that is asked for, and wires that cannot keep one."""

import numpy as np
import pytest

from coilset.meshes.errors import SolveError
from coilset.model.material import library
from coilset.model.material.points import initial_state
from coilset.model.section.coiling import coil
from coilset.model.section.rules import polar
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
