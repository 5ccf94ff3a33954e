"""Friction: exact derivatives, balance, sticking, sliding and rolling, and what a cycle of a spring loses."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.contact.base import SEAT_DOFS, TrialPositions
from coilset.model.core.contact.coils import Coils
from coilset.model.core.contact.curve import CentreLine
from coilset.model.core.contact.seat import Seat
from coilset.model.core.material import library
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.section.rules import polar
from coilset.model.physics.friction.friction import PREDICTED, CoilFriction, SeatFriction, along_cone, on_cone
from coilset.verification.frame import Frame
from coilset.verification.wire_points import wire_points

BEDDING, ONSET, MU = 1e3, 0.5, 0.3  # a long onset: no point comes to its end by the differences
SPRING = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 5.0,
    "free_length": 45.0,
    "end_coils": {"form": "closed and ground", "turns": 1.0, "transition": 0.5, "tip": 0.25},
}


def dense(friction, x, seats, rotations):
    """Forces and stiffness on displacements of all stations, seats, and rotations, exact after one iterate there."""
    friction.evaluate(TrialPositions(x, seats, rotations))
    friction.iterate()
    part = friction.evaluate(TrialPositions(x, seats, rotations))
    size = 2 * x.size + len(seats)
    f, K = np.zeros(size), np.zeros((size, size))
    for dofs, force, k in zip(part.dofs, part.forces, part.stiffness, strict=True):
        np.add.at(f, dofs, force)
        np.add.at(K, np.ix_(dofs, dofs), k)
    return f, K


@pytest.fixture
def rubbing(points, helix):
    """A friction, with stations and seats that press, slip and stick."""

    def make(kind, mu=MU, **seat):
        wire, x, seats = points(), helix(9.0, lift=2.5), np.zeros(12)
        seats[SEAT_DOFS + 2] = 27.5
        if kind == "coils":
            normal, place = Coils(wire, helix(12.0), BEDDING, 0.02), helix(4.8, taper=1.0, seed=1, noise=0.002)
            friction = CoilFriction(normal, mu, place, seats)
        else:
            normal = Seat(kind, wire, wire.radius, x, seats, BEDDING, ONSET, moves=True, **seat)
            place = helix(0.5, seed=1, noise=0.01, lift=2.2)
            seats = np.array([0.1, -0.1, 0, 1e-3, 2e-3, 1e-3, 0.2, 0.1, 5.65, -1e-3, 3e-3, 2e-3])
            friction = SeatFriction(normal, mu, place, seats)
        rng = np.random.default_rng(5)
        traction = rng.normal(size=friction.memory["traction"].shape)
        friction.memory.committed("traction")[...] = traction
        # slips of 0.01 mm between coils and less than 0.001 mm on a seat: some points stick, others slide
        slip = 0.01 if kind == "coils" else 0.0005
        return (
            friction,
            place + slip * rng.normal(size=place.shape),
            seats + 0.1 * slip * rng.normal(size=12),
            slip * rng.normal(size=place.shape),
        )

    return make


KINDS = [("bottom", {}), ("top", {}), ("top", {"slope": 0.3}), ("coils", {})]


@pytest.mark.parametrize(("kind", "seat"), KINDS, ids=str)
def test_stiffness_is_the_derivative_of_the_forces(rubbing, kind, seat):
    """Central differences with h = 1e-7 are good to 1e-6 of forces on the scale of 0.01 mm."""
    friction, x, seats, rotations = rubbing(kind, **seat)
    f, K = dense(friction, x, seats, rotations)
    size = np.linalg.norm(friction.memory["traction"].reshape(-1, 3), axis=1)
    assert len(friction.touching(TrialPositions(x, seats))[0]) > 10
    assert np.linalg.norm(K - K.T) > 1e-3 * np.linalg.norm(K)  # some slide
    assert size.max() > 0.0
    direction, h = np.random.default_rng(2).normal(size=f.shape), 1e-7

    def moved(sign):
        u = sign * h * direction
        n = x.size
        moved_x, swung = x + u[:n].reshape(-1, 3), rotations + u[n + 12 :].reshape(-1, 3)
        return dense(friction, moved_x, seats + u[n : n + 12], swung)[0]

    change = (moved(1) - moved(-1)) / (2 * h)
    np.testing.assert_allclose(K @ direction, change, rtol=0, atol=1e-6 * np.abs(change).max())


@pytest.mark.parametrize(("kind", "seat"), KINDS, ids=str)
def test_tractions_stay_in_the_cone_and_points_stick_and_slide(rubbing, kind, seat):
    """|t| ≤ μ p at every place that bears; some points reach it, which slide, and some do not, which stick."""
    friction, x, seats, rotations = rubbing(kind, **seat)
    dense(friction, x, seats, rotations)
    normal = friction.normal.evaluate(TrialPositions(x, seats))
    # on coils a point has several places; both lists are in the order of the pairs that bear
    coils, trial = friction.normal, TrialPositions(x, seats)
    places = coils.places(*coils.pressed(trial)[:2]) if kind == "coils" else (normal.point,)
    assert len(set(zip(*places, strict=True))) == len(normal.pressure) > 10
    share = np.linalg.norm(friction.memory["traction"][places], axis=1) / (MU * normal.pressure)
    assert share.max() == pytest.approx(1.0, rel=1e-9)
    assert 3 < np.count_nonzero(share < 0.99) < len(share) - 3
    free = np.ones(friction.memory["traction"].shape[:-1], bool)
    free[places] = False
    assert not friction.memory["traction"][free].any()  # what does not bear does not rub


def test_stiffness_is_a_chord_where_a_slip_reverses():
    """From t* = 2 to −3 under μ p = 1, with the tangent of the last iterate on the way: 0 along the slip, so that 1 is
    foreseen, where −1 is found. The chord from there to slip 0, with t = 1, is 2/3; across it the stiffness is 1/3."""
    n, nothing, iterate = (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), np.zeros(PREDICTED)
    for T, along in (((2.0, 0.0, 0.0), 0.5), ((2.0, 0.0, 0.0), 0.0), ((-3.0, 0.0, 0.0), 2.0 / 3.0)):
        t, cone = on_cone(T, n, 1.0, nothing, iterate)
        assert t == pytest.approx((np.sign(T[0]), 0.0, 0.0))
        assert along_cone(T, n, cone, (1.0, 0.0, 0.0), nothing, 0.0) == pytest.approx((along, 0.0, 0.0))
        assert along_cone(T, n, cone, (0.0, 1.0, 0.0), nothing, 0.0) == pytest.approx((0.0, 1.0 / abs(T[0]), 0.0))


def test_tractions_are_foreseen_to_first_order(rubbing):
    """What the tangent of an iterate foresees for a small correction is what is found, to its square."""
    friction, x, seats, rotations = rubbing("coils")
    dense(friction, x, seats, rotations)
    friction.iterate()
    direction, errors = np.random.default_rng(6).normal(size=x.shape), []
    for h in (1e-5, 5e-6):
        friction.evaluate(TrialPositions(x + h * direction, seats, rotations))
        at, found = friction._trial
        slides = np.linalg.norm(found[:, :3], axis=1) > found[:, 3]
        errors.append(np.abs(found[:, 4:] - friction.memory["traction"][at])[slides].max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_a_point_between_two_coils_rubs_on_each_by_itself(points, helix):
    """Coils 0 and 2 lie on each other, and coil 1 around both: turned by 0.2 mrad, all keep the tractions of then."""
    wire, turns, seats = points(), np.linspace(0.0, 2.5, 41), np.zeros(12)
    angle, R = 2 * np.pi * turns, 20.0 + 4.2 * np.sin(0.5 * np.pi * turns) ** 2
    x = np.stack([R * np.cos(angle), R * np.sin(angle), 2.45 * turns], axis=1)
    friction = CoilFriction(Coils(wire, helix(12.0), BEDDING, 0.02), 0.3, x, seats)
    at = friction.normal.places(*friction.normal.pressed(TrialPositions(x, seats))[:2])
    between = [i for i in set(at[0]) if {1, 3} <= set(at[1][at[0] == i])]
    assert len(between) > 5
    assert len(set(zip(*at, strict=True))) == len(at[0])
    rotations = 2e-4 * np.random.default_rng(3).normal(size=x.shape)
    slipped, _ = dense(friction, x, seats, rotations)
    assert np.linalg.norm(friction.memory["traction"][between][:, (1, 3)], axis=2).min() > 0.0
    friction.memory.state.commit()
    again, _ = dense(friction, x, seats, np.zeros_like(x))
    np.testing.assert_allclose(again, slipped, rtol=0, atol=1e-12 * np.abs(slipped).max())


def test_a_point_between_two_farther_coils_rubs_on_each_by_itself():
    """Coil 0 lies in the groove between coils 2 and 3, which coil 1 leads to from outside: all keep their tractions."""
    turns, seats = np.linspace(0.0, 3.75, 61), np.zeros(12)
    angle, away = 2 * np.pi * turns, np.array([0.0, 0.75, 1.0, 1.75, 2.0, 2.875, 3.125, 3.75])
    R = np.interp(turns, away, [20.0, 20.0, 32.0, 32.0, 17.5, 17.5, 22.5, 22.5])
    z = np.interp(turns, away, [0.0, 0.0, 0.0, 4.3, 4.3, 4.3, 4.3, 4.3])
    apart, x = (np.stack([R * np.cos(angle), R * np.sin(angle), level], axis=1) for level in (12.0 * turns, z))
    wire = CentreLine(turns, np.full(61, 2.5), np.full(60, 2 * np.pi * 20.0 / 16)).points()
    friction = CoilFriction(Coils(wire, apart, BEDDING, 0.02), 0.3, x, seats)
    pair, where = friction.normal.pressed(TrialPositions(x, seats))[:2]
    at = friction.normal.places(pair, where)
    farther = np.bincount(pair[:, 0], np.round(turns[pair[:, 1]] - wire.turns[pair[:, 0]]) >= 2.0)
    assert np.count_nonzero(farther == 2) > 5
    assert len(set(zip(*at, strict=True))) == len(pair)
    rotations = 2e-4 * np.random.default_rng(3).normal(size=x.shape)
    slipped, _ = dense(friction, x, seats, rotations)
    friction.memory.state.commit()
    again, _ = dense(friction, x, seats, np.zeros_like(x))
    np.testing.assert_allclose(again, slipped, rtol=0, atol=1e-12 * np.abs(slipped).max())


def test_coils_rub_without_force_and_moment_on_the_whole(rubbing):
    """Inner forces: sums of forces, and of their moments with those on the sections, vanish but for rounding."""
    friction, x, seats, rotations = rubbing("coils")
    f = dense(friction, x, seats, rotations)[0]
    force, moment = f[: x.size].reshape(-1, 3), f[x.size + 12 :].reshape(-1, 3)
    size = np.abs(force).max()
    assert size > 0.1
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-11 * size)
    np.testing.assert_allclose((np.cross(x, force) + moment).sum(axis=0), 0.0, atol=1e-9 * size)


# ---- a straight rod of 100 mm on the seat, pressed with 10 N at each of its 11 nodes --------------------------------

LOAD, NODES, RADIUS = 10.0, 11, 2.0


def block(held, mu=MU):
    """Frame of a rod along x that lies on the bottom seat, pressed down; components of all nodes in `held` are held."""
    nodes = np.stack([np.linspace(0.0, 100.0, NODES), np.zeros(NODES), np.full(NODES, RADIUS)], axis=1)
    points = wire_points(nodes, RADIUS)
    seat = Seat("bottom", points, points.radius, nodes, np.zeros(12), 1e3, 1e-3)
    friction = SeatFriction(seat, mu, nodes, np.zeros(12))
    frame = Frame(
        nodes,
        [(k, k + 1) for k in range(NODES - 1)],
        RADIUS,
        library.load("elastic"),
        polar(2, 6),
        [(node, held) for node in range(NODES)],
        contacts=[seat, friction],
    )
    frame.press = {frame.dof(node, 2): -LOAD for node in range(NODES)}
    drawn = [frame.dof(node, component) for node in range(NODES) for component in (0, 1, 3)]
    assert frame.step(moves=dict.fromkeys(drawn, 0.0), forces=frame.press).converged
    return frame


def pull(frame, component, total):
    """One step with a force shared out over all nodes."""
    loads = {frame.dof(node, component): total / NODES for node in range(NODES)}
    return frame.step(forces=frame.press | loads)


@pytest.mark.parametrize("component", [0, 1], ids=["along", "across"])
def test_a_block_on_a_slope_sticks_below_mu_and_slides_beyond(component):
    """Held against rolling. Under half of μ N it moves by the tractions' elasticity only, T/Σc, but for bending between
    the nodes and the stiffer tip, which take some per cent; under 1.1 μ N there is no equilibrium."""
    frame = block((3, 4, 5, 1 - component))
    weight = LOAD * NODES
    assert pull(frame, component, 0.5 * MU * weight).converged
    moved = frame.moved(NODES // 2)[component]
    c = frame.system.contacts[0].stiffness.sum()
    assert moved == pytest.approx(0.5 * MU * weight / c, rel=0.1)
    assert not pull(frame, component, 1.1 * MU * weight).converged


@pytest.mark.parametrize("component", [0, 1], ids=["along", "across"])
def test_a_dragged_block_pulls_back_with_mu_n_and_keeps_it(component):
    """μ N = 0.3 · 110 N, there and back; the work of the way back is lost too."""
    frame = block((3, 4, 5, 1 - component))
    drawn = [frame.dof(node, component) for node in range(NODES)]
    for step, expected in ((0.5, 1.0), (0.5, 1.0), (-0.5, -1.0)):
        assert frame.step(moves=dict.fromkeys(drawn, step), forces=frame.press).converged
        force = sum(frame.force(dof) for dof in drawn)
        assert force == pytest.approx(expected * MU * LOAD * NODES, rel=1e-6)


def test_a_rod_that_may_turn_rolls_instead_of_sliding():
    """Drawn across by s it turns by s/r about its axis, to second order in a step of 0.02 rad, and needs no force."""
    frame = block((0, 4, 5))
    drawn, way = [frame.dof(node, 1) for node in range(NODES)], 0.04
    before = frame.layout.gather(frame.system.state["R"].trial).copy()
    assert frame.step(moves=dict.fromkeys(drawn, way), forces=frame.press).converged
    turn = frame.layout.gather(frame.system.state["R"].trial) @ np.swapaxes(before, 1, 2)
    angle = 0.5 * (turn[:, 2, 1] - turn[:, 1, 2])
    np.testing.assert_allclose(angle, -way / RADIUS, rtol=1e-3)  # to +y the underside stays behind
    assert abs(sum(frame.force(dof) for dof in drawn)) < 1e-6 * MU * LOAD * NODES


# ---- springs ---------------------------------------------------------------------------------------------------------


STEPS = 8  # of a phase; the error of the increments falls with their square


def analyse(friction, comm=MPI.COMM_SELF, number=STEPS):
    """A closed and ground elastic spring, pressed by 8 mm and released, with end coils in a groove."""
    loading = [{"to": {"travel": travel}, "steps": number} for travel in (8.0, 0.0)]
    data = {
        "spring": SPRING,
        "material": "elastic",
        "contact": {"friction": friction},
        "loading": loading,
        "accuracy": "none",
        "mesh": {"elements_per_turn": 10, "section": {"radial": 2, "angular": 8}},
        "seats": {"hold": "groove"},
    }
    return Analysis(check(data), comm)


def loss(steps):
    """Work that a cycle takes, N mm."""
    travel, force = ([0.0, *(getattr(step, name) for step in steps)] for name in ("travel_mm", "force_N"))
    return np.trapezoid(force, travel)


def test_a_cycle_loses_energy_with_friction_and_none_without():
    """Without friction the spring is elastic: what is lost is the error of its increments, 1e-5 of the energy."""
    lost, stored = {}, None
    for name, friction in (("none", {}), ("seats", {"seats": 0.2}), ("coils", {"coils": 0.2})):
        steps = analyse(friction).run().steps
        lost[name] = loss(steps)
        stored = loss(steps[:STEPS])
    assert abs(lost["none"]) < 1e-5 * stored
    assert lost["seats"] > 10 * abs(lost["none"])
    assert lost["coils"] > 10 * abs(lost["none"])


def test_friction_is_in_balance_and_part_of_the_state(tmp_path):
    """Every cut through the wire is in balance to 1e-8 of force and force times diameter; resumed runs agree."""
    friction = {"seats": 0.2, "coils": 0.2}
    whole, lacks = analyse(friction, number=4), []
    whole.run(lambda step: lacks.append(whole.imbalance()))
    greatest = max(step.force_N for step in whole.result.steps)
    force, moment = np.max(lacks, axis=0)
    assert force < 1e-8 * greatest
    assert moment < 1e-8 * greatest * SPRING["mean_diameter"]

    class Stop(Exception):
        pass

    def stop(step):
        if step.number == 6:
            raise Stop

    first = analyse(friction, number=4)
    with pytest.raises(Stop):
        first.run(stop, Checkpoint(tmp_path, first.case).save)
    second = analyse(friction, number=4)
    second.resume(Checkpoint(tmp_path, second.case).load(second.comm))
    second.run()
    assert [step.force_N for step in second.result.steps] == [step.force_N for step in whole.result.steps]


@pytest.mark.mpi
def test_ranks_rub_the_same():
    """Forces on any number of ranks are those of one, to 1e-10."""
    friction = {"seats": 0.2, "coils": 0.2}
    alone, together = (analyse(friction, comm, 4).run().steps for comm in (MPI.COMM_SELF, MPI.COMM_WORLD))
    greatest = max(step.force_N for step in alone)
    np.testing.assert_allclose(
        [step.force_N for step in together], [step.force_N for step in alone], rtol=0, atol=1e-10 * greatest
    )


@pytest.mark.parametrize(
    ("entry", "more", "words"),
    [
        ({"friction": {"coils": 0.1}, "coils": "gaps"}, {}, "gap elements have no friction"),
        ({"friction": {"seats": 0.1}}, {"ends": "clamped"}, "no seats between clamped ends"),
        ({"friction": {"seats": -0.1}}, {}, "greater than or equal to 0"),
    ],
)
def test_friction_that_makes_no_sense_is_refused(entry, more, words):
    data = {"spring": SPRING, "contact": entry, "loading": [{"to": {"travel": 1.0}}]}
    with pytest.raises(InputError, match=words):
        check(data | more)
