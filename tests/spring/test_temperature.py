"""A spring at a temperature other than the material file's first."""

import numpy as np
import pytest
import yaml
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case

COLD = {"elasticity": {"G": 80000.0, "nu": 0.3}, "isotropic": {"k0_squared": 1.2e5, "a1": 0.0, "a2": 0.0, "a3": 1.0}}
HOT = {"elasticity": {"G": 70000.0, "nu": 0.3}, "isotropic": {"k0_squared": 0.5e5, "a1": 0.0, "a2": 0.0, "a3": 1.0}}
PROGRAM = "loading=[{to: {travel: 15}, steps: 4}, {to: {force: 0}, steps: 2}]"
COARSE = [
    "accuracy=none",
    "ends=clamped",
    "mesh.elements_per_turn=8",
    "contact.bedding=2000",
    PROGRAM,
]  # default bedding: of cold wire


@pytest.fixture
def make(example, tmp_path):
    """The example's spring, coarse, of a synthetic material known at some temperatures."""

    def make(table, *settings):
        rest = {"kinematic": "none", "non_normality": "none"}
        data = {
            "name": "synthetic",
            "description": "ideal plastic",
            "source": "made for this test",
            "units": "N, mm, K",
            "validity": {"plastic_work": 100, "remark": "none"},
            "temperatures": [{"temperature": t} | constants | rest for t, constants in table],
        }
        file = tmp_path / f"material{len(table)}.yaml"
        file.write_text(yaml.safe_dump(data))
        return Analysis(read_case(example, [*COARSE, f"material={file}", *settings]), MPI.COMM_SELF)

    return make


def test_a_hot_spring_is_one_of_the_hot_material(make):
    """At a temperature of the table its own constants count and no others."""
    hot = make([(300.0, COLD), (500.0, HOT)], "temperature=500").run()
    alone = make([(500.0, HOT)]).run()
    cold = make([(300.0, COLD), (500.0, HOT)]).run()
    forces = [np.array([step.force_N for step in result.steps]) for result in (hot, alone, cold)]
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-12, atol=1e-9)
    assert forces[2].max() > 1.3 * forces[0].max()  # k0 is 1.55 times as large
    assert hot.steps[-1].travel_mm > cold.steps[-1].travel_mm


def test_constants_are_interpolated(make):
    """Between both, at equal ν, the rate is that of the mean G."""
    rates = [make([(300.0, COLD), (500.0, HOT)], f"temperature={t}").initial_rate() for t in (300, 400, 500)]
    assert rates[1] == pytest.approx(0.5 * (rates[0] + rates[2]), rel=1e-6)
    assert rates[0] / rates[2] == pytest.approx(8 / 7, rel=1e-6)


def test_a_temperature_outside_the_table_is_refused(make):
    with pytest.raises(InputError, match="600 K is outside the table"):
        make([(300.0, COLD), (500.0, HOT)], "temperature=600")
