"""Where the force goes: wrenches by hand, balance at every cut of solved springs, active turns against the standard."""

import csv

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.dataset import pressure_along_wire
from coilset.model.core.case import check, read_case
from coilset.model.core.results.files.folder import write_seats
from coilset.model.core.results.records.record import SeatReactions
from coilset.model.physics.reactions.resultants import Wrench

COARSE = [
    "mesh.section.rule=abramowitz9",
    "mesh.elements_per_turn=10",
    "loading.0.steps=6",
    "loading.1.steps=4",
    "accuracy=none",
]
CLOSED = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 7.5,
    "free_length": 75.0,
    "end_coils": {"form": "closed and ground"},
}


@pytest.fixture(scope="module")
def example_runs(example):
    """Some of the shipped examples, coarsely stepped, with the imbalance after each step."""
    found = {}
    springs = example.parent / "springs"
    for file in (example, springs / "closed_and_ground.yaml", springs / "variable_wire.yaml"):
        analysis, lacks = Analysis(read_case(file, COARSE), MPI.COMM_SELF), []
        analysis.run(lambda step, analysis=analysis, lacks=lacks: lacks.append(analysis.imbalance()))
        found[file.stem] = analysis, np.array(lacks)
    return found


def test_a_resultant_crosses_where_its_moments_vanish():
    """Three forces by hand: 1, 2, 3 N up at x = 0, 3, 6 and y = 6, 0, 3 have their centre at (4, 2.5)."""
    x, up = np.array([[0.0, 6, 1], [3, 0, 1], [6, 3, 1]]), np.outer([1.0, 2, 3], [0, 0, 1])
    wrench = Wrench.of(up, x)
    np.testing.assert_allclose(wrench.force, [0, 0, 6])
    np.testing.assert_allclose(wrench.about(np.array([0.0, 0, 7])).crossing(), [4, 2.5], rtol=1e-14)
    np.testing.assert_allclose(wrench.about(np.array([1.0, 1, 7])).crossing(), [3, 1.5], rtol=1e-14)
    # a force that leans by 1 in 3 towards x crosses a plane 6 mm higher 2 mm farther on
    leaning = wrench + Wrench.of(np.array([[2.0, 0, 0]]), np.array([[4, 2.5, 1.0]]))
    np.testing.assert_allclose(leaning.about(np.array([0.0, 0, 7])).crossing(), [6, 2.5], rtol=1e-14)
    # a moment about z moves nothing, one about x by Mx/Fz along y
    turned = wrench + Wrench.of(np.zeros((1, 3)), np.zeros((1, 3)), np.array([[6.0, 0, 5]]))
    np.testing.assert_allclose(turned.about(np.zeros(3)).crossing(), [4, 3.5], rtol=1e-14)


def test_seats_contacts_and_sections_are_in_balance_in_every_step(example_runs):
    """1e-8 of the maximum force (times the mean diameter) at every cut; (6.3.1) with ε = 1e-9 leaves less."""
    for name, (analysis, lacks) in example_runs.items():
        force = max(step.force_N for step in analysis.result.steps)
        diameter = 2.0 * float(analysis.spring.mean_radius(0.5 * analysis.spring.turns))
        assert len(lacks) >= 10
        assert lacks[:, 0].max() < 1e-8 * force, name
        assert lacks[:, 1].max() < 1e-8 * force * diameter, name


def test_what_one_seat_does_the_other_undoes(example_runs):
    for name, (analysis, _) in example_runs.items():
        for step, one in zip(analysis.result.steps, analysis.result.seats, strict=True):
            scale = max(abs(step.force_N), 1.0)
            assert one.bottom.force_N == pytest.approx(one.top.force_N, abs=1e-7 * scale), name
            assert one.bottom.force_N == pytest.approx(step.force_N, abs=1e-7 * scale), name
            assert one.bottom.lateral_x_N == pytest.approx(-one.top.lateral_x_N, abs=1e-6 * scale), name
            assert one.bottom.moment_z_Nmm == pytest.approx(-one.top.moment_z_Nmm, abs=1e-4 * scale), name


def test_pressure_adds_up_to_the_force(example_runs, tmp_path):
    """On level seats the pressure, times the length each point bears with, is the axial force while the tip bears; a
    thin tip lifts off soon, and its soft spring then pulls with some 1e-6 of it."""
    analysis, _ = example_runs["closed_and_ground"]
    data = pressure_along_wire(analysis.setup, analysis.result)
    seat = analysis.system.contacts[1]
    turns, on_seat = data["wire_turn"].values, data["pressure"].values[:, 1]
    assert data["contact"].values.tolist() == ["coils", "bottom seat", "top seat"]
    place = np.searchsorted(seat.points.turns, turns)
    lengths = seat.lengths[place]
    for k in range(6):
        tip_bears = on_seat[k, turns == 0.0].any()
        expected = analysis.result.seats[k].bottom.force_N
        assert float(on_seat[k] @ lengths) == pytest.approx(expected, rel=1e-9 if tip_bears else 5e-6)
    assert turns[on_seat[2] > 0].max() < 1.1  # the end coil of one turn
    write_seats(tmp_path, analysis.result.seats)
    rows = list(csv.DictReader((tmp_path / "seats.csv").read_text().splitlines()))
    assert len(rows) == len(analysis.result.steps)
    assert float(rows[3]["top_eccentricity_mm"]) == analysis.result.seats[3].top.eccentricity_mm
    again = SeatReactions.from_row(analysis.result.seats[3].row(), analysis.result.seats[3].pressure)
    assert again.row() == analysis.result.seats[3].row()


def test_active_turns_are_those_of_the_standard():
    """EN 13906-1 counts two dead end turns: 5.5 of 7.5 turns are active; the transition to the dead coil and bending
    make 1 % of it. The ground ends taper: they lie on their seats near the tip and near the end of the flat, and their
    middle is as free as the coils, to a few contact points; round ends would leave 6 turns free. At block no turn is
    free, and the coils have taken over most of the load."""
    loading = [{"to": {"force": 20}, "steps": 1}]
    few = Analysis(check({"spring": CLOSED, "material": "elastic", "loading": loading}), MPI.COMM_SELF).run()
    assert few.seats[0].active_turns == pytest.approx(5.5, rel=0.02)
    assert few.seats[0].free_turns == pytest.approx(6.5, abs=0.25)


def test_active_turns_make_the_rate():
    """A long slender spring between clamped heads: R = G d⁴/(64 r³ n) within 1 %; a flat spring's torque is F r."""
    spring = {"wire_diameter": 3.0, "mean_diameter": 36.0, "turns": 12.0, "pitch": 4.5}
    analysis = Analysis(
        check(
            {"spring": spring, "material": "elastic", "ends": "clamped", "loading": [{"to": {"travel": 2}, "steps": 1}]}
        ),
        MPI.COMM_SELF,
    )
    result = analysis.run()
    n = result.seats[0].active_turns
    assert result.rate == pytest.approx(analysis.law.G * 3.0**4 / (64 * 18.0**3 * n), rel=0.01)
    assert n == pytest.approx(12.0, rel=0.01)
    assert result.seats[0].free_turns == pytest.approx(12.0, abs=1e-12)


SOFT = {"wire_diameter": 3.0, "mean_diameter": 24.0, "turns": 3.5, "pitch": 7.0}


@pytest.mark.parametrize(("spring", "ends", "heights"), [(SOFT, "clamped", (20, 18)), (CLOSED, "seats", (40, 30))])
def test_active_turns_are_the_integral_over_the_state(spring, ends, heights):
    """∫ (Mt/(F r))² dt of the recorded resultants, the same down and up; of changes on release it was 10 % less."""
    loading = [{"to": {"height": height}, "steps": 3} for height in (*heights, heights[0])]
    analysis = Analysis(
        check({"spring": spring, "material": "elastic", "ends": ends, "loading": loading}), MPI.COMM_SELF
    )
    result = analysis.run()
    down, _, up = (result.seats[k].active_turns for k in (2, 5, 8))
    assert up == pytest.approx(down, rel=1e-6)
    for shot, reactions in zip(result.snapshots[1:], result.seats[2::3], strict=True):
        middle = 0.5 * (shot.x[1:] + shot.x[:-1])
        torque = shot.resultants[:, :, 3].mean(axis=1)
        shares = (torque / (shot.force * np.hypot(middle[:, 0], middle[:, 1]))) ** 2
        assert reactions.active_turns == pytest.approx(float(shares @ np.diff(analysis.setup.turns)), rel=1e-6)


@pytest.mark.mpi
def test_ranks_see_the_same_resultants(example):
    seats = "{hold: groove, top: {tilt: free, sideways: 50.0}, bottom: {turn: free}}"
    settings = [*COARSE, "loading.1.steps=2", f"seats={seats}", "material=elastic", "loading.0.to={travel: 12}"]
    case = read_case(example.parent / "springs" / "closed_and_ground.yaml", settings)
    together, alone = (Analysis(case, comm).run() for comm in (MPI.COMM_WORLD, MPI.COMM_SELF))
    for ours, reference in zip(together.seats, alone.seats, strict=True):
        for name, value in reference.row().items():
            assert ours.row()[name] == pytest.approx(value, rel=1e-7, abs=1e-5, nan_ok=True), name
        np.testing.assert_array_equal(ours.pressure[:, :2], reference.pressure[:, :2])
