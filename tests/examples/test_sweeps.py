"""Every shipped sweep has the cases that its file says, and one of them answers as it must."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import check
from coilset.model.tools.sweep.plan import Plan

SWEEPS = Path(__file__).resolve().parents[2] / "examples" / "sweeps"
CASES = {
    "convergence": 8 + 7 + 7 + 6 - 3,  # one input at a time; the base case is among the values of all four
    "preset_height": 11 * 5 * 3,
    "scatter": 1000,
    "thousand": 1000,
    "tolerances": (4 + 2) * 32,  # Sobol indices: two blocks of samples, and one for each input
    "valve_tolerances": 500,
}


def test_all_sweeps_are_here():
    assert {path.stem for path in SWEEPS.glob("*.yaml")} == set(CASES)


@pytest.mark.parametrize("name", CASES)
def test_number_of_cases(name):
    assert len(Plan(SWEEPS / f"{name}.yaml")) == CASES[name]


def test_what_is_pressed_farther_sets_by_nearly_as_much_more():
    """Beyond yield the force hardly grows, and so does the springback.

    From 22 to 20 mm the set grows by 2 mm · (1 − slope/R). The slope of the characteristic is 1.3 N/mm there, R is
    41 N/mm: 0.97 of the 2 mm.
    """
    plan = Plan(SWEEPS / "preset_height.yaml")
    sets = {}
    for row in plan.rows:
        values = dict(zip(plan.names, row, strict=True))
        if (values["spring.wire_diameter"], values["spring.pitch"]) == (5.0, 12) and values[plan.names[0]] in (20, 22):
            analysis = Analysis(check(plan.data(row)), MPI.COMM_SELF, estimates=False)
            sets[values[plan.names[0]]] = summarise(analysis.setup, analysis.run())["set_mm"]
    assert 0.96 < (sets[20] - sets[22]) / 2.0 < 0.98


@pytest.mark.parametrize(("script", "package"), [("optuna_pareto", "optuna"), ("salib_sobol", "SALib")])
def test_other_programs_choose_the_cases(script, package, tmp_path):
    """Each script ends in an assertion of its own."""
    pytest.importorskip(package)
    number = "10" if package == "optuna" else "8"
    command = [sys.executable, str(SWEEPS / f"{script}.py"), str(tmp_path / "out"), number]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=dict(os.environ), cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(done.stdout.splitlines()) >= 2
