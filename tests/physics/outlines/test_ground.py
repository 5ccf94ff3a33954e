"""What grinding leaves of a section: its integrals, its warping, where it lies in a spring, and a coil of it."""

import numpy as np
import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.analysis import Analysis
from coilset.model.core.case.case import check
from coilset.model.core.material import library
from coilset.model.core.section.rules import polar, rim, spread
from coilset.model.core.section.shape import curved_shape
from coilset.model.physics.outlines.ground import cut_points
from coilset.model.physics.outlines.outlined_section import Segment
from coilset.verification.cases.sections.ground_sections import CutCoil, slice_rate
from coilset.verification.one_section.slice_references import ring_sector

UP = (0.0, 1.0)
SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 5.5, "pitch": 12.0, "end_coils": "closed and ground"}
CASE = {
    "accuracy": "none",
    "spring": SPRING,
    "material": "ck15",
    "mesh": {"elements_per_turn": 12},
    "ends": "seats",
    "loading": [{"to": {"travel": 5.0}, "steps": 1}],
}


@pytest.mark.parametrize("level", [0.9, 0.3, 0.0, -0.5, -0.95])
def test_area_centroid_and_moments_are_those_of_a_segment(level):
    """In closed form, with half the angle φ of the arc: A = φ − sin φ cos φ, A ζ = ⅔ sin³ φ, about the centre."""
    φ = np.arccos(-level)
    area, first = φ - np.sin(φ) * np.cos(φ), 2.0 / 3.0 * np.sin(φ) ** 3
    across = (φ - np.sin(φ) * np.cos(φ) * (1 + 2.0 / 3.0 * np.sin(φ) ** 2)) / 4.0  # ∫ η² dA
    over = (φ - np.sin(4.0 * φ) / 4.0) / 4.0  # ∫ ζ² dA
    for number in (160, 12):
        rule = Segment(level, UP).rule(number)
        assert len(rule) == number
        y, z = rule.points.T
        found = np.pi * np.array([rule.weights.sum(), rule.weights @ z, rule.weights @ y**2, rule.weights @ z**2])
        np.testing.assert_allclose(
            found,
            [area, first, across, over],
            rtol=1e-10 if number == 160 else 3e-2,
            atol=0.0 if number == 160 else 6e-3,
        )
        assert rule.weights @ y == pytest.approx(0.0, abs=1e-12)


def test_half_a_disk_in_torsion():
    """J = (π/2 − 4/π) r⁴: the Fourier series of Prandtl's function in the angle is 8/π Σ 1/(n² (n + 2)²), odd n."""
    n = np.arange(1.0, 2e4, 2.0)
    series = 8.0 / np.pi * np.sum(1.0 / (n * (n + 2.0)) ** 2)
    assert series == pytest.approx(np.pi / 2 - 4 / np.pi, rel=1e-9)
    assert Segment(0.0, (0.6, -0.8)).warping().torsion == pytest.approx(series, rel=3e-4)


def test_a_whole_disk_warps_as_in_closed_form():
    """Not by its twist, and by its forces as `shape` says."""
    places, closed = np.concatenate([polar(2, 7).points, rim(5)]), np.empty((5, 19))
    found = Segment(1.0, UP).warping()
    assert np.diag(found.stiffness) == pytest.approx([6 / 7, 6 / 7, 0.5], rel=1e-9)
    y, z = np.ascontiguousarray(places.T)
    curved_shape(y, z, 0.0, closed)
    ours = found.shear(places)
    np.testing.assert_allclose(ours[:, :2].reshape(4, -1), closed[1:], atol=1e-9)
    np.testing.assert_allclose(ours[:, 2], [-z, y], atol=1e-9)


@pytest.mark.parametrize("index", [3.0, 8.0])
def test_a_whole_disk_warps_in_a_coil_as_the_sector_of_a_ring(index):
    """Pulled apart along the axis by 1 N: γ3 and φ′ of Q3 = 1, Mt = D/2; against displacements without sections."""
    stiffness, load = np.pi * Segment(1.0, UP).warping(1.0 / index).stiffness, np.array([0.0, 1.0, index])  # G = r = 1
    rate = 1.0 / (2.0 * np.pi * index * load @ np.linalg.solve(stiffness, load))
    assert rate / (2.0**4 / (8.0 * (2.0 * index) ** 3)) == pytest.approx(ring_sector(index)[0], rel=1e-6)


def test_the_flat_of_a_spring_is_its_seat():
    """Points on the line that bounds a section lie in the plane of the seat, and its other points above it."""
    analysis = Analysis(check(CASE))
    spring, place, rod = analysis.spring, analysis.rod.placement, analysis.rod
    cut = place.flat[..., 0] < 1.0
    tips = 2 * 0.25 * SPRING["wire_diameter"]
    assert cut[[0, -1]].all()
    assert not cut[len(cut) // 2].any()
    turns = analysis.setup.section_turns
    assert turns[cut][turns[cut] < 3].max() == pytest.approx(spring.flat_turns("bottom"), abs=0.06)
    assert spring.free_length - spring.centre_line(5.5)[2] == pytest.approx(tips / 2 - 2.5)
    places, weights = spread(rod.rule.points, rod.rule.weights, cut.shape, cut_points(rod.rule, place))
    assert weights[~cut].sum(axis=-1) == pytest.approx(1.0)
    for cell in (0, 5, len(cut) - 1):
        t = spring.tangent(turns[cell, 1])
        inwards = spring.curvature_vector(turns[cell, 1])
        inwards /= np.linalg.norm(inwards)
        axes = np.stack([inwards, np.cross(t, inwards)])
        level, *normal = place.flat[cell, 1]
        edge = -level * np.array(normal) + np.outer([-0.3, 0.2], [normal[1], -normal[0]])
        seat = 0.0 if cell < 10 else spring.free_length
        height = (spring.centre_line(turns[cell, 1]) + 2.5 * edge @ axes)[:, 2]
        assert height == pytest.approx(seat, abs=1e-9)
        height = (spring.centre_line(turns[cell, 1]) + 2.5 * places[cell, 1] @ axes)[:, 2]
        assert (height > 0).all()
        assert (height < spring.free_length).all()
        assert np.hypot(*places[cell, 1].T).max() < 1.0


def test_chords_are_cut_as_the_true_sections_are():
    """And their sections are softer: the area that is left carries the normal force of a tip, its J the torsion."""
    plane = {"elements_per_turn": 12, "section": {"kind": "plane"}}
    curved, chords = (Analysis(check(CASE | {"mesh": plane | {"axis": axis}})).rod for axis in ("curved", "chords"))
    np.testing.assert_array_equal(chords.placement.flat, curved.placement.flat)
    level, *normal = chords.placement.flat[0, 0]
    tangent = chords.coefficients.D[0, 0]
    left = Segment(level, tuple(normal))
    area = left.rule(len(chords.rule)).weights.sum()
    assert area < 0.7
    assert tangent[0, 0] == pytest.approx(curved.law.E * np.pi * 2.5**2 * area, rel=1e-9)
    assert tangent[3, 3] == pytest.approx(curved.law.G * np.pi * 2.5**4 * left.warping().stiffness[2, 2], rel=0.02)


def test_springs_that_are_not_ground_are_whole():
    spring = SpringSpec(**SPRING | {"end_coils": "closed"})
    analysis = Analysis(check(CASE | {"spring": spring.model_dump(exclude_none=True)}))
    assert np.isinf(analysis.rod.placement.flat[..., 0]).all()


@pytest.mark.parametrize("level", [0.5, -0.5])
def test_a_coil_of_what_is_left_is_as_stiff_as_its_slice(level):
    """Found: +0.10 and +0.01 %; with the warping of a straight wire +0.35 and +4.2 %."""
    law = library.load("elastic")
    ours = CutCoil(law, level, 4.0).rate()
    assert ours == pytest.approx(slice_rate(law, level, 4.0), rel=1.5e-3)
    assert CutCoil(law, 1.0, 4.0).rate() > ours * (40 if level < 0 else 1.5)


def test_a_coiled_wire_that_is_ground_is_at_rest():
    """Its sections have stresses, but no resultants."""
    rod = Analysis(check(CASE | {"spring": SPRING | {"made_by": "coiling"}})).rod
    cut = rod.placement.flat[..., 0] < 1.0
    stress = rod.state["point_state"].equilibrium[..., 0]
    assert np.abs(stress[cut]).max() > 50.0
    area = np.pi * 2.5**2
    assert np.abs(rod.coefficients.s[..., 0]).max() < 1e-8 * area * np.abs(stress).max()
    assert np.abs(rod.coefficients.s[..., 3:]).max() < 1e-8 * area * 2.5 * np.abs(stress).max()
