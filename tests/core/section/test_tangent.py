"""The section tangent is the derivative of the section resultants: Taylor remainder of order 2, for every kind."""

import numpy as np
import pytest

from coilset.meshes.springs.placement import Placement, round_wire
from coilset.model.core.section.kinds import KINDS, make_sections
from coilset.model.core.section.rules import polar
from coilset.verification.spring_references.curved_rod import section_stiffness

RADIUS = np.array([2.5])
CURVATURE, TORSION = 0.08, 0.01  # 1/mm: D/d = 5
PLASTIC = np.array([2e-3, 3e-4, -2e-4, 3e-3, -1.5e-3, 1e-3])  # surface strains far past yield (8e-4)


def straight():
    return Placement(
        np.eye(6)[None, None].repeat(2, axis=1),
        np.ones((1, 2)),
        np.zeros((1, 2)),
        np.zeros((1, 2)),
        round_wire(np.zeros((1, 2))),
    )


def tilted():
    """A section off the chord and tilted against it, made of one rotation and one offset; and ds/dx."""
    angle, offset = 0.1, np.array([0.0, 0.3, -0.2])
    tilt = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    cross = -np.cross(np.eye(3), offset)  # K × offset = cross @ K
    P = np.block([[tilt, tilt @ cross], [np.zeros((3, 3)), tilt]]) / 1.02
    each = np.ones((1, 2))
    return Placement(np.tile(P, (1, 2, 1, 1)), 1.02 * each, CURVATURE * each, TORSION * each, round_wire(each))


def ground():
    """The tilted section, ground beyond its axis."""
    return tilted()._replace(flat=np.tile([-0.2, 0.6, 0.8], (1, 2, 1)))


PLACES = {"straight": straight(), "tilted": tilted(), "ground": ground()}


class Section:
    """Both Gauss sections of one element, strained alike, from unstressed on."""

    def __init__(self, law, kind, place, rule=None):
        self.sections = make_sections(kind, law, law.parameters(), rule or polar(), RADIUS, place)
        self.start = self.sections.initial_state() | {"strain": np.zeros((1, 2, 6))}

    def update(self, de):
        """Resultants and tangent after the strain increment; the trial state stays beside the start."""
        self.trial = {name: np.full_like(rows, np.nan) for name, rows in self.sections.initial_state().items()}
        s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
        strain = self.start["strain"] + de
        assert self.sections.update(strain, self.start, self.trial, s, D)
        np.testing.assert_array_equal(s[0, 0], s[0, 1])
        return s[0, 0], D[0, 0]

    def commit(self, de):
        """Go on from the state after the strain increment."""
        self.update(de)
        strain = self.start["strain"] + de
        self.sections.update_surface(strain, self.start, self.trial)
        self.start = self.trial | {"strain": strain}


def slope(section, de, direction):
    """Order and last of the remainders, forwards or backwards: where a point begins to flow, one of both has a kink."""
    s, D = section.update(de)
    steps = np.array([1e-2, 5e-3, 2.5e-3])

    def towards(sign):
        away = sign * steps
        remainders = [np.linalg.norm(section.update(de + h * direction)[0] - s - h * D @ direction) for h in away]
        return np.polyfit(np.log(steps), np.log(remainders), 1)[0], remainders[-1] / np.linalg.norm(s)

    return min(towards(1.0), towards(-1.0), key=lambda found: abs(found[0] - 2.0))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", KINDS)
def test_elastic_tangent_is_the_linear_map_of_an_elastic_section(ck15, kind, place):
    """Elastic: the remainder vanishes, and the straight plane tangent is diag(EA, GA, GA, GIp, EI, EI).

    With the shear of the transverse force, 6/7 G A: G. R. Cowper, Journal of Applied Mechanics 33 (1966), the solid
    circle, 6 (1 + ν)/(7 + 6 ν), for ν = 0, since the force of a coil does not change along the wire.
    """
    section = Section(ck15, kind, PLACES[place])
    small = np.array([1e-5, 2e-6, 0, 1e-5, 1e-5, -2e-5])
    s, D = section.update(small)
    # the spin terms (5.2.33) are of second order: strain 1e-5 times the resultant
    np.testing.assert_allclose(s, D @ small, rtol=0, atol=1e-4 * np.abs(s).max())
    if place == "straight" and kind != "warping":
        A, I = np.pi * 2.5**2, np.pi * 2.5**4 / 4
        GA = ck15.G * A * (6 / 7 if kind == "curved" else 1.0)
        expected = [ck15.E * A, GA, GA, 2 * ck15.G * I, ck15.E * I, ck15.E * I]
        np.testing.assert_allclose(section.update(np.zeros(6))[1], np.diag(expected), rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("start", ["virgin", "hardened", "reversed"])
def test_plastic_tangent_has_taylor_slope_two(ck15, kind, start, place):
    section, de = Section(ck15, kind, PLACES[place]), PLASTIC
    if start != "virgin":
        section.commit(PLASTIC)
        de = PLASTIC if start == "hardened" else -2.0 * PLASTIC
    direction = np.array([0.7e-3, -1e-4, 2e-4, -1e-3, 0.8e-3, 1.3e-3])
    order, remainder = slope(section, de, direction)
    assert order == pytest.approx(2.0, abs=0.15)
    assert 0 < remainder < 1e-4


@pytest.mark.parametrize("kind", KINDS)
def test_a_failed_update_is_reported(ck15, kind):
    """Strains that are not numbers are never swallowed."""
    section = Section(ck15, kind, PLACES["straight"])
    trial = section.sections.initial_state()
    out = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
    assert not section.sections.update(np.full((1, 2, 6), np.nan), section.start, trial, *out)


def test_elastic_curved_section_is_winklers_ring(ck15):
    """Bending about the binormal: ∫ E y²/(1 − κy) dA and its coupling with tension, by the disk's closed integrals;
    shear and torsion with the warping found as a least energy.

    With c = 1/κ: ∫ dA/(c − y) = 2π (c − √(c² − r²)) = I0, so that ∫ dA/g = c I0, ∫ y dA/g = c (c I0 − A) and
    ∫ y² dA/g = c² (c I0 − A). Timoshenko, Strength of Materials II, art. 15.
    """
    r, c = RADIUS[0], 1.0 / CURVATURE
    section = Section(ck15, "curved", straight()._replace(curvature=np.full((1, 2), CURVATURE)), polar(8, 24))
    D = section.update(np.zeros(6))[1]
    area, ring = np.pi * r**2, 2 * np.pi * (c - np.sqrt(c**2 - r**2))
    assert D[0, 0] == pytest.approx(ck15.E * c * ring, rel=1e-12)
    assert D[0, 5] == pytest.approx(-ck15.E * c * (c * ring - area), rel=1e-11)
    assert D[5, 5] == pytest.approx(ck15.E * c * c * (c * ring - area), rel=1e-11)
    np.testing.assert_allclose(
        D, section_stiffness(RADIUS, np.array([CURVATURE]), ck15.E, ck15.G)[0], rtol=1e-11, atol=1e-6
    )


@pytest.mark.parametrize("kind", KINDS)
def test_points_on_the_surface_have_the_stress_of_the_section_there(ck15, kind):
    """Elastic, curved: the field of the outermost points of a fine rule, carried on to the rim by its slope."""
    section = Section(ck15, kind, PLACES["tilted"], rule := polar(16, 24, staggered=False))
    section.commit(np.array([1e-6, 2e-6, 0, 4e-5, 1e-5, -2e-5]))
    columns = [section.sections.components.index(name) for name in ("s11", "t12", "t13")]
    rings = section.trial["point_state"][0, 0].reshape(16, 24, -1)[-3:, :, columns]
    radius = np.hypot(*rule.points.T).reshape(16, 24)[-3:, 0]
    at_rim = [np.prod([(1 - b) / (a - b) for b in radius if b != a]) for a in radius]  # Lagrange, quadratic
    ring = np.einsum("r,rac->ac", at_rim, rings)
    between = 0.5 * (ring + np.roll(ring, 1, axis=0))  # the rule's angles lie half way between the rim's
    found = section.trial["surface_state"][0, 0][:, columns]
    assert found.shape == (24, 3)
    np.testing.assert_allclose(found, between, rtol=0, atol=0.012 * np.abs(found).max())  # 1 − cos 7.5° = 0.9 %
