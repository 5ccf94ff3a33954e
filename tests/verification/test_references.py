"""References of the benchmarks in the limits where they are known by hand."""

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.verification.references import creeping_ring, relaxing_bar
from coilset.verification.references.elastica import cantilever
from coilset.verification.references.rod_shooting import Stiffness, clamped_rod
from coilset.verification.references.section_integrals import (
    bending_moment,
    nadai_torque,
    plastic_path,
    shear_curve,
    tube_shear,
)
from coilset.verification.references.stability import clamped_spring, twisted_rod
from coilset.verification.references.uniform_helix import deformed

E, G = 210000.0, 80769.2308
WIRE = Stiffness.of_round_wire(2.5, E, G)


def test_a_short_stiff_cantilever_is_timoshenkos():
    tip = clamped_rod(WIRE, 50.0, (0.0, 1e-2, 0.0), loads=1)
    assert tip[1] == pytest.approx(1e-2 * 50.0**3 / (3.0 * WIRE.EI) + 1e-2 * 50.0 / WIRE.GA, rel=1e-6)


def test_an_end_moment_rolls_a_rod_up_to_half_a_circle():
    tip = clamped_rod(WIRE, 100.0, np.zeros(3), (0.0, 0.0, np.pi * WIRE.EI / 100.0))
    assert tip == pytest.approx([0.0, 200.0 / np.pi, 0.0], abs=1e-5)


def test_the_elastica_starts_as_the_linear_cantilever():
    assert cantilever(1e-3)[1] == pytest.approx(1e-3 / 3.0, rel=1e-6)


def test_hockling_without_tension_is_the_limit_of_a_small_one():
    assert twisted_rod(0.0) == pytest.approx(2.0 * 4.493409457909, abs=1e-9)
    assert twisted_rod(1e-6) == pytest.approx(twisted_rod(0.0), rel=1e-5)
    with pytest.raises(ValueError, match="tension"):
        twisted_rod(-0.1)


def test_haringx_numbers():
    travel, force = clamped_spring(5.0, 40.0, 40, 480.0, E, G)
    assert travel == pytest.approx(39.155, abs=1e-3)
    assert force == pytest.approx(96.513, abs=1e-3)
    with pytest.raises(ValueError, match="stout"):
        clamped_spring(5.0, 40.0, 5, 60.0, E, G)


def test_a_flat_helix_has_the_rate_of_torsion_and_shear():
    rise = 1e-4
    helix = deformed(WIRE, 20.0, rise, rise + 1e-3)
    compliance = 20.0**3 / WIRE.GJ + 20.0 / WIRE.GA  # per radian
    assert helix.force == pytest.approx(1e-3 / compliance, rel=1e-4)
    assert deformed(WIRE, 20.0, 3.0, 3.0).force == pytest.approx(0.0, abs=1e-6)


def test_sections_at_the_elastic_and_the_plastic_end():
    assert nadai_torque(200.0, G, 2.5, 1e-4) == pytest.approx(0.5 * np.pi * G * 1e-4 * 2.5**4)
    assert nadai_torque(200.0, G, 2.5, 1e3) == pytest.approx(2.0 * np.pi / 3.0 * 200.0 * 2.5**3)
    assert bending_moment(400.0, E, 2.5, 1e-5) == pytest.approx(E * 1e-5 * np.pi * 2.5**4 / 4.0)
    assert bending_moment(400.0, E, 2.5, 10.0) == pytest.approx(4.0 / 3.0 * 400.0 * 2.5**3, rel=1e-5)


def test_linear_hardening_is_a_straight_line_in_shear():
    law = library.load("linear_isotropic", spin=False)
    limit, slope = 400.0 / np.sqrt(3.0), 1.0 / (1.0 / law.G + 3.0 / 2000.0)  # H = 2000 MPa
    γ = np.array([0.5e-3, 5e-3, 2e-2])
    line = np.minimum(law.G * γ, limit + slope * (γ - limit / law.G))
    assert shear_curve(law, γ) == pytest.approx(line, rel=1e-5)


def test_what_does_not_harden_has_no_rates_here():
    with pytest.raises(ValueError, match="does not harden"):
        plastic_path(library.load("ideal_plastic"), np.zeros(5), np.array([0.0, 1.0]), np.array([0.0, 1.0]))


def test_hills_tube_is_hyperbolic_if_it_is_incompressible():
    angle = 1.0
    γ = tube_shear(300.0, 3.0 * G, G, angle)
    assert np.cos(angle) == pytest.approx(1.0 / np.cosh(np.sqrt(3.0) * G * γ / 300.0))


def test_a_ring_that_creeps_is_a_straight_bar_where_it_is_large():
    """Known numbers of the bar; a small ring starts with the force of its torsion by displacements, and loses more."""
    z = 5.0 * 80000.0 * 1e-20 * 700.0**5 * np.array([1.0, 1e3, 1e5]) ** 0.3
    straight = relaxing_bar.virgin(6.0, z)
    assert straight == pytest.approx([0.951753, 0.809369, 0.668594], abs=1e-6)
    for redistributed in (False, True):
        assert creeping_ring.relaxation(1e4, 6.0, z, redistributed) == pytest.approx(straight, rel=1e-6)
    alone, ring = (creeping_ring.relaxation(4.0, 6.0, z, redistributed) for redistributed in (False, True))
    assert (ring < alone).all()
    assert (alone < 0.98 * straight).all()
