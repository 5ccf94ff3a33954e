"""A moment of fixed direction at a rod's end: the rod becomes a helix about it (Kirchhoff; A. E. H. Love, § 270)."""

import numpy as np

from coilset.model.core.material import library
from coilset.verification.chain import ROTATION_X, ROTATION_Y, ROTATION_Z, chain, straight

LENGTH, RADIUS, STEPS = 100.0, 0.05, 12
AXIS = np.array([np.sin(0.3), 0.0, np.cos(0.3)])  # of the moment; its share along the rod twists


def test_a_moment_in_space_winds_a_rod_to_a_helix():
    """1.25 turns in twelve steps: the tangent turns about the moment, t′ = (m/EI) × t, whatever GJ is.

    Tolerance φ²/24 of the length, φ the angle of an element: the chord polygon's. A moment that belonged to the charts,
    and turned with them, would miss the tip by far more; and Newton would not converge quadratically.
    """
    elements, law = 48, library.load("elastic")
    EI, rate = law.E * np.pi * RADIUS**4 / 4.0, 2.5 * np.pi / LENGTH
    frame = chain(straight(LENGTH, elements), RADIUS, law)
    tip = [frame.dof(elements, component) for component in (ROTATION_X, ROTATION_Y, ROTATION_Z)]
    ratios, judge = [], frame.continuation.newton.iteration.test.is_met

    def listen(found, tolerance, rounding):
        ratios.append(found.ratio)
        return judge(found, tolerance, rounding)

    frame.continuation.newton.iteration.test.is_met = listen
    for k in range(1, STEPS + 1):
        ratios.clear()
        outcome = frame.step(forces=dict(zip(tip, k / STEPS * EI * rate * AXIS, strict=True)), predictor_scale=None)
        assert outcome.converged
        assert outcome.iterations <= 8
    across = np.array([1.0, 0.0, 0.0]) - AXIS[0] * AXIS
    s = rate * LENGTH
    x = AXIS[0] * LENGTH * AXIS + (np.sin(s) * across + (1.0 - np.cos(s)) * np.cross(AXIS, across)) / rate
    moved = x - [LENGTH, 0.0, 0.0]
    np.testing.assert_allclose(frame.moved(elements), moved, rtol=0, atol=(s / elements) ** 2 / 24.0 * LENGTH)
    before, last = ratios[-2:]
    assert last < before**1.5
