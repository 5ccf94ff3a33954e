"""Sections that warp: straight wires exactly, curved ones against Göhner's equation, and what the state promises."""

import numpy as np
import pytest

from coilset.meshes.sections.shapes import Tube
from coilset.meshes.springs.placement import straight
from coilset.model.core.material import library
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import polar, rim
from coilset.model.physics.outlines.outlined_section import Outlined
from coilset.model.physics.warping.condensation import TOLERANCE, place, strains
from coilset.model.physics.warping.polynomials import Basis
from coilset.verification.one_section.helix import HelixSection
from coilset.verification.solid_study import references

RADIUS = 2.5


@pytest.fixture(scope="module")
def elastic():
    return library.load("elastic")


def test_polynomials_are_orthonormal():
    """With a rule of degree 15 for products of degree 10; 1, y and z are the first three."""
    rule, basis = polar(5, 16), Basis.of_disk(5)
    powers, coefficients = basis.functions.powers, basis.coefficients
    y, z = rule.points.T
    p = coefficients @ np.array([y**a * z**b for a, b in powers])
    np.testing.assert_allclose((p * rule.weights) @ p.T, np.eye(21), atol=1e-13)
    assert [list(row) for row in powers[:3]] == [[0, 0], [1, 0], [0, 1]]


def test_slopes_of_the_polynomials():
    """Against central differences, also on the axis and on the rim."""
    places, basis = np.concatenate([polar().points, rim(8), [[0.0, 0.0]]]), Basis.of_disk(5)
    h = 1e-5
    _, fy, fz = basis(places)
    for slope, step in ((fy, (h, 0)), (fz, (0, h))):
        ahead, behind = (basis(places + k * np.array(step))[0] for k in (1, -1))
        np.testing.assert_allclose(slope, (ahead - behind) / (2 * h), atol=1e-7)


@pytest.mark.parametrize("degree", [1, 3])
def test_straight_wire_in_tension_torsion_and_bending_is_exact(elastic, degree):
    """EA with free contraction, G Ip; EI from degree 2 on, when the section can bend across (anticlastic)."""
    sections = make_sections(
        "warping", elastic, elastic.parameters(), polar(), np.array([RADIUS]), straight(1), None, degree
    )
    state = sections.initial_state()
    s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
    assert sections.update(np.zeros((1, 2, 6)), state | {"strain": np.zeros((1, 2, 6))}, sections.initial_state(), s, D)
    A, I = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4
    found = np.diag(D[0, 0])
    assert found[0] == pytest.approx(elastic.E * A, rel=1e-12)
    assert found[3] == pytest.approx(elastic.G * 2 * I, rel=1e-12)
    if degree == 3:
        np.testing.assert_allclose(found[4:], elastic.E * I, rtol=1e-12)
    else:  # held from bending across: E (1 − ν)/((1 + ν)(1 − 2ν)) I with ε22 = −ν … of the mean alone
        assert (found[4:] > 1.2 * elastic.E * I).all()
    np.testing.assert_allclose(D[0, 0] - np.diag(found), 0, atol=1e-9 * found.max())


@pytest.mark.parametrize("index", [3.0, 4.0, 8.0, 12.0])
def test_shear_factors_meet_goehners_equation(elastic, index):
    """Without pitch, inside and outside of the coil; degree 5 to 2e-5, degree 3 to 1e-3, the closed warping to 1 %."""
    exact = references.goehner_exact(index)
    for kind, degree, tolerance in (("warping", 5, 6e-5), ("warping", 3, 1e-3), ("curved", 3, 1e-2)):
        wire = HelixSection(elastic, kind, index, 0.0, degree=degree)
        np.testing.assert_allclose(wire.factors(), exact, rtol=tolerance)


def test_stresses_are_a_function_of_the_last_equilibrium(ck15):
    """Whatever was tried in between: as far as the iteration's tolerance lets them, and to the bit after a failure."""
    wire = HelixSection(ck15, "warping", 5.0, 5.0)
    there = np.array([1e-4, 0, 1e-4, 2e-3, 0, 4e-4])
    first = wire.update(there)[0].copy()
    for other in (3.0 * there, -there, there[::-1], 1.001 * there):
        wire.update(other)
        np.testing.assert_allclose(wire.update(there)[0], first, rtol=0, atol=1e-9 * np.abs(first).max())
    assert (wire.update(there)[0] != first).any()
    with pytest.raises(ValueError):
        wire.update(np.full(6, np.nan))
    np.testing.assert_array_equal(wire.update(there)[0], first)


def test_a_known_warping_saves_iterations(ck15):
    """Beside strains that were tried, beyond yield: one iteration, where the slope at the start leads to three."""
    wire, there = HelixSection(ck15, "warping", 5.0, 5.0), np.array([1e-4, 0, 1e-4, 2e-3, 0, 4e-4])
    counts = [0]
    for strain in (there, (1.0 + 1e-6) * there):
        wire.update(strain)
        counts.append(wire.sections.iterations[0, 1])
    assert list(np.diff(counts)) == [2 * 3, 2 * 1]  # of its two sections


def test_warping_does_no_work(ck15):
    """Stresses of a plastic section on every unit warping, as far as the iteration's tolerance lets them."""
    wire = HelixSection(ck15, "warping", 5.0, 5.0)
    wire.update(np.array([1e-4, 0, 1e-4, 2e-3, 0, 4e-4]))
    rule = wire.rule
    B = np.empty((len(rule), 6, 6 + wire.sections.unknowns))
    geometry = place(wire.sections.inside, 0, np.empty(len(rule)), np.empty(len(rule)))
    for j, unit in enumerate(np.eye(B.shape[2])):
        strains(geometry, unit, column := np.empty((len(rule), 6)))
        B[:, :, j] = column
    stress = wire.trial["point_state"][0, 0][:, :6]
    volume = rule.weights * (1.0 - wire.placement.curvature[0, 0] * RADIUS * rule.points[:, 0])
    rest = np.einsum("pi,pij,p->j", stress, B, volume)
    assert np.abs(rest[6:]).max() < 5.0 * TOLERANCE * ck15.E
    assert np.abs(rest[:6]).max() > 0.1 * np.abs(stress).max()


def test_warping_is_found_far_beyond_yield(ck15):
    """Strains of up to some per cent in one increment from the unstressed state, in all directions."""
    rng = np.random.default_rng(0)
    for _ in range(30):
        wire = HelixSection(ck15, "warping", 4.0, 5.0)
        wire.update(rng.normal(size=6) * np.repeat([2e-3, 1e-3], 3) * rng.choice([0.3, 1, 3, 10]))
        assert wire.sections.iterations[0, 1] <= 2 * 20


@pytest.mark.parametrize("inner", [0.4, 0.9, 0.98])
def test_polynomials_in_the_wall_of_a_tube_are_orthonormal(inner):
    """In a wall of 1 % those of degree 6 are all but alike; by Cholesky's factors of their moments 1e-3 was left, and
    those of degree 8 had none."""
    section = Outlined.of(Tube(1.0, inner), 0.5)
    places, weights = section.fine
    for degree in (6, 8):
        p = section.basis(degree)(places)[0]
        moments = p.T @ (weights[:, None] * p) / weights.sum()
        np.testing.assert_allclose(moments, np.eye(p.shape[1]), atol=2e-7)
