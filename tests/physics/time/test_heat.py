"""Heat along the wire: fins, energy, a spring with heat that stops and goes on, and wrong input."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.entry import check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import check
from coilset.model.core.case.phases import Phase
from coilset.verification.cases.time.heat_along_wire import exact, fin, material
from coilset.verification.study import Study

CASE = {
    "accuracy": "none",
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.0, "pitch": 60.0},
    "ends": "clamped",
    "temperature": 293.15,
    "mesh": {"elements_per_turn": 8, "section": {"radial": 3, "angular": 8}},
    "heat": {"conductivity": 50.0, "convection": 200.0, "tips": 1.0},
    "loading": [
        {"to": {"travel": 45.0}, "steps": 4, "seconds": 2.0},
        {"to": {"force": 0.0}, "steps": 2, "seconds": 60.0},
    ],
}


@pytest.fixture
def warming(tmp_path):
    return material(Study(tmp_path), True)


def test_order_of_the_fin():
    errors = [np.abs(values - exact(x)).max() for x, values in (fin(10), fin(20))]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_heat_that_is_generated_is_in_the_wire_or_given_off_and_a_run_goes_on(warming, resumed_after):
    """Stopped in between and resumed, with temperatures and heat, to the same bits."""
    case = check(CASE | {"material": warming})
    whole = Analysis(case, MPI.COMM_SELF)
    steps = whole.run().steps
    assert steps[3].temperature_K > 295.0
    assert steps[-1].temperature_K < steps[3].temperature_K - 0.5
    assert steps[-1].hours == pytest.approx(62.0 / 3600.0)
    heat = whole.heat
    assert heat.given_off > 0.1 * heat.generated
    rise = heat.equation.content - heat.start_content
    assert rise + heat.given_off == pytest.approx(heat.generated, rel=5e-3)

    resumed = resumed_after(case, 4)
    assert resumed.run().steps == steps
    for name, field in whole.system.state.items():
        assert (field.equilibrium == resumed.system.state[name].equilibrium).all(), name


def test_heat_flows_for_the_seconds_of_each_phase_whatever_came_before_it(warming, resumed_after):
    """Half of 2 s, then another target in 2 s more."""
    there, elsewhere = ([{"to": {"travel": travel}, "steps": 4, "seconds": 2.0}] for travel in (8.0, 6.0))
    before, after = (check(CASE | {"material": warming, "loading": loading}) for loading in (there, elsewhere))
    steps = resumed_after(after, 2, before).run().steps
    assert [3600.0 * step.hours for step in steps] == pytest.approx([0.5, 1.0, 1.5, 2.0, 2.5, 3.0])


def test_another_target_takes_time_too(warming):
    """Chosen in the middle of a run, without seconds: heat would stand still."""
    analysis = Analysis(check(CASE | {"material": warming}), MPI.COMM_SELF)
    with pytest.raises(InputError, match="takes no time, but heat flows"):
        analysis.redirect(check_entries({"to": {"travel": 5.0}, "steps": 1}, Phase))
    assert analysis.case.loading[0].to.travel == 45.0


def test_expansion_of_a_free_wire_causes_no_stress(warming, tmp_path):
    """Heated evenly by 100 K and grown by α ΔT in all directions a spring has no stress; held, its wire has E α ΔT."""
    data = yaml.safe_load(Path(warming).read_text(encoding="utf-8"))
    for at in data["temperatures"]:
        at["elasticity"]["alpha"] = 1.2e-5
        at["isotropic"] = "none"
    (tmp_path / "expands.yaml").write_text(yaml.safe_dump(data), encoding="utf-8")
    heat = {"conductivity": 50.0, "convection": 200.0, "surroundings": 393.15}
    analysis = Analysis(check(CASE | {"material": str(tmp_path / "expands.yaml"), "heat": heat}), MPI.COMM_SELF)
    rod, growth = analysis.rod, 1.2e-3
    analysis.heat.advance(1e9)
    assert rod.update()
    held = analysis.law.E * growth
    force = rod.coefficients.s[..., 0] @ rod.element.weights  # on the nodes; the sections are not in equilibrium yet
    assert force == pytest.approx(-held * np.pi * 2.5**2, rel=0.05)  # chords are 2.6 % shorter
    rod.increment.x.array[rod.numbering.u] = growth * rod.state["x"].equilibrium
    assert rod.update()
    assert np.abs(rod.point_state[..., :3]).max() < 1e-3 * held  # strains of second order


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"material": "ck15"}, "heat: plastic work does not warm 'ck15'"),
        ({"heat": None}, "loading.0.seconds: no heat flows, and 'warming' does not depend on the rate"),
        ({"loading": [{"to": {"travel": 5.0}, "steps": 1}]}, "loading.0 takes no time, but heat flows"),
        ({"loading": [{"hold": {"hours": 1}}]}, "loading.0.hold: 'warming' does not creep; to let heat"),
        ({"mesh": {"section": {"kind": "warping"}}}, "heat needs sections of fibres"),
        ({"heat": {"conductivity": 0.0}}, "heat.conductivity: 0.0: must be greater than 0"),
        ({"heat": {"conductivity": 50.0, "surroundings": 200.0}}, "heat.surroundings: 200 K is outside the table"),
    ],
)
def test_what_heat_cannot_be(changes, message, warming):
    with pytest.raises(InputError) as caught:
        Analysis(check(CASE | {"material": warming, "accuracy": 0.002} | changes), MPI.COMM_SELF)
    assert message in str(caught.value)
