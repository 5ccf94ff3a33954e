"""Heat along a wire that creeps: each point ages by its own temperature, and the surroundings can be driven."""

import numpy as np
import pytest
import yaml
from mpi4py import MPI

from coilset.meshes.springs.placement import straight
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import check
from coilset.model.core.material import library
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import polar
from coilset.model.physics.time.creep.law import CreepLaw

COLD, WARM = 293.15, 373.15
SPRING = {
    "accuracy": "none",
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.0, "pitch": 60.0},
    "ends": "clamped",
    "mesh": {"elements_per_turn": 8, "section": {"radial": 3, "angular": 8}},
}
HEATING = {"dissipated": 0.9, "density": 7.85e-9, "specific_heat": 4.6e8}
AT_ONCE = {"seconds": 1e-30}
OVEN = {"conductivity": 50.0, "convection": 1e6}  # the wire is as warm as the air within a millisecond


@pytest.fixture
def files(tmp_path):
    """The library's creeping law: alone, with heating by plastic work, hardly creeping; two that never yield."""
    data = yaml.safe_load((library.FOLDER / "creeping.yaml").read_text(encoding="utf-8"))
    constants = data["creep"]
    slow = {"heating": HEATING, "creep": constants | {"strain": 1e-30}}
    kinds = {"creeps": {}, "both": {"heating": HEATING}, "slow": slow}
    for name, change in kinds.items():
        (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump(data | change), encoding="utf-8")
    never = {"temperatures": [at | {"isotropic": "none"} for at in data["temperatures"]]}
    for name, change in (("elastic creeps", {}), ("elastic both", {"heating": HEATING})):
        (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump(data | never | change), encoding="utf-8")
    del data["creep"]
    (tmp_path / "heats.yaml").write_text(yaml.safe_dump(data | {"heating": HEATING}), encoding="utf-8")
    return {name: str(tmp_path / f"{name}.yaml") for name in (*kinds, "heats", "elastic creeps", "elastic both")}


def analysis_of(material, loading, temperature=COLD, **changes):
    about = {"material": material, "loading": loading, "temperature": temperature}
    return Analysis(check(SPRING | about | changes), MPI.COMM_SELF)


def test_where_all_is_equally_warm_heat_changes_nothing(files):
    """An elastic spring relaxes in a warm room as one whose temperature is given."""
    hold = {"hold": {"hours": 1000}, "steps": 6}
    press = {"to": {"travel": 9}, "steps": 1}
    steps = (
        analysis_of(files["elastic creeps"], [press, hold], WARM).run().steps,
        analysis_of(files["elastic both"], [press | AT_ONCE, hold], WARM, heat=OVEN).run().steps,
    )
    given, found = ([step.force_N for step in one] for one in steps)
    assert given[-1] < 0.95 * given[0]
    assert found == pytest.approx(given, rel=1e-6)
    assert [step.temperature_K for step in steps[1]] == pytest.approx([WARM] * 7, abs=1e-6)
    assert steps[1][-1].load_loss_percent == pytest.approx(steps[0][-1].load_loss_percent, abs=1e-4)


def test_an_oven_with_strong_convection_heats_as_a_given_temperature(files):
    """Loaded, heated by 80 K, held and cooled: the difference falls with the number of steps of the ramps."""

    def losses(material, steps, at_once, **heat):
        program = [
            {"to": {"travel": 9}, "steps": 1, **at_once},
            {"heat": {"to": WARM, "minutes": 20}, "steps": steps},
            {"hold": {"hours": 100}, "steps": 8},
            {"heat": {"to": COLD, "minutes": 20}, "steps": 4},
        ]
        found = analysis_of(files[material], program, **heat).run().steps
        return np.array([step.load_loss_percent for step in found[steps:]])

    given = losses("elastic creeps", 40, {})
    errors = [losses("elastic both", steps, AT_ONCE, heat=OVEN) - given for steps in (20, 40)]
    assert given[-1] > 4.0
    assert np.abs(errors[1]).max() < 0.2
    assert np.abs(errors[1][0] / errors[0][0]) == pytest.approx(0.5, abs=0.1)
    assert np.abs(errors[1][8:]).max() < 0.03  # what the ramp has lost too little is lost at the beginning of the hold


@pytest.mark.parametrize("kind", ["plane", "curved"])
def test_a_section_that_grows_evenly_has_no_stress(files, kind):
    """Heated, and its axis as much longer, without a turn: a curved wire's fibres have no stress; held, E α ΔT/g."""
    law = library.load(files["elastic creeps"])
    place = straight(1)._replace(curvature=np.full((1, 2), 0.05))
    sections = make_sections(kind, law, law.parameters(COLD), polar(3, 8), np.array([2.5]), place, COLD)
    creep = CreepLaw(law.data.creep, law.parts(law.parameters(COLD)))
    start = sections.initial_state() | {"strain": np.zeros((1, 2, 6)), "clock": creep.clock(0.0, COLD)}
    growth, s, D, stress = law.thermal_strain(COLD, WARM), np.empty((1, 2, 6)), np.empty((1, 2, 6, 6)), []
    for axis in (0.0, growth):
        trial = {name: values.copy() for name, values in start.items()}
        trial["clock"] = creep.clock(1e-9, WARM, start["clock"])
        trial["strain"][..., 0] = axis
        assert sections.update(trial["strain"], start, trial, s, D)
        stress.append(trial["point_state"][..., :3])
    g = 1.0 - (0.05 * 2.5 * polar(3, 8).points[:, 0] if kind == "curved" else 0.0)
    held = law.moduli(WARM)[0] * growth
    np.testing.assert_allclose(stress[0][0, 0, :, 0], -held / g * np.ones(24), rtol=1e-3)
    assert np.abs(stress[1]).max() < 1e-3 * held


def test_without_creep_heat_flows_as_before(files):
    """A preset in 2 s of the law that hardly creeps, and of the one that does not: same forces, temperatures, heat."""
    program = [
        {"to": {"travel": 45.0}, "steps": 4, "seconds": 2.0},
        {"to": {"force": 0.0}, "steps": 2, "seconds": 60.0},
    ]
    heat = {"conductivity": 50.0, "convection": 200.0, "tips": 1.0}
    two = [analysis_of(files[name], program, heat=heat) for name in ("heats", "slow")]
    for one in two:
        one.run()
    for name, tolerance in (("force_N", 1e-3), ("temperature_K", 1e-6), ("hours", 1e-12)):
        found = [[getattr(step, name) for step in one.result.steps] for one in two]
        assert found[1] == pytest.approx(found[0], rel=tolerance, abs=0.05 if name == "force_N" else 0.0)
    assert two[0].result.steps[3].temperature_K > COLD + 1.0
    balance = two[1].heat
    assert balance.generated == pytest.approx(two[0].heat.generated, rel=1e-3)
    rise = balance.equation.content - balance.start_content
    assert rise + balance.given_off == pytest.approx(balance.generated, rel=5e-3)


def test_it_goes_on_after_a_stop(files, resumed_after):
    """Stopped in the oven: clocks, surroundings and temperatures are where they were, to the bit."""
    program = [
        {"to": {"travel": 40.0}, "steps": 3, "seconds": 2.0},
        {"heat": {"to": WARM, "minutes": 1}, "steps": 4},
        {"hold": {"minutes": 5, "keep": "force"}, "steps": 2},
    ]
    heat = {"conductivity": 50.0, "convection": 20.0, "tips": 1.0}
    case = check(SPRING | {"material": files["both"], "temperature": COLD, "heat": heat, "loading": program})
    whole = Analysis(case, MPI.COMM_SELF)
    steps = whole.run().steps
    assert COLD + 10.0 < steps[6].temperature_K < steps[-1].temperature_K < WARM
    resumed = resumed_after(case, 5)
    assert resumed.run().steps == steps
    for name, field in whole.system.state.items():
        assert (field.equilibrium == resumed.system.state[name].equilibrium).all(), name
    assert resumed.heat.equation.surroundings.value == WARM


def test_an_equilibrium_found_again_after_the_heat_is_no_step_of_the_path(files):
    """Pressed in 2 s, the steps' errors are those without creep, where none is found again, to 2 %."""
    press, heat = {"to": {"travel": 40.0}, "steps": 4, "seconds": 2.0}, {"conductivity": 50.0, "convection": 20.0}
    alone = analysis_of(files["heats"], [press], heat=heat).run().steps
    analysis = analysis_of(files["slow"], [press], heat=heat)
    outcomes, increments, solve = [], [], analysis.newton.solve

    def keep(load, start=None):
        outcomes.append(solve(load, start))
        increments.append(analysis.system.increments.getArray().copy())
        return outcomes[-1]

    analysis.newton.solve, following = keep, []
    steps = analysis.run(lambda _: following.append(analysis.continuation.guess.scaled_last(1.0).getArray())).steps
    assert [step.steps_force_error_N for step in steps[1:]] == pytest.approx(
        [step.steps_force_error_N for step in alone[1:]], rel=0.02
    )
    of_steps = outcomes[1:]  # after the initial rate
    assert len(of_steps) == 2 * len(steps)
    assert sum(step.evaluations for step in steps) == sum(outcome.evaluations for outcome in of_steps)
    assert sum(step.iterations for step in steps) == sum(outcome.iterations for outcome in of_steps)
    for found, guess in zip(increments[1::2], following, strict=True):
        np.testing.assert_array_equal(guess, found)


def test_another_target_leaves_the_surroundings_as_warm_as_they_are(files, resumed_after):
    """The wire is colder than its oven when the hold is made longer: the oven does not get as cold as the wire."""
    press, holds = {"to": {"travel": 9.0}, "steps": 1, "seconds": 1.0}, ({"hold": {"minutes": m}} for m in (5, 10))
    heat = {"conductivity": 50.0, "convection": 20.0, "surroundings": WARM}
    about = SPRING | {"material": files["both"], "temperature": COLD, "heat": heat}
    before, after = (check(about | {"loading": [press, hold | {"steps": 2}]}) for hold in holds)
    resumed = resumed_after(after, 2, before)
    assert COLD < resumed.rod.hottest < WARM
    assert resumed.program.position.begun == resumed.program.now
    assert resumed.program.now.temperature == WARM


def test_coiled_wire_is_as_warm_as_the_spring(files):
    """Coiling, relief and peening leave no heat behind, and the relief is that of the law without heating."""
    past = {
        "made_by": "coiling",
        "relieved": {"temperature": 523.15, "minutes": 30},
        "peening": {"depth": [0, 0.2, 0.6], "stress": [-200, -200, 0]},
    }
    spring = SPRING["spring"] | {"pitch": 20.0} | past
    mesh = {"elements_per_turn": 8, "section": {"radial": 6, "angular": 12}}
    loading = [{"to": {"travel": 1.0}, "steps": 1, "seconds": 1.0}]
    both = analysis_of(files["both"], loading, spring=spring, mesh=mesh, heat=OVEN)
    alone = analysis_of(files["creeps"], [{"to": {"travel": 1.0}, "steps": 1}], spring=spring, mesh=mesh)
    np.testing.assert_allclose(both.rod.point_state, alone.rod.point_state, rtol=1e-9, atol=1e-6)
    assert both.rod.point_state[..., 7] == pytest.approx(COLD, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "changes", "message"),
    [
        ("both", {"loading": [{"hold": {"hours": 1}}]}, "loading.0.hold: plastic work heats 'creeping', and in time"),
        ("heats", {"loading": [{"hold": {"hours": 1}}], "heat": OVEN}, "loading.0.hold: 'creeping' does not creep; to"),
        (
            "both",
            {"loading": [{"to": {"travel": 1}, "steps": 1}], "heat": OVEN},
            "loading.0 takes no time, but heat flows",
        ),
    ],
)
def test_what_goes_not_together(files, name, changes, message):
    with pytest.raises(InputError) as caught:
        analysis_of(files[name], **{"accuracy": 0.002} | changes)
    assert message in str(caught.value)
