"""Shooting of the exact rod against collocation with quaternions: another method and other unknowns."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.spatial.transform import Rotation

from coilset.verification.cases.rods import bend_45
from coilset.verification.references.rod_shooting import Stiffness, clamped_rod

LENGTH, CURVATURE = bend_45.RING * np.pi / 4.0, np.array([0.0, 0.0, 1.0 / bend_45.RING])


def collocated(stiffness, force):
    """Position of the free end, the force raised in quarters; unknowns r, quaternion (scalar last), m."""

    def rates(n, y):
        turned, (v, w) = Rotation.from_quat(y[3:7].T), (y[3:6].T, y[6][:, None])
        slope = turned.apply(turned.inv().apply(n) / (stiffness.EA, stiffness.GA, stiffness.GA) + [1.0, 0.0, 0.0])
        k = CURVATURE + turned.inv().apply(y[7:10].T) / (stiffness.GJ, stiffness.EI, stiffness.EI)
        turning = np.hstack([w * k + np.cross(v, k), -np.sum(v * k, axis=1, keepdims=True)])
        return np.vstack([slope.T, 0.5 * turning.T, -np.cross(slope, n).T])

    def ends(clamp, free):
        return np.concatenate([clamp[:6], [clamp[6] - 1.0], free[7:]])

    s, y = np.linspace(0.0, LENGTH, 41), np.zeros((10, 41))
    y[0], y[6] = s, 1.0
    for part in (0.25, 0.5, 0.75, 1.0):
        found = solve_bvp(lambda _, y, n=part * force: rates(n, y), ends, s, y, tol=1e-9, max_nodes=20000)
        assert found.success
        s, y = found.x, found.y
    return y[:3, -1]


def test_the_bend_of_45_degrees():
    """Found to 7e-12 of the radius."""
    law = bend_45.elastic(bend_45.YOUNG, 0.0)
    stiffness, force = Stiffness.of_round_wire(bend_45.RADIUS, law.E, law.G), np.array([0.0, 0.0, 600.0])
    shot = clamped_rod(stiffness, LENGTH, force, curvature=CURVATURE)
    assert shot == pytest.approx(collocated(stiffness, force), abs=1e-10 * bend_45.RING)
    assert shot - bend_45.arc(1)[-1] == pytest.approx(bend_45.COLLOCATED, rel=1e-8)


def test_the_torsional_stiffness_of_the_square_is_not_why_the_paper_differs():
    """It takes the tip farther from the paper's y."""
    square = Stiffness(1e7, 5e6, 0.140577 * 5e6, 1e7 / 12.0)
    tip = collocated(square, np.array([0.0, 0.0, 600.0])) - bend_45.arc(1)[-1]
    assert tip == pytest.approx([-23.819, -13.732, 53.607], abs=6e-4)
    assert tip[1] < bend_45.COLLOCATED[1] < bend_45.PAPER["y"]
