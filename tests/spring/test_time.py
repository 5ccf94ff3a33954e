"""Springs in time: holding, heating, load loss, and a run that goes on in the middle of a phase in time."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_files import run_of
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.core.case.case import check
from coilset.model.core.material import library
from coilset.model.core.results.quantities import quantities
from coilset.model.core.results.records.labels import last_released
from coilset.model.core.results.records.provenance import origin
from coilset.model.tools.figures.panels.characteristic import characteristic
from coilset.model.tools.report.answer import answer

HOLD = [{"to": {"travel": 10}, "steps": 1}, {"hold": {"hours": 1000}, "steps": 8}]
SPRING = {
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.0, "pitch": 25.0},
    "material": "creeping",
    "temperature": 373.15,
    "ends": "clamped",
    "mesh": {"elements_per_turn": 8, "section": {"kind": "plane", "radial": 3, "angular": 8}},
}


def analysis_of(loading, accuracy="none", **changes):
    return Analysis(check(SPRING | {"loading": loading, "accuracy": accuracy} | changes), MPI.COMM_SELF)


@pytest.fixture
def slow(tmp_path):
    """The library's creeping law with hardly any creep, and no thermal expansion."""
    data = yaml.safe_load((library.FOLDER / "creeping.yaml").read_text(encoding="utf-8"))
    data["creep"]["strain"] = 1e-30
    for at in data["temperatures"]:
        at["elasticity"]["alpha"] = 0.0
        at["isotropic"] = "none"
    path = tmp_path / "slow.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    return str(path)


def test_relaxation_follows_the_steps_accuracy():
    """Automatic steps lose what many equal ones lose, within the asked 0.2 %; their times grow logarithmically."""
    fine = analysis_of([HOLD[0], HOLD[1] | {"steps": 48}]).run()
    found = analysis_of([HOLD[0], HOLD[1] | {"steps": "auto"}], 0.002)
    result = found.run()
    losses = [summarise(found.setup, run)["load_loss_percent"] for run in (fine, result)]
    assert losses[0] > 1.0
    assert losses[1] == pytest.approx(losses[0], abs=0.2)
    hours = np.array([step.hours for step in result.steps])
    assert hours[0] == 0.0
    assert hours[-1] == 1000.0
    assert (np.diff(hours[2:]) > 0).all()
    assert np.diff(np.log(hours[4:])).min() > 0.3
    last, first = result.steps[-1], result.steps[0]
    assert last.load_loss_percent == pytest.approx(100 * (1 - last.force_N / first.force_N), rel=1e-12)
    assert last.seat_height_mm == pytest.approx(first.seat_height_mm, abs=1e-12)
    assert first.load_loss_percent is None


def test_steps_after_a_hold_take_no_time():
    """Released elastically, the spring's force is as uncertain as the hold left it, within 2 %; it was three times that
    when the finer path went back to the middle of the hold."""
    held = {"hold": {"hours": 1000}, "steps": 4}
    steps = analysis_of([HOLD[0], held, {"to": {"travel": 5}, "steps": 2}], 0.002).run().steps
    assert steps[4].steps_force_error_N > 0.1
    for step in steps[5:]:
        assert step.steps_force_error_N == pytest.approx(steps[4].steps_force_error_N, rel=0.02)
    automatic = analysis_of([HOLD[0], held, {"to": {"travel": 5}}], 0.002).run().steps
    assert len(automatic) - 5 < 16  # fewer than regular ones


def test_heat_and_back(slow):
    """Without creep and expansion the force follows G, 10 % less at 573 K, and comes back."""
    program = [
        {"to": {"travel": 10}, "steps": 1},
        {"heat": {"to": 573.15, "minutes": 30}, "steps": 2},
        {"heat": {"to": 293.15, "minutes": 90}, "steps": 1},
    ]
    steps = analysis_of(program, material=slow, temperature=293.15).run().steps
    cold = steps[0].force_N
    assert [step.force_N / cold for step in steps] == pytest.approx([1.0, 0.95, 0.9, 1.0], rel=1e-8)
    assert [step.temperature_K for step in steps] == pytest.approx([293.15, 433.15, 573.15, 293.15])
    assert [step.hours for step in steps] == pytest.approx([0.0, 0.25, 0.5, 2.0])
    assert [step.load_loss_percent for step in steps[1:]] == pytest.approx([5.0, 10.0, 0.0], abs=1e-6)


def test_each_time_at_a_height_is_listed_with_what_it_lost():
    """The last one, at another height, said nothing of what was lost before it."""
    heat, cool = ({"heat": {"to": kelvin, "minutes": 20}, "steps": 2} for kelvin in (373.15, 293.15))
    hold, deeper = {"hold": {"hours": 1000}, "steps": 4}, {"to": {"travel": 14}, "steps": 2}
    stay = [{"to": {"travel": 10}, "steps": 1}, heat, hold]
    analysis = analysis_of([*stay, deeper, cool], temperature=293.15)
    result = analysis.run()
    summary = summarise(analysis.setup, result)
    first, last = summary["load_losses"]
    steps = result.steps
    assert (first["step"], last["step"]) == (7, 11)
    assert first["height_mm"] - last["height_mm"] == pytest.approx(4.0)
    assert first["hours"] == pytest.approx(1000 + 1 / 3)
    for one, before in ((first, steps[0]), (last, steps[8])):
        after = steps[one["step"] - 1]
        assert one["loss_percent"] == pytest.approx(100 * (1 - after.force_N / before.force_N), rel=1e-12)
        assert (one["force_before_N"], one["force_after_N"]) == (before.force_N, after.force_N)
    assert summary["load_loss_percent"] == last["loss_percent"] < 0.0 < first["loss_percent"]
    rows = {one.words: one.remark for one in quantities(summary)}
    assert sum(name.startswith("load lost in time at") for name in rows) == 2
    assert rows["load lost in time at 16 mm"].endswith(" in 0.3333 h, from 373 to 293 K")
    assert "loses" not in characteristic(run_of(analysis.setup, analysis.result, origin(analysis.case))).title


def test_a_set_before_the_time_under_load_is_called_so():
    """The run ends loaded: what it lost since its last release is not in its set."""
    loading = [{"to": {"travel": 10}, "steps": 1}, {"to": {"force": 0}, "steps": 1}, *HOLD]
    analysis = analysis_of(loading)
    summary = summarise(analysis.setup, analysis.run())
    assert last_released(summary) == (2, 11)
    assert (
        " by its last release and then loses "
        in characteristic(run_of(analysis.setup, analysis.result, origin(analysis.case))).title
    )
    assert answer(summary)[0].remark.endswith("at the last release, in step 2 of 11")
    assert last_released(summary | {"steps": 2}) is None


def test_constant_force():
    """The spring creeps down under its force, more and more slowly; then the force is what it was."""
    program = [{"to": {"force": 400}, "steps": 1}, {"hold": {"hours": 1000, "keep": "force"}, "steps": 6}]
    steps = analysis_of(program).run().steps
    assert [step.force_N for step in steps] == pytest.approx([400.0] * 7, rel=1e-7)
    heights = np.array([step.seat_height_mm for step in steps])
    assert (np.diff(heights) < 0).all()
    assert heights[-1] < heights[0] - 0.05
    assert all(step.load_loss_percent is None for step in steps)


def test_a_run_goes_on_in_the_middle_of_a_hold(resumed_after):
    """To the same bits, with the clock where it was."""
    program = [*HOLD, {"heat": {"to": 303.15, "minutes": 5}, "steps": 2}, {"to": {"force": 0}, "steps": 2}]
    case = check(SPRING | {"loading": program})
    whole = Analysis(case, MPI.COMM_SELF)
    whole.run()
    resumed = resumed_after(case, 5)
    assert 0.0 < resumed.rod.clock[0] < 1000.0
    assert resumed.run().steps == whole.result.steps
    for name, field in whole.system.state.items():
        assert (field.equilibrium == resumed.system.state[name].equilibrium).all(), name


@pytest.fixture
def viscous(tmp_path):
    """A law whose yield stress rises with the rate, by 15 % at a plastic strain rate of 0.001 1/s."""
    data = yaml.safe_load((library.FOLDER / "linear_isotropic.yaml").read_text(encoding="utf-8"))
    data["rate"] = {"reference_rate": 30.0, "exponent": 5.5}
    path = tmp_path / "viscous.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    return str(path)


def test_a_fast_press_carries_more_and_then_relaxes(viscous):
    """Infinitely slow without seconds, as without the entry; fast, the force is higher, and falls to it in a hold.

    To 0.6 % above in six steps. At 20 mm the spring is solid, and its force, a hundred times as large, says little.
    The law with a rate is integrated otherwise: before the coils close forces differ by 1.5e-4, in 12 steps by 3.7e-5.
    """
    press = {"to": {"travel": 18}, "steps": 6}
    still = analysis_of([press], material=viscous, temperature=293.15).run().steps[-1]
    plain = analysis_of([press], material="linear_isotropic", temperature=293.15).run().steps[-1]
    slow = analysis_of([press | {"seconds": 1e9}], material=viscous, temperature=293.15).run().steps[-1]
    assert still.force_N == pytest.approx(plain.force_N, rel=2e-4)  # another integration
    assert plain.force_N < slow.force_N < 1.01 * plain.force_N
    program = [press | {"seconds": 1.0}, {"hold": {"hours": 1e6}, "steps": 12}]
    steps = analysis_of(program, material=viscous, temperature=293.15).run().steps
    assert steps[5].hours == pytest.approx(1.0 / 3600.0)
    assert steps[5].force_N > 1.03 * plain.force_N
    forces = [step.force_N for step in steps[5:]]
    assert (np.diff(forces) < 0.0).all()
    assert forces[-1] < 0.98 * forces[0]
    assert forces[-1] < 1.01 * plain.force_N


@pytest.mark.parametrize(
    ("loading", "changes", "message"),
    [
        (
            [{"hold": {"hours": 1}}],
            {"material": "ck15", "temperature": 293.15},
            "loading.0.hold: 'ck15' does not creep, so that time changes nothing; give a material with creep, or leave",
        ),
        (
            [{"heat": {"to": 700, "hours": 1}}],
            {},
            "loading.0.heat.to: 700 K is outside the table of 'creeping', known for 293.15 to 573.15 K",
        ),
        ([{"heat": {"to": 100, "hours": 1}}], {}, "known for 293.15 to 573.15 K; 100 °C is 373.15 K"),
        (HOLD, {"temperature": 20.0}, "temperature: 20 K is outside the table of 'creeping', known for"),
        ([{"hold": {"hours": 1, "minutes": 2}}], {}, "give exactly one of hours or minutes, as in {hours: 48}"),
        ([{"hold": {"hours": 1}, "heat": {"to": 300, "hours": 1}}], {}, "give exactly one of hold or heat"),
        ([{"hold": {"hours": -1}}], {}, "loading.0.hold.hours: -1: must be greater than 0"),
        (
            [{"to": {"travel": 1}, "steps": 1, "seconds": 2}],
            {},
            "loading.0.seconds: no heat flows, and 'creeping' does not depend on the rate",
        ),
    ],
)
def test_what_time_cannot_be(loading, changes, message):
    with pytest.raises(InputError) as caught:
        analysis_of(loading, 0.002, **changes)
    assert message in str(caught.value)
    assert ".yaml" not in str(caught.value)  # the entry is one of the case, not of the material's file


COARSE = ["accuracy=none", "mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9"]


def test_examples_say_what_presetting_is_worth():
    """The shipped cases, coarse and in few steps: presetting saves load, warm more than cold; coiling costs some."""
    losses = []
    names = ("relaxation", "relaxation_cold_preset", "relaxation_warm_preset", "coiled", "coiled_relieved")
    for name in names:
        file = Path(__file__).resolve().parents[2] / "examples" / "time" / f"{name}.yaml"
        phases = len(read_case(file).loading)
        case = read_case(file, [*COARSE, *(f"loading.{k}.steps=4" for k in range(phases))])
        analysis = Analysis(case, MPI.COMM_SELF)
        summary = summarise(analysis.setup, analysis.run())
        losses.append(summary["load_loss_percent"])
    # against the shipped meshes and steps, docs/how-to/load-loss.md
    assert losses[:2] == pytest.approx([10.07, 8.12], abs=0.4)
    assert losses[2] == pytest.approx(0.32, abs=0.05)
    assert losses[0] + 1.0 < losses[4] < losses[3] - 1.0  # nine points are too few for numbers of a coiled wire


def test_the_error_of_fast_steps_is_known(viscous):
    """In size and sign; and it is larger than that of the law without the rate."""

    def pressed(steps, **fast):
        phase = {"to": {"travel": 12}, "steps": steps} | fast
        return analysis_of([phase], 0.002, material=viscous, temperature=293.15).run().steps[-1]

    coarse, fine, still = pressed(6, seconds=1.0), pressed(24, seconds=1.0), pressed(6)
    error = fine.force_N + fine.steps_force_error_N - coarse.force_N
    assert coarse.steps_force_error_N == pytest.approx(error, rel=0.15)
    assert abs(coarse.steps_force_error_N) > 5.0 * abs(still.steps_force_error_N)


def test_the_error_of_steps_without_time_is_known_after_a_heating():
    """No time passes in them, half way neither: it is that of a spring that was warm before, but for its expansion."""
    press = {"to": {"travel": 14}, "steps": 8}
    heat = {"heat": {"to": 423.15, "minutes": 20, "keep": "force"}, "steps": 2}
    heated, warm = (
        analysis_of(loading, 0.002, temperature=start).run().steps[-8:]
        for loading, start in (([heat, press], 373.15), ([press], 423.15))
    )
    errors = [[step.steps_force_error_N for step in steps] for steps in (heated, warm)]
    assert None not in errors[0]
    assert errors[0] == pytest.approx(errors[1], abs=0.02 * errors[1][-1])
