"""Every shipped spring is pressed to block and released, and stands against what can be worked out by hand.

In twelve equal steps down and six back and with few section points: what is asked for here are per cents.
"""

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import read_case
from coilset.verification.spring_references.coil_by_coil import CoilByCoil
from coilset.verification.spring_references.curved_rod import clamped_rate

SETTINGS = [
    "accuracy=none",
    "loading.0.steps=12",
    "loading.1.steps=6",
    "mesh.elements_per_turn=12",
    "mesh.section.radial=4",
    "mesh.section.angular=12",
]
BALANCE = 1e-7  # of the maximum force, and of it times the maximum diameter; (6.3.1) is solved to 1e-9
# The formula leaves out bending, direct shear, and what seats do to the end coils. Found are 4 % of force, 8 % in the
# first step of the closed and ground spring, whose end coils still lie down; 11 % of what springs back in the funnel,
# whose coils slip past each other.
FORCE, FIRST, BACK = 0.05, 0.1, 0.13
# Coils by hand close by the slope of their radius, the block length by the next coil's: they differ by 0.8 and 2.2 % of
# the travel where the slope jumps in the middle of the spring. The wires of wide barrels and hourglasses stack higher
# than their coils on average: 0.87, 0.69 and 0.82 mm, 1.3 to 1.5 % of the travel.
FOLDED = {"double_cone": 0.012, "funnel": 0.03, "barrel": 0.015, "hourglass": 0.02, "measured": 0.015}
# Part of the way to block over which forces are judged: later the last coils lie down, one against the other. In the
# tapered wire the thin coils do so early, and force rises at once.
EARLY, TAPERED = 0.8, 0.5

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
# tests/spring/test_torsion.py, test_extension.py, test_any_wire.py: the formulas here are of compressed round wire
NOT_PRESSED = {"side_load", "torsion", "extension", "ovate_valve", "die_spring"}
SPRINGS = [file for file in sorted((EXAMPLES / "springs").glob("*.yaml")) if file.stem not in NOT_PRESSED]
SHIPPED = [EXAMPLES / "ck15_presetting.yaml", *SPRINGS]


def test_there_are_eleven():
    assert len(SHIPPED) == 11


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_pressed_to_block_and_released(file):
    """To the end, in balance, with the forces and the set of coils that twist one by one."""
    analysis, lacks = Analysis(read_case(file, SETTINGS), MPI.COMM_SELF), []
    result = analysis.run(lambda step: lacks.append(analysis.imbalance()))
    spring, summary = analysis.spring, summarise(analysis.setup, result)
    pressed = [step for step in result.steps if step.phase == 0]
    travel, force = (np.array([getattr(step, name) for step in pressed]) for name in ("travel_mm", "force_N"))

    assert summary["complete"]
    assert result.snapshots[1].height == pytest.approx(spring.block_height, abs=1e-9)
    assert abs(result.snapshots[2].force) < 1e-6 * force.max()
    lack_of_force, lack_of_moment = np.max(lacks, axis=0)
    assert lack_of_force < BALANCE * force.max()
    assert lack_of_moment < BALANCE * force.max() * 2 * spring.mean_radius(analysis.setup.turns).max()

    if file.stem == "closed_and_ground":  # EN 13906-1 counts two dead turns of 7.5; found are 5.57
        assert result.seats[0].active_turns == pytest.approx(5.5, rel=0.015)
    else:  # Castigliano's integral of the straight wire's rod, which the true, curved section exceeds by 1 %
        assert result.rate == pytest.approx(clamped_rate(spring, analysis.law.E, analysis.law.G), rel=0.015)

    by_hand, way = CoilByCoil(spring, analysis.law), spring.free_length - spring.block_height
    early = travel < way * (TAPERED if np.ptp(analysis.setup.wire_radius) > 0.1 else EARLY)
    off = (force / by_hand.force(travel) - 1)[early]
    assert abs(off[0]) < FIRST
    assert np.abs(off[1:]).max() < FORCE
    assert len(off) >= 5
    assert by_hand.block_travel() == pytest.approx(way, rel=FOLDED.get(file.stem, 1e-3))
    back = by_hand.block_travel() - summary["set_mm"]
    assert back == pytest.approx(by_hand.spring_back(), rel=BACK)
