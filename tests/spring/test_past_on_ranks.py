"""Heat along the wire, coiling, relief and peening on all ranks at once: the same numbers as on one."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case.case import check
from coilset.verification.cases.time.heat_along_wire import material
from coilset.verification.study import Study

pytestmark = pytest.mark.mpi
COMM = MPI.COMM_WORLD
MESH = {"elements_per_turn": 8, "section": {"radial": 3, "angular": 8}}
SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.5, "pitch": 20.0}


def both(case):
    """The runs on all ranks and on this one alone."""
    runs = [Analysis(check(case), comm) for comm in (COMM, MPI.COMM_SELF)]
    return runs, [run.run() for run in runs]


def close(results):
    """Forces, heights and temperatures of all steps agree to 1e-10."""
    for name in ("force_N", "seat_height_mm", "temperature_K", "hours"):
        values = [np.array([getattr(step, name) for step in result.steps]) for result in results]
        np.testing.assert_allclose(values[0], values[1], rtol=1e-10, atol=1e-8, err_msg=name)


def test_heat(tmp_path):
    """Also what was generated and given off."""
    file = COMM.bcast(material(Study(tmp_path), True) if COMM.rank == 0 else None)
    runs, results = both(
        {
            "spring": SPRING | {"pitch": 40.0},
            "material": file,
            "temperature": 293.15,
            "ends": "clamped",
            "mesh": MESH,
            "accuracy": "none",
            "heat": {"conductivity": 50.0, "convection": 200.0, "tips": 1.0},
            "loading": [
                {"to": {"travel": 40.0}, "steps": 3, "seconds": 2.0},
                {"to": {"force": 0.0}, "steps": 1, "seconds": 60.0},
            ],
        }
    )
    close(results)
    assert results[0].steps[2].temperature_K > 293.5
    for name in ("generated", "given_off"):
        assert getattr(runs[0].heat, name) == pytest.approx(getattr(runs[1].heat, name), rel=1e-10)


def test_a_wire_with_a_past():
    """Coiled, relieved, peened, then pressed and held warm; also the diameter to which it was coiled."""
    past = {
        "made_by": "coiling",
        "relieved": {"temperature": 523.15, "minutes": 30.0},
        "peening": {"depth": [0.0, 0.3, 0.8], "stress": [-300.0, -300.0, 0.0]},
    }
    runs, results = both(
        {
            "spring": SPRING | past,
            "material": "creeping",
            "temperature": 373.15,
            "ends": "clamped",
            "mesh": MESH,
            "loading": [{"to": {"travel": 15.0}, "steps": 2}, {"hold": {"hours": 100.0}, "steps": 2}],
        }
    )
    close(results)
    assert results[0].steps[-1].force_N < results[0].steps[1].force_N
    diameters = [run.setup.coiling_diameter for run in runs]
    assert diameters[0] == pytest.approx(diameters[1], rel=1e-10)
