"""Motion in time against closed solutions: a clamped rod, its energy, the first surge frequency, a driven spring."""

import csv
import json

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import check
from coilset.model.physics.vibration.driven import driven, surge
from coilset.model.physics.vibration.lift import read_lift, valve_lift
from coilset.model.physics.vibration.mass import TONNE
from coilset.model.physics.vibration.modes import natural_modes
from coilset.model.physics.vibration.surge import Motion
from coilset.model.tools.standards.en13906 import natural_frequency
from coilset.model.tools.studies.surge_output import draw_surge, write_surge
from coilset.verification.chain import ALL, ROTATION_X, X, chain, elastic, straight

E, NU, DENSITY = 206e3, 0.3, 7.85e-6
SPEED = 1e3  # mm/s, of the middle at the beginning


def ringing_rod(elements, steps, spectral_radius):
    """Error of the middle's motion over a period of the first axial half wave, over its amplitude; and the Motion."""
    length = 200.0
    frame = chain(straight(length, elements), 2.5, elastic(E, NU), held=[(0, ALL), (elements, ALL)])
    ω = np.pi / length * np.sqrt(E / (DENSITY * TONNE))
    velocities = np.zeros(frame.layout.size_local)
    for k in range(elements + 1):
        velocities[frame.dof(k, X)] = SPEED * np.sin(np.pi * k / elements)
    motion = Motion(frame.system, frame.continuation.newton, DENSITY, velocities, spectral_radius)
    times, found = 2.0 * np.pi / ω * np.arange(1, steps + 1) / steps, []
    for time in times:
        motion.go(lambda _: frame.load, time)
        found.append(frame.moved(elements // 2)[0])
    return np.array(found) - SPEED / ω * np.sin(ω * times), SPEED / ω, motion


def test_axial_vibration_of_a_clamped_rod():
    """Second order in the step: after a period the phase is behind by 2π (ωΔt)²/12 for the trapezoidal rule, ρ = 1.

    The mesh puts it ahead by 2π (π/n)²/24.
    """
    n = 40
    for steps in (20, 40):
        error, amplitude, motion = ringing_rod(n, steps, 1.0)
        late = 2.0 * np.pi * ((2.0 * np.pi / steps) ** 2 / 12.0 - (np.pi / n) ** 2 / 24.0)
        assert error[-1] / amplitude == pytest.approx(-late, rel=0.06)
        assert motion.energies.kinetic == pytest.approx(motion.energies.supplied, rel=4e-3)
        assert abs(motion.energies.lost) < 1e-9 * motion.energies.supplied


@pytest.mark.parametrize("kind", ["bending", "torsion"])
def test_a_clamped_rod_left_in_a_mode_returns_to_it(kind):
    """After a period of its frequency by `modes`, the phase is behind by 2π (ωΔt)²/12, and what moves is the mode."""
    n, steps = 20, 20
    frame = chain(straight(200.0, n), 2.5, elastic(E, NU), held=[(0, ALL), (n, ALL)])
    modes = natural_modes(frame.system, frame.load, DENSITY, 16)
    middle = np.abs(modes.shapes[:, n // 2])
    number = 0 if kind == "bending" else int((middle[:, ROTATION_X] / middle.max(axis=1) > 0.99).argmax())
    shape, ω = 1e-3 * modes.shapes[number] / middle[number].max(), 2.0 * np.pi * modes.frequencies[number]
    velocities = np.zeros(frame.layout.size_local)
    for k in range(1, n):
        for freedom in ALL:
            velocities[frame.dof(k, freedom)] = ω * shape[k, freedom]
    motion = Motion(frame.system, frame.continuation.newton, DENSITY, velocities, 1.0)
    for k in range(1, steps + 1):
        motion.go(lambda _: frame.load, 2.0 * np.pi / ω * k / steps)
    late = 2.0 * np.pi * (2.0 * np.pi / steps) ** 2 / 12.0
    ended = np.array([motion.velocities[frame.dof(n // 2, freedom)] for freedom in ALL]) / ω
    assert ended == pytest.approx(np.cos(late) * shape[n // 2], abs=3e-6)
    moved = np.array([*frame.moved(n // 2), *frame.rotation(n // 2)])
    assert moved == pytest.approx(-np.sin(late) * shape[n // 2], abs=3e-6)


def test_the_algorithm_takes_energy_with_the_spectral_radius():
    lost = {}
    for steps in (20, 40):
        *_, motion = ringing_rod(20, steps, 0.8)
        lost[steps] = motion.energies.lost / motion.energies.supplied
    assert 0.0 < lost[40] < lost[20] < 2e-3
    assert np.log2(lost[20] / lost[40]) == pytest.approx(2.0, abs=0.3)


def spring(turns=10.0, pitch=6.0, material="elastic", loading=({"to": {"travel": 1.0}, "steps": 1},)):
    mesh = {"elements_per_turn": 8, "section": {"kind": "plane", "radial": 2, "angular": 8}}
    entries = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": turns, "pitch": pitch}
    case = {"spring": entries, "material": material, "ends": "clamped", "mesh": mesh, "loading": list(loading)}
    analysis = Analysis(check(case | {"accuracy": "none"}), detailed=False)
    analysis.run()
    return analysis


def fitted_frequency(time, values, about):
    """Frequency of the sine that is nearest to values, within 10 %, Hz."""

    def rest(f):
        sines = np.stack([np.sin(2.0 * np.pi * f * time), np.cos(2.0 * np.pi * f * time), np.ones_like(time)], axis=1)
        return np.linalg.lstsq(sines, values, rcond=None)[1][0]

    return minimize_scalar(rest, bounds=(0.9 * about, 1.1 * about), method="bounded").x


@pytest.mark.mpi
def test_first_surge_frequency_of_the_standard():
    """A push of the head for a period; then both heads' forces differ by the first axial mode, each step too slow."""
    analysis, steps = spring(), 20
    period = 1.0 / natural_frequency(analysis.law.G, DENSITY, 5.0, 40.0, 10.0)
    modes = natural_modes(analysis.system, analysis.control.to_height(analysis.control.height), DENSITY, 4)
    height = analysis.control.height

    def pushed(time):
        return height - 0.2 * np.sin(np.pi * min(time / period, 1.0)) ** 2

    driven = surge(analysis, pushed, 5.0 * period, period / steps, density=DENSITY)
    after = driven.time > 1.5 * period
    found = fitted_frequency(driven.time[after], (driven.top - driven.bottom)[after], 1.0 / period)
    axial = modes.frequencies[modes.masses[:, 2].argmax()]
    assert found == pytest.approx(axial * (1.0 - (2.0 * np.pi / steps) ** 2 / 12.0), rel=2e-3)
    assert found == pytest.approx(1.0 / period, rel=0.025)
    assert driven.height[-1] == pytest.approx(height)
    assert 0.0 < driven.lost[-1] < 0.05 * driven.supplied[-1]


def test_a_slow_head_meets_statics():
    analysis = spring(turns=3.0)
    height, rate = analysis.control.height, analysis.result.rate
    driven = surge(analysis, lambda time: height - 0.5 * (1.0 - np.cos(np.pi * time / 0.05)), 0.05, 0.05 / 16)
    assert driven.top == pytest.approx(driven.bottom, abs=0.02 * rate)
    assert driven.top - driven.top[0] == pytest.approx(rate * (height - driven.height), rel=0.02, abs=0.02 * rate)
    with pytest.raises(InputError, match="step"):
        surge(analysis, lambda time: height, 1.0, 0.0)


def test_a_spring_that_yields_under_a_slow_head_meets_statics():
    """Pressed far beyond yield and back over 0.4 s: the same forces as by the load program, and its lost work."""
    steps, travel = 12, 8.0
    program = (1.0, 1), (1.0 + travel, steps), (1.0, steps)
    phases = [{"to": {"travel": goal}, "steps": count} for goal, count in program]
    static = spring(2.0, 12.0, "ck15", phases)
    still = np.array([step.force_N for step in static.result.steps])[-(2 * steps + 1) :]
    analysis = spring(2.0, 12.0, "ck15", phases[:1])
    top, half = analysis.control.height, 0.2

    def height(time):
        return top - travel * (1.0 - abs(time - half) / half)

    moved = surge(analysis, height, 2.0 * half, half / steps)
    assert moved.bottom == pytest.approx(still, abs=0.01 * still.max())
    work = np.trapezoid(still, -moved.height)
    assert work > 0.3 * still.max() * travel
    assert moved.stored[-1] == pytest.approx(work, rel=0.01)
    assert moved.supplied[-1] == pytest.approx(work, rel=0.01)


def test_a_lift_and_its_files(tmp_path):
    """The same motion by its numbers and from a file, slowly and fast; the table has a row for each step."""
    lift = valve_lift(0.5, 6000.0, 90.0)
    assert (lift.seconds, lift.travel(0.0), lift.travel(0.0025), lift.travel(9.0)) == (0.005, 0.0, 0.5, 0.0)
    time = np.linspace(0.0, lift.seconds, 101)
    rows = "".join(f"{t},{lift.travel(t)}\n" for t in time)
    (tmp_path / "lift.csv").write_text("time_s,travel_mm\n" + rows)
    read = read_lift(tmp_path / "lift.csv")
    assert [read.travel(t) for t in time + 2e-5] == pytest.approx([lift.travel(t) for t in time + 2e-5], abs=1e-5)
    (tmp_path / "wrong.csv").write_text("time_s,travel_mm\n0,0\n0,1\n")
    with pytest.raises(InputError, match=r"wrong.csv: time_s and travel_mm: needs two rows or more"):
        read_lift(tmp_path / "wrong.csv")
    with pytest.raises(InputError, match="--speed: -1 is not possible"):
        valve_lift(0.5, -1.0, 90.0)
    with pytest.raises(InputError, match="--opening: 720 is not possible; give a positive number up to 360"):
        valve_lift(0.5, 1.0, 720.0)
    for rows, problem in (("0.002,1e308\n0.004,0", "row 2: no head moves"), ("0.1,0", "the head never moves")):
        (tmp_path / "wrong.csv").write_text(f"time_s,travel_mm\n0,0\n{rows}\n")
        with pytest.raises(InputError, match=problem):
            read_lift(tmp_path / "wrong.csv")

    with pytest.raises(InputError, match=r"--step: 0.001 s, but the lift is over in 0.005 s; give 0.000625 s or less"):
        driven(lambda: spring(turns=3.0), read, step=1e-3)  # in one step nothing was supplied, and that was divided by
    rest = spring(turns=3.0).control.height
    found = driven(lambda: spring(turns=3.0), read, step=1e-4, seconds=0.0051)
    assert len(found.fine.time) == 53  # pairs of steps
    assert len(found.slow.time) == len(found.coarse.time) == 27
    assert found.slow.top == pytest.approx(found.slow.bottom, abs=1e-3 * found.slow.top.max())
    assert found.slow.kinetic.max() < 1e-4 * found.fine.kinetic.max()
    finer = surge(spring(turns=3.0), lambda t: rest - read.travel(t), 5.2e-3, 5e-5)
    assert 0.4 * found.error < np.abs(found.fine.top - finer.top[::2]).max() < found.error
    turns = np.linspace(0.0, 3.0, found.fine.level.shape[1])
    write_surge(tmp_path / "surge", found, turns)
    table = list(csv.DictReader((tmp_path / "surge/surge.csv").read_text().splitlines()))
    assert [float(row["top_N"]) for row in table] == found.fine.top.tolist()
    assert float(table[5]["turn_2_mm"]) == found.fine.level[5, 16]
    numbers = json.loads((tmp_path / "surge/summary.json").read_text())
    assert numbers["fixed_force_max_N"] == found.fine.bottom.max()
    draw_surge(tmp_path / "surge.png", found, turns, "A lift", "test")
