"""A double cone whose coils pass their neighbours is pressed onto its stack: there the force rises as a wall."""

from mpi4py import MPI

from coilset.model.compose import load_history
from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import check

WIRE, TURNS, SLOPE = 2.0, 5.0, 1.1  # mm; turns; wires by which the radius changes a turn


def test_force_rises_as_a_wall_where_flanks_rest_on_each_other(monkeypatch):
    """Two wires high: the rate below is at least thirty times that above; no radius gives way, as their ends stack."""
    shape = {"shape": "double cone", "ends": 30.0 - WIRE * SLOPE * TURNS, "middle": 30.0}
    above, wall, below = 0.15 * WIRE, 0.05 * WIRE, 0.01 * WIRE
    block = 2.0 * WIRE
    data = {
        "spring": {"wire_diameter": WIRE, "mean_diameter": shape, "turns": TURNS, "pitch": 5.0},
        "material": "elastic",
        "accuracy": "none",
        "mesh": {"section": {"kind": "plane", "radial": 2, "angular": 8}},
        "loading": [
            {"to": {"height": block + above}, "steps": 8},
            {"to": {"height": block + wall}, "steps": 1},
            {"to": "block", "steps": 2},
            {"to": {"height": block - below}, "steps": 2},
        ],
    }
    case = check(data)
    assert case.spring.build().block_height == block
    monkeypatch.setattr(load_history, "check_targets", lambda *_: None)  # it refuses the last one
    result = Analysis(case, MPI.COMM_SELF).run()
    forces = {step.phase: step.force_N for step in result.steps}
    before = (forces[1] - forces[0]) / (above - wall)
    assert (forces[3] - forces[2]) / below > 30.0 * before
