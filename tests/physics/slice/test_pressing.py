"""Pressing and releasing: closed solutions, the ways to drive a slice against each other, and contact."""

import itertools

import numpy as np
import pytest

from coilset.meshes.sections.shapes import Trapezoid
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.physics.slice.contact import SelfContact
from coilset.model.physics.slice.problem import SliceProblem
from coilset.model.physics.slice.watch import Watch
from coilset.model.physics.solid.continuum import mises
from coilset.verification.one_section.recorded_solids import RECORDED
from coilset.verification.one_section.slice_references import ring_sector


def press(problem, travel, steps=6):
    """Press a turn in equal steps, mm."""
    rise = problem.body.coil.rise
    for part in np.arange(1, steps + 1) / steps:
        problem.go_to_rise(rise - part * travel / (2 * np.pi))


def travel(body):
    return 2 * np.pi * (body.coil.rise - body.rise)


def test_elastic_rate_and_factor_inside(make_slice):
    # measured on this mesh: rate −0.018 %, inside −0.15 %
    body = make_slice("elastic", index=4.0, pitch=0.0, across=5.0)
    watch = Watch(body, [[-2.5, 0.0]])
    force, stress = SliceProblem(body).probe(-1e-6, watch)
    rate, inside, _ = ring_sector(4.0)
    assert force / (2 * np.pi * 1e-6) == pytest.approx(rate * body.law.G * 5**4 / (8 * 20**3), rel=3e-4)
    assert abs(stress[0, 4]) * np.pi * 5**3 / (8 * force * 20) == pytest.approx(inside, rel=3e-3)


def test_pressed_turn_is_that_of_the_solid(make_slice):
    # the recorded solid of 33,987 unknowns; here 602: +0.015 % and −0.03 %
    (solid,) = (one for one in RECORDED if (one.material, one.index, one.gap) == ("ck15", 8.0, 1.0))
    force, back, _ = solid.numbers
    body = make_slice(across=6.5)
    problem = SliceProblem(body)
    press(problem, 6.3, 12)
    assert problem.force == pytest.approx(force, rel=5e-4)
    assert problem.go_to_force(0.0).cuts == 0
    assert travel(body) == pytest.approx(back, rel=5e-4)
    assert abs(problem.force) < 1e-6


def test_force_and_travel_drive_alike(make_slice):
    body, other = make_slice(), make_slice()
    by_travel, by_force = SliceProblem(body), SliceProblem(other)
    for part in (0.4, 0.8, 1.6):  # elastic, then plastic
        by_travel.go_to_rise(body.coil.rise - part / (2 * np.pi))
        by_force.go_to_force(by_travel.force)
        assert other.rise == pytest.approx(body.rise, rel=1e-9)
        assert by_force.torque == pytest.approx(by_travel.torque, rel=1e-7)


def test_free_ends_bear_no_torque_and_turn(make_slice):
    held, free = (SliceProblem(make_slice(), free_ends=free) for free in (False, True))
    for problem in (held, free):
        press(problem, 4.0)
    assert held.body.turn == 1.0
    assert held.torque > 100.0
    assert abs(free.torque) < 1e-5 * held.torque
    assert free.body.turn < 1.0
    assert free.force < held.force


def test_torque_is_the_work_of_the_turn(make_slice):
    # elastic: work put in by h̄ and λ over a loop is the energy that comes back: ∮ N dh̄ + M dλ = 0
    body = make_slice("elastic")
    problem, work, last = SliceProblem(body), 0.0, np.zeros(2)
    corners = [(0.0, 0.0), (-0.5, 0.0), (-0.5, 0.01), (0.0, 0.01), (0.0, 0.0)]
    size = 0.0
    for begin, end in itertools.pairwise(corners):
        for part in np.arange(1, 9) / 8:
            h, λ = np.array(begin) + part * (np.array(end) - begin)
            before = body.rise, body.turn
            problem.go_to_rise(body.coil.rise + h, 1.0 + λ)
            now = body.resultants()
            done = 0.5 * (now + last) @ [body.rise - before[0], body.turn - before[1]]
            work, size, last = work + done, size + abs(done), now
    assert abs(work) < 1e-3 * size


def test_coils_touch_and_part_again(make_slice):
    body = make_slice(across=5.0)
    problem = SliceProblem(body, contact=SelfContact(body))
    press(problem, 6.0)
    free = problem.force
    assert not problem.pressure.bearing
    # the section is 5 mm high along the axis over the cosine of its inclination: 5.004 mm at block
    problem.go_to_rise(5.03 / (2 * np.pi))
    assert problem.pressure.gap == pytest.approx(5.03 - 5.004, abs=6e-3)
    problem.go_to_force(600.0)
    assert problem.pressure.bearing > 0
    assert 0 < -problem.pressure.gap < 1e-3 * 5
    assert problem.pressure.force == pytest.approx(600.0 - free, rel=0.02)  # per turn, nearly along the axis
    problem.go_to_force(0.0)
    assert not problem.pressure.bearing
    assert problem.pressure.gap > 0


@pytest.mark.parametrize("outline", [Trapezoid(4.0, 5.0, 6.0), Trapezoid(4.0, 6.0, 5.0)])
@pytest.mark.parametrize("off", [1e-4, -1e-4])
def test_coils_touch_where_their_corners_do(make_slice, outline, off):
    """The Gauss points are 0.02 mm from it; what a section measures along the axis is in its nodes."""
    body = make_slice("elastic", outline=outline, pitch=5.5)
    along = body.start[:, 2] - body.coil.rise * np.arctan2(body.start[:, 1], body.start[:, 0])
    contact, height = SelfContact(body), np.ptp(along)
    body.extra.trial[0] = (1.0 + off) * height / (2 * np.pi)
    assert body.update()
    moved = body.x[:, 2] - body.rise * np.arctan2(body.x[:, 1], body.x[:, 0])
    left = 2 * np.pi * body.rise - np.ptp(moved)
    found = contact.evaluate()
    assert found.gap == pytest.approx(left, rel=0.02)  # normal to the side, which is inclined by 7°
    assert found.free > 0.01
    assert found.bearing == 0


def test_a_round_wire_has_no_corners(make_slice):
    found = SelfContact(make_slice(across=3.0)).evaluate()
    assert found.gap == found.free


def test_surface_is_free_of_traction_and_keeps_the_yield_condition(make_slice):
    # measured: 0.18 MPa of about 120; the law itself is integrated at the surface
    body, φ = make_slice(across=6.5), np.linspace(0, 2 * np.pi, 36, endpoint=False)
    normal = np.stack([np.cos(φ), np.sin(φ)], axis=1)
    watch = Watch(body, 2.5 * normal)
    problem = SliceProblem(body)
    press(problem, 6.3, 12)
    stress = watch.section_stress()
    traction = np.stack(
        [
            stress[:, 3] * normal[:, 0] + stress[:, 4] * normal[:, 1],
            stress[:, 1] * normal[:, 0] + stress[:, 5] * normal[:, 1],
            stress[:, 5] * normal[:, 0] + stress[:, 2] * normal[:, 1],
        ]
    )
    assert np.abs(traction).max() < 0.4
    active = watch.state[:, :6] - watch.state[:, 6:12]
    yield_stress = np.sqrt(1.5 * body.law.functions(watch.state[:, 12])[0])
    assert np.allclose(mises(active), yield_stress, rtol=1e-9)


def test_any_section_balances(make_slice):
    # N from the work of h̄ is the axial component of the stress over the section
    body = make_slice(outline=Trapezoid(4.0, 5.0, 6.0, 0.4), across=4.0, pitch=10.0)
    problem = SliceProblem(body)
    press(problem, 2.0)
    F = body.forms.evaluate_tangents()
    σ = body.rows[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3)
    area = np.cross(F[:, :, 0], F[:, :, 1]) * body.areas[:, None]  # of the section in space, by Nanson
    force = np.einsum("pij,pj->i", σ, area) * np.sign(area[:, 1].mean())
    assert -force[2] == pytest.approx(problem.force, rel=1e-3)


def test_no_equilibrium_is_said_and_the_last_one_kept(make_slice):
    body = make_slice("ideal_plastic", across=2.0)
    problem = SliceProblem(body)
    press(problem, 3.0)
    force, rise = problem.force, body.rise
    with pytest.raises(SolveError, match="no equilibrium beyond"):
        problem.go_to_force(100 * force)
    assert problem.force >= force
    assert 2 * np.pi * body.rise <= 2 * np.pi * rise + 1e-9
    assert np.isfinite(body.x).all()


def test_an_output_point_without_stress_leaves_the_last_equilibrium(make_slice, monkeypatch):
    body = make_slice()
    first = Watch(body, [[-2.5, 0.0]])
    problem = SliceProblem(body)
    press(problem, 3.0, 2)
    before = problem.force, problem.torque, body.rise, body.x.copy(), body.rows.copy(), first.state.copy()

    def fails():
        raise SolveError("the law finds no stress")

    monkeypatch.setattr(body, "followers", [first.evaluate, fails])
    with pytest.raises(SolveError, match="the law finds no stress"):
        problem.go_to_rise(body.coil.rise - 4.0 / (2 * np.pi))
    after = problem.force, problem.torque, body.rise, body.x, body.rows, first.state
    assert all(np.array_equal(one, other) for one, other in zip(before, after, strict=True))
    monkeypatch.undo()
    problem.go_to_rise(body.coil.rise - 4.0 / (2 * np.pi))
    assert problem.force > before[0]


def test_section_that_reaches_the_axis_is_refused(make_slice):
    with pytest.raises(InputError, match="axis"):
        make_slice(index=0.9)
