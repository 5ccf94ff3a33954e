"""The `seats` section of a case: wrong ones get one line, and what the freedoms mean for where the force goes."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.contacts import FREE_TILT_OF_BEDDING, MODULUS_OF_BEDDING
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check

SPRING = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 7.5,
    "free_length": 75.0,
    "end_coils": {"form": "closed and ground"},
}
LIGHT = [{"to": {"force": 30}, "steps": 2}]


def case(seats, loading=LIGHT, spring=SPRING, **more):
    return check(
        {"spring": spring, "material": "elastic", "seats": seats, "loading": loading, "accuracy": "none", **more}
    )


@pytest.mark.parametrize(
    ("seats", "words"),
    [
        ({"hold": "glue"}, "seats.hold: 'glue'"),
        ({"bottom": {"shape": "conical"}}, "seats.bottom: a conical seat needs its angle"),
        ({"top": {"shape": "stepped"}}, "seats.top: a stepped seat needs its turns"),
        ({"top": {"angle": 10}}, "seats.top: angle is for conical seats, not for flat ones"),
        ({"top": {"shape": "conical", "angle": 70}}, "seats.top.angle: 70"),
        ({"top": {"tilt": "free"}}, "the top seat moves, but tips are held in space; give hold: groove"),
        ({"top": {"tilt": -3.0}}, "seats.top.tilt"),
        ({"hold": "groove", "bottom": {"turn": "free"}, "top": {"turn": "free"}}, "turn: both seats are free"),
        ({"groove": 0.5}, "give hold: groove with it"),
        ({"hold": "groove", "groove": 0}, "seats.groove: 0"),
    ],
)
def test_wrong_seats_get_one_line(seats, words):
    with pytest.raises(InputError) as caught:
        case(seats)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_seats_must_fit_ends_program_and_spring():
    with pytest.raises(InputError, match="between clamped ends"):
        case({"hold": "groove"}, ends="clamped")
    with pytest.raises(InputError, match="block is defined for flat seats only"):
        case({"top": {"shape": "conical", "angle": 5}}, [{"to": "block"}])
    with pytest.raises(InputError, match=r"seats.bottom.turns: 9: the spring has 7.5 turns"):
        Analysis(case({"bottom": {"shape": "stepped", "turns": 9}}), MPI.COMM_SELF)


def run(seats, loading=LIGHT, spring=SPRING):
    """Analysis and Result; each step is in balance to 1e-8 of its force, and that times the diameter, at every cut."""
    analysis = Analysis(case(seats, loading, spring), MPI.COMM_SELF)

    def judge(step):
        assert analysis.imbalance()[0] < 1e-8 * step.force_N
        assert analysis.imbalance()[1] < 1e-8 * step.force_N * spring["mean_diameter"]

    return analysis, analysis.run(judge)


@pytest.fixture(scope="module")
def guided():
    return run({"hold": "groove"})


def test_a_ball_joint_keeps_the_force_on_its_axis(guided):
    """A plate that may tilt and turn about its centre bears no moment there: the force passes through it, but for the
    softness of the joint, 2.2 N mm/rad: e = k θ/F. Between guided plates it is 2 mm off at either end."""
    _, held = guided
    analysis, free = run({"hold": "groove", "top": {"tilt": "free", "turn": "free"}})
    for step in range(2):
        assert held.seats[step].top.eccentricity_mm > 1.5
        assert free.seats[step].top.eccentricity_mm < 1e-3
        assert abs(free.seats[step].top.moment_z_Nmm) < 1e-6 * abs(held.seats[step].top.moment_z_Nmm)
        assert free.seats[step].bottom.eccentricity_mm > 0.5
    tilt = np.hypot(*analysis.system.seats[9:11])
    softness = FREE_TILT_OF_BEDDING * analysis.law.E / MODULUS_OF_BEDDING * 16.0**3
    assert tilt > 1e-3
    assert free.seats[1].top.tilt_rad == pytest.approx(tilt, rel=1e-3)
    assert free.seats[1].top.eccentricity_mm == pytest.approx(softness * tilt / 30.0, rel=0.01)


def test_a_stiff_tilt_is_a_guided_seat_and_a_soft_one_a_ball_joint(guided):
    """Eccentricity over the stiffness of the tilt: from that of the ball joint to that of the guided seat."""
    found = []
    for stiffness in (1e-1, 1e3, 1e9):
        _, result = run({"hold": "groove", "top": {"tilt": stiffness}})
        found.append(result.seats[-1].top.eccentricity_mm)
    assert found[0] < 0.02 < found[1] < guided[1].seats[-1].top.eccentricity_mm
    assert found[2] == pytest.approx(guided[1].seats[-1].top.eccentricity_mm, rel=1e-4)


def test_a_seat_that_is_free_sideways_has_no_lateral_force(guided):
    """And one on springs bears what these hold: k times the way."""
    assert np.hypot(guided[1].seats[-1].top.lateral_x_N, guided[1].seats[-1].top.lateral_y_N) > 1.0
    _, free = run({"hold": "groove", "top": {"sideways": "free"}})
    assert np.hypot(free.seats[-1].top.lateral_x_N, free.seats[-1].top.lateral_y_N) < 1e-6
    analysis, sprung = run({"hold": "groove", "top": {"sideways": 5.0}})
    way = analysis.system.seats[6:8]
    assert np.hypot(*way) > 0.05
    # the spring's force on the seat is minus the seat's on the spring
    lateral = [sprung.seats[-1].top.lateral_x_N, sprung.seats[-1].top.lateral_y_N]
    np.testing.assert_allclose(lateral, -5.0 * way, rtol=1e-6, atol=1e-6)


def test_a_cone_moves_the_end_coil_towards_or_off_the_axis():
    """A bowl that rises outwards by 20° presses the end coil together, a dome spreads it; a flat seat does neither."""
    radius = {}
    for angle in (-20, 0, 20):
        seat = {"shape": "conical", "angle": angle} if angle else {}
        analysis, _ = run({"bottom": seat})
        end_coil = analysis.layout.gather(analysis.rod.x)[1:14]
        radius[angle] = np.hypot(*end_coil[:, :2].T).mean()
    assert radius[20] < radius[0] - 1e-3
    assert radius[0] + 1e-3 < radius[-20]


def test_a_step_takes_turns_away():
    """Steps over 0.75 turns at either end of 5 leave 3.5 turns, and a little of the wire on the steps, which bear from
    below only and are no clamps; R ∝ 1/n against the same spring on flat seats, where only its tips touch."""
    open_ended = {"wire_diameter": 4.0, "mean_diameter": 40.0, "turns": 5.0, "pitch": 9.0}
    travel, step = [{"to": {"travel": 3}, "steps": 2}], {"shape": "stepped", "turns": 0.75}
    flat, stepped = run({}, travel, open_ended)[1], run({"bottom": step, "top": step}, travel, open_ended)[1]
    assert 3.5 < stepped.seats[-1].active_turns < 3.8
    ratio = stepped.steps[-1].force_N / flat.steps[-1].force_N
    assert ratio == pytest.approx(flat.seats[-1].active_turns / stepped.seats[-1].active_turns, rel=0.05)
