"""No volumetric locking in plastic flow: the moment of a bent wire near its limit, beside an element that does lock."""

import numpy as np
import pytest
from mpi4py import MPI
from solid_laws import IdealPlastic

from coilset.meshes.solids.solid import SectionGrid, straight_wire
from coilset.model.physics.solid import forms
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.problem import SolidProblem
from coilset.verification.solid_study.references import plastic_bending_moment

d, R, L = 5.0, 2.5, 40.0


def moments(curvatures):
    """Bending moment over the beam's for ideal plasticity, at curvatures given over that of first yield."""
    law = IdealPlastic(shear_yield=23.0)  # strains stay small, 3e-3 at the maximum curvature
    yield_stress = np.sqrt(1.5) * law.k
    first = yield_stress / (2 * law.G * (1 + law.nu)) / R
    problem = SolidProblem(straight_wire(d, L, 12, MPI.COMM_SELF, SectionGrid(2, 1)), law, "direct")
    out = []
    for ratio in curvatures:
        turn, ρ = ratio * first * L, 1 / (ratio * first)
        problem.step(Motion((0.0, -ρ * (1 - np.cos(turn)), ρ * np.sin(turn) - L), (turn, 0.0, 0.0)))
        out.append(-problem.reactions(np.zeros(3))[0].moment[0] / plastic_bending_moment(yield_stress, R, ratio))
    return np.array(out)


def test_moment_near_the_limit():
    # at 8 and 16 times the curvature of first yield; found: 1.0012 and 1.0018, of a mesh of 12 elements in the section
    at_8, at_16 = moments([1, 2, 4, 8, 16])[-2:]
    assert at_8 == pytest.approx(1.0, abs=4e-3)
    assert at_16 == pytest.approx(1.0, abs=4e-3)


def test_the_measure_shows_locking(monkeypatch):
    # the same element with full integration, 27 points: 1.005 and 1.015, and rising
    monkeypatch.setattr(forms, "QUADRATURE_DEGREE", 5)
    at_8, at_16 = moments([1, 2, 4, 8, 16])[-2:]
    assert at_16 > 1.012
    assert at_16 - at_8 > 0.007
