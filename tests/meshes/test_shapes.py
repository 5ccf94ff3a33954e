"""Every shape's example against formulas in closed form, written down here from the shape's definition."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import quad

from coilset.meshes.springs.spring import SpringSpec

EXAMPLES = Path(__file__).parents[2] / "examples" / "springs"
EXACT = 1e-9


def example(name):
    entries = yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    return SpringSpec.model_validate(entries["spring"]).build()


def conical_length(r1, r2, turns, pitch):
    """Wire length of a conical helix: ∫ √((2π r)² + B²) dr · turns/(r2 − r1), B² = pitch² + ((r2 − r1)/turns)²."""
    k = (r2 - r1) / turns
    B2, A = pitch**2 + k**2, 2 * np.pi

    def primitive(r):
        root = np.sqrt((A * r) ** 2 + B2)
        return 0.5 * (r * root + B2 / A * np.arcsinh(A * r / np.sqrt(B2)))

    return (primitive(r2) - primitive(r1)) / k


def cylindrical_length(r, turns, pitch):
    return turns * np.hypot(2 * np.pi * r, pitch)


def conical_rise(r1, r2, turns, d):
    """Rise of conical coils that lie on each other; their centres are d apart, (r2 − r1)/turns of it in radius."""
    return turns * np.sqrt(d**2 - ((r2 - r1) / turns) ** 2)


def parabolic_length(r_ends, r_middle, turns, pitch):
    """No elementary closed form; by adaptive quadrature in x = 2t/turns − 1, r = r_middle − (r_middle − r_ends) x²."""
    h = r_middle - r_ends

    def speed(x):
        slope = -2 * h * x * 2 / turns
        return np.sqrt((2 * np.pi * (r_middle - h * x**2)) ** 2 + slope**2 + pitch**2)

    return quad(speed, -1, 1, epsabs=1e-11)[0] * turns / 2


def touching_rise(change, turns, d):
    """Rise of the wire where every coil lies on the next: mean over the meridians of n − 1 turns, half at both ends.

    `change` is r(t + 1) − r(t) as a function of t; adaptive quadrature with the corner at the middle of the spring.
    """

    def rise(t):
        return np.sqrt(max(d**2 - change(t) ** 2, 0.0))

    halves = ((0.0, 0.5 * (turns - 1)), (0.5 * (turns - 1), turns - 1.0))
    within = sum(quad(rise, *half, epsabs=1e-11, limit=200)[0] for half in halves)
    return within + 0.5 * (rise(0.0) + rise(turns - 1.0))


def parabolic_rise(r_ends, r_middle, turns, d):
    """r(t + 1) − r(t) of a parabola falls linearly, from m (1 − 1/turns) at t = 0; m = 4 (r_middle − r_ends)/turns."""
    m = 4 * abs(r_middle - r_ends) / turns
    return touching_rise(lambda t: m * (1 - (2 * t + 1) / turns), turns, d)


def folded(slope, turns):
    """r(t + 1) − r(t) of a double cone with a given slope up to half of its turns."""

    def radius(t):
        return slope * min(t, turns - t)

    return lambda t: radius(t + 1) - radius(t)


def flattened(slope, turns):
    """r(t + 1) − r(t) of a funnel, a cone up to half of its turns and a cylinder from there on."""
    return lambda t: slope * (min(t + 1, turns / 2) - min(t, turns / 2))


# pitch of the barrel: 89 mm = 6 pitch + 5 mm
SHAPES = {
    # name: (d, r at the bottom, r at the top, turns, rise, wire length, rise at block)
    "cylinder": (5, 20, 20, 2.5, 30, cylindrical_length(20, 2.5, 12), 2.5 * 5),
    "cone": (5, 30, 15, 5, 70, conical_length(30, 15, 5, 14), conical_rise(30, 15, 5, 5)),
    "double_cone": (4, 14, 14, 6, 66, 2 * conical_length(14, 20, 3, 11), touching_rise(folded(2, 6), 6, 4)),
    "barrel": (5, 15, 15, 6, 84, parabolic_length(15, 25, 6, 14), None),
    "hourglass": (4, 22, 22, 6, 66, parabolic_length(22, 14, 6, 11), None),
    "funnel": (
        4,
        26,
        14,
        6,
        66,
        conical_length(26, 14, 3, 11) + cylindrical_length(14, 3, 11),
        touching_rise(flattened(-4, 6), 6, 4),
    ),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shape_meets_its_closed_formulas(name):
    d, r_bottom, r_top, turns, rise, length, at_block = SHAPES[name]
    spring = example(name)
    assert spring.turns == turns
    assert spring.wire_length == pytest.approx(length, rel=EXACT)
    assert spring.free_length == pytest.approx(rise + d, rel=EXACT)
    if at_block is not None:
        # 1e-9 but for the funnel, whose coils begin to lie on each other with a vertical tangent of the rise: 2.5e-7
        assert spring.block_height == pytest.approx(at_block + d, rel=1e-6 if name == "funnel" else EXACT)
    end = 2 * np.pi * turns
    np.testing.assert_allclose(
        spring.centre_line(np.array([0.0, turns])),
        [[r_bottom, 0, d / 2], [r_top * np.cos(end), r_top * np.sin(end), rise + d / 2]],
        atol=1e-9,
    )
    nodes = spring.stations(16)
    assert len(nodes) - 1 == 16 * turns
    assert (nodes[0], nodes[-1]) == (0, turns)


@pytest.mark.parametrize(("name", "r_ends", "r_middle", "d"), [("barrel", 15, 25, 8), ("hourglass", 22, 14, 6)])
def test_block_height_of_parabolas(name, r_ends, r_middle, d):
    # The wire is thick enough for every coil to lie on the next, so that the formula of the circle holds.
    shape = {"shape": name, "ends": 2.0 * r_ends, "middle": 2.0 * r_middle}
    spring = SpringSpec(wire_diameter=d, mean_diameter=shape, turns=6, pitch=11.0).build()
    assert spring.block_height == pytest.approx(parabolic_rise(r_ends, r_middle, 6, d) + d, rel=EXACT)


def test_ground_spring():
    # n = 5.5, d = 4: z runs over two end turns of 4 mm each, two transitions of half a turn at (4 + p)/2 on average
    # and 4.5 turns at p; both tips keep d/4, so that the seats are d/4 inside the outermost centres.
    spring = example("closed_and_ground")
    d, body, free = 4.0, 4.5, 75.0
    pitch = (free + 0.5 * d - 2 * d - 0.5 * d) / (body + 0.5)
    assert spring.pitch(3.75) == pytest.approx(pitch, rel=EXACT)
    assert spring.free_length == pytest.approx(free, rel=EXACT)
    assert spring.active_turns == 5.5
    # 7.5 coils on each other, from centre to centre 7.5 d; EN 13906-1 bounds the block of ground springs by 7.5 d
    assert spring.block_height == pytest.approx(7.5 * d - 0.5 * d, rel=EXACT)
    first, last = spring.centre_line(np.array([0.0, 7.5]))
    np.testing.assert_allclose(first, [16, 0, -d / 4], atol=1e-9)
    np.testing.assert_allclose(last, [-16, 0, free + d / 4], atol=1e-9)
    assert spring.hand == -1
    # it turns from +x towards −y
    assert spring.centre_line(0.25)[1] == pytest.approx(-16)
    # the flat ends where the centre line has risen from −d/4 to d/2, 3/4 of the end turn's d
    assert spring.flat_turns("bottom") == pytest.approx(0.75, rel=1e-9)
    assert spring.flat_turns("top") == pytest.approx(0.75, rel=1e-9)
    np.testing.assert_allclose(spring.seat_distance(np.array([0.0, 0.375, 2.0]), "bottom"), [-1, 0.5, 2], atol=1e-9)


def test_closed_ends_lie_on_the_next_coil():
    spec = {"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 7.0, "pitch": 10.0}
    ends = {"bottom": {"form": "closed", "turns": 1.25}, "top": {"form": "closed"}}
    spring = SpringSpec(**spec, end_coils=ends).build()
    z = spring.centre_line(np.array([0.0, 1.0, 1.25, 1.75, 5.5, 6.0, 7.0]))[:, 2]
    # smooth transition: the mean of both pitches, (4 + 10)/2, over half a turn
    np.testing.assert_allclose(np.diff(z), [4, 1, 3.5, 37.5, 3.5, 4], rtol=1e-9)
    t = np.array([1.25, 1.75, 5.5, 6.0])
    np.testing.assert_allclose(spring.pitch(t), [4, 10, 10, 4], rtol=1e-12)
    # the pitch has no corners: its slope vanishes at both ends of the transition
    np.testing.assert_allclose(spring.acceleration(t)[:, 2], 0, atol=1e-9)
    assert spring.active_turns == 4.75


def test_variable_pitch():
    # piecewise linear: 2 turns of 7, 2 of 10 on average, 2 of 13
    spring = example("variable_pitch")
    np.testing.assert_allclose(np.diff(spring.centre_line(np.array([0.0, 2, 3, 4, 6]))[:, 2]), [14, 8.5, 11.5, 26])
    assert spring.free_length == pytest.approx(64)

    # ds = √((πD)² + p²) dt; ∫ of it over a linear p is that of the cone with the parts exchanged
    def primitive(p):
        c = np.pi * 36
        return 0.5 * (p * np.hypot(c, p) + c**2 * np.arcsinh(p / c))

    ramp = (primitive(13) - primitive(7)) / 3
    length = 2 * np.hypot(np.pi * 36, 7) + ramp + 2 * np.hypot(np.pi * 36, 13)
    assert spring.wire_length == pytest.approx(length, rel=EXACT)
    assert spring.block_height == pytest.approx(7 * 4)


def test_variable_wire():
    spring = example("variable_wire")
    t = np.linspace(0, 5, 101)
    d = spring.wire_diameter(t)
    np.testing.assert_allclose(spring.wire_diameter(np.array([0, 1, 2.5, 4, 5])), [3, 3, 5, 3, 3])
    assert d.min() >= 3 - 1e-12
    assert d.max() <= 5 + 1e-12
    # a Hermite cubic from 3 to 5 with flat ends: 3 + 2 (3u² − 2u³); its mean square is 9 + 6 + 4·13/35
    mean_square = 9 + 12 * 0.5 + 4 * 13 / 35
    speed = np.hypot(np.pi * 40, 11)
    assert spring.volume == pytest.approx(np.pi / 4 * speed * (2 * 9 + 3 * mean_square), rel=EXACT)
    assert spring.block_height == pytest.approx(2 * 3 + 3 * 4 + 3)


def test_tangent_is_the_derivative_of_the_centre_line():
    spring = example("cone")
    t, h = np.linspace(0.1, 4.9, 23), 1e-5
    central = (spring.centre_line(t + h) - spring.centre_line(t - h)) / (2 * h)
    np.testing.assert_allclose(spring.velocity(t), central, atol=1e-6)
    second = (spring.velocity(t + h) - spring.velocity(t - h)) / (2 * h)
    np.testing.assert_allclose(spring.acceleration(t), second, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(spring.tangent(t), axis=1), 1, rtol=1e-14)


def test_arc_length_and_curvature_of_the_helix():
    spring = example("cylinder")
    t = np.array([[0.0, 0.3], [1.7, 2.5]])
    np.testing.assert_allclose(spring.arc_length(t), t * np.hypot(40 * np.pi, 12), rtol=1e-13, atol=1e-12)
    # κ = r/(r² + (p/2π)²)
    np.testing.assert_allclose(spring.curvature(t), 20 / (400 + (12 / (2 * np.pi)) ** 2), rtol=1e-12)


def test_table_with_a_spline_meets_a_cubic():
    # the cubic spline with not-a-knot ends reproduces a cubic polynomial
    turns = [0.0, 1.0, 2.5, 3.0, 4.0, 6.0]
    cubic = np.polynomial.Polynomial([40, 2, -1.5, 0.2])
    table = {"turns": turns, "values": [float(cubic(t)) for t in turns], "interpolation": "spline"}
    spring = SpringSpec(wire_diameter=4.0, mean_diameter=table, turns=6.0, pitch=12.0).build()
    t = np.linspace(0, 6, 50)
    np.testing.assert_allclose(2 * spring.mean_radius(t), cubic(t), rtol=1e-12)


def test_free_length_of_a_spring_that_is_thicker_in_its_middle():
    # at a small pitch the thick middle would reach below the tips; here the tips stand on the seats: 60 = 5 p + 3
    wire = {"turns": [0, 2.5, 5], "values": [3.0, 9.0, 3.0], "interpolation": "linear"}
    spring = SpringSpec(wire_diameter=wire, mean_diameter=60.0, turns=5.0, free_length=60.0).build()
    assert spring.pitch(2.0) == pytest.approx(57 / 5, rel=1e-12)


def test_free_length_and_pitch_derive_each_other():
    ends = {"form": "closed and ground", "turns": 1.0, "transition": 0.75, "tip": 0.5}
    spec = {"wire_diameter": 4.0, "mean_diameter": {"shape": "cone", "bottom": 40.0, "top": 30.0}, "turns": 7.0}
    by_pitch = SpringSpec(**spec, pitch=9.0, end_coils=ends).build()
    by_length = SpringSpec(**spec, free_length=by_pitch.free_length, end_coils=ends).build()
    assert by_length.pitch(3.0) == pytest.approx(9.0, rel=1e-12)
    assert SpringSpec(**spec, pitch=9.0, free_length=by_pitch.free_length, end_coils=ends).build().pitch(3.0) == 9.0


def test_outer_and_inner_diameters_are_a_wire_off_the_mean_one():
    """D = De − d = Di + d, to the bit where the numbers are whole; also where both run over the turns."""
    drawing = {"wire_diameter": 5.0, "turns": 4.0, "pitch": 12.0}
    t = np.linspace(0, 4, 200)
    mean = SpringSpec(mean_diameter=40.0, **drawing).build()
    for entry, value in (("outer_diameter", 45.0), ("inner_diameter", 35.0)):
        spring = SpringSpec(**{entry: value}, **drawing).build()
        np.testing.assert_array_equal(spring.mean_radius(t), mean.mean_radius(t))
        np.testing.assert_array_equal(spring.centre_line(t), mean.centre_line(t))
    wire = {"turns": [0, 1.5, 4], "values": [4.0, 5.0, 4.5], "interpolation": "monotone"}
    barrel = {"shape": "barrel", "ends": 40.0, "middle": 50.0}
    spring = SpringSpec(wire_diameter=wire, outer_diameter=barrel, turns=4.0, pitch=12.0).build()
    outer = 40.0 + 10.0 * (1.0 - (t / 2.0 - 1.0) ** 2)
    np.testing.assert_allclose(2 * spring.mean_radius(t), outer - spring.wire_diameter(t), rtol=1e-13)


def test_dead_coils_several_pitches_and_coils_that_are_closed_in_the_middle():
    """Two dead coils at each end; pitches of 6 and 8 mm with two and a half closed coils between them, by hand."""
    pitch = {"turns": [0, 4, 4.5, 7, 7.5, 12], "values": [6, 6, 3, 3, 8, 8], "interpolation": "linear"}
    ends = {"form": "closed and ground", "turns": 2.0}
    spring = SpringSpec(wire_diameter=3.0, mean_diameter=24.0, turns=12.0, pitch=pitch, end_coils=ends).build()
    rise = 2 * 3 + 0.5 * 4.5 + 1.5 * 6 + 0.5 * 4.5 + 2.5 * 3 + 0.5 * 5.5 + 2 * 8 + 0.5 * 5.5 + 2 * 3
    assert spring.free_length == pytest.approx(rise - 2 * 0.25 * 3.0)
    assert spring.block_height == pytest.approx(12 * 3.0 - 2 * 0.25 * 3.0)
    assert spring.active_turns == 8.0
    assert spring.pitch(np.array([1.9, 3.0, 5.5, 8.5, 10.1])) == pytest.approx([3.0, 6.0, 3.0, 8.0, 3.0])
