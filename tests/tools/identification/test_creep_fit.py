"""Constants of creep from relaxation tests: against the point's own integration, known truth in noise, wrong files."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from scipy.special import hyp2f1
from typer.testing import CliRunner

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.core.material.point.loops import follow
from coilset.model.physics.time.creep.entries import Creep
from coilset.model.physics.time.creep.law import GAS_CONSTANT, CreepLaw
from coilset.model.tools.identification import creep_fit
from coilset.model.tools.identification.relaxation_tests import Readings, read_relaxation
from coilset.model.tools.identification.relaxing import loss
from coilset.scripts.commands.material import app
from coilset.verification.cases.time import creep_fit as studies

TRUE = {
    "strain": 2e-4,
    "stress": 800.0,
    "exponent": 6.0,
    "time_exponent": 0.2,
    "activation_energy": 150000.0,
    "temperature": 373.15,
}
SINH = TRUE | {"strain": 1e-6, "stress": 250.0, "exponent": 4.0}
HOURS = [1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0]
NOISE = 0.4  # per cent of the load


def readings(kind="torsion", stresses=(450.0, 600.0, 750.0), temperatures=(353.15, 393.15, 433.15), hours=HOURS):
    S, T, H = (part.ravel() for part in np.meshgrid(stresses, temperatures, hours, indexing="ij"))
    return Readings(kind, S, T, H, np.zeros(S.size))


def exact(law, tests, constants=TRUE, form="norton_bailey"):
    """The same tests with the loss of the known constants."""
    return replace(tests, loss=loss(form, "strain", constants, tests, creep_fit.modulus(law, tests)))


@pytest.mark.parametrize("hours", [1.0, 1e3, 1e5])
def test_loss_of_a_bar_in_torsion(hours):
    """Time hardening in closed form, as `verification/cases/relaxation`: γ = A τ^N t^p, A 1e-20, τR 700 N/mm²."""
    N, G, A, p, rim = 6.0, 80000.0, 1e-20, 0.3, 700.0
    constants = {
        "strain": A * 500.0**N / 3.0 ** (0.5 * (N + 1.0)),
        "stress": 500.0,
        "exponent": N,
        "time_exponent": p,
        "activation_energy": 0.0,
        "temperature": 293.15,
    }
    tests = Readings("torsion", np.array([rim]), np.array([293.15]), np.array([hours]), np.zeros(1))
    found = loss("norton_bailey", "time", constants, tests, np.array([3.0 * G]))
    z = (N - 1.0) * G * A * hours**p * rim ** (N - 1.0)
    closed = hyp2f1(1.0 / (N - 1.0), 4.0 / (N - 1.0), 1.0 + 4.0 / (N - 1.0), -z)
    assert 1.0 - 0.01 * found[0] == pytest.approx(closed, rel=2e-5)


@pytest.mark.parametrize(("form", "constants"), [("norton_bailey", TRUE), ("garofalo", SINH)])
def test_loss_of_a_wire_in_tension(form, constants):
    """As the law's own integration at a point finds it, with steps equal in log t."""
    law, temperature, stress = library.load("creeping"), 393.15, 700.0
    creep = CreepLaw(Creep(form=form, **constants), law.parts(law.parameters(temperature)))
    state = np.zeros((1, 9))
    state[0, [0, 7]] = stress, temperature
    clock = creep.clock(0.0, temperature)
    for time in np.geomspace(1e-12, 100.0, 300):
        after = creep.clock(time, temperature, clock)
        state, _, count = follow(creep.over(clock, after), state, np.zeros((1, 3)))
        assert count[0] >= 0
        clock = after
    tests = Readings("tension", np.array([stress]), np.array([temperature]), np.array([100.0]), np.zeros(1))
    found = exact(law, tests, constants, form).loss[0]
    assert found > 5.0
    assert found == pytest.approx(100.0 * (1.0 - state[0, 0] / stress), rel=3e-3)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """40 series with normal noise of 0.4 % of the load: each constant is inside in 38 of 40 on average, 95 %.

    Were the intervals right, less than 34 would have a chance of 0.3 %, and none outside in any constant one of 0.03 %.
    """
    law = library.load("creeping")
    clean, rng, inside, scatter = exact(law, readings()), np.random.default_rng(3), {}, []
    for _ in range(40):
        noisy = replace(clean, loss=clean.loss + rng.normal(0.0, NOISE, clean.loss.size))
        found = creep_fit.fit_creep(law, (noisy,))
        there = found.constants["stress"] / 800.0
        cold = 1.0 / found.constants["temperature"] - 1.0 / 373.15
        worth = np.exp(-TRUE["activation_energy"] / GAS_CONSTANT * cold)
        true = TRUE | {"strain": 2e-4 * there ** TRUE["exponent"] * worth ** TRUE["time_exponent"]}
        for name, (low, high) in found.interval.items():
            inside[name] = inside.get(name, 0) + (low <= true[name] <= high)
        scatter.append(found.scatter)
    assert set(inside) == {"strain", "exponent", "time_exponent", "activation_energy"}
    assert min(inside.values()) >= 34
    assert sum(inside.values()) < 4 * 40
    assert np.mean(scatter) == pytest.approx(NOISE, rel=0.03)


@pytest.mark.parametrize("study", studies.STUDIES[:2])
def test_constants_come_back_from_other_integrals(study):
    """Torsion by the closed form ₂F₁, tension by scipy's DOP853; what follows uses the fit's own quadrature."""
    kind, form, hardening, constants, stresses, _ = study
    tests = studies.readings(kind, form, constants, stresses)
    found = creep_fit.fit_creep(library.load("creeping"), (tests,), form, hardening)
    true = studies.truth(constants, found)
    assert found.scatter < 1e-3
    assert [found.constants[name] for name in found.interval] == pytest.approx(
        [true[name] for name in found.interval], rel=1e-4
    )


@pytest.mark.slow
def test_garofalo_and_two_kinds_of_tests():
    """Tension and torsion together give sinh's five constants back; without noise exactly."""
    law = library.load("creeping")
    tests = tuple(
        exact(law, readings(kind, (300.0, 600.0, 900.0), (353.15, 413.15), [1.0, 30.0, 1000.0]), SINH, "garofalo")
        for kind in ("tension", "torsion")
    )
    found = creep_fit.fit_creep(law, tests, "garofalo")
    assert found.scatter < 1e-3
    for name in ("stress", "exponent", "time_exponent", "activation_energy"):
        assert found.constants[name] == pytest.approx(SINH[name], rel=1e-3)


def write(path, tests):
    rows = zip(tests.hours, tests.temperature, tests.stress, tests.loss, strict=True)
    lines = ["# synthetic", "hours,temperature,shear_stress,loss", *(",".join(f"{v:.6g}" for v in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_the_command(tmp_path):
    """`coilset material creep` prints constants with intervals, and writes a material that creeps, and a picture."""
    law = library.load("creeping")
    clean = exact(law, readings())
    write(tmp_path / "tests.csv", replace(clean, loss=clean.loss + np.random.default_rng(1).normal(0, 0.3, 63)))
    arguments = ["creep", "creeping", str(tmp_path / "tests.csv"), "--name", "mine", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    assert "activation_energy" in done.output
    data = yaml.safe_load((tmp_path / "mine.yaml").read_text(encoding="utf-8"))
    assert data["creep"]["exponent"] == pytest.approx(6.0, abs=0.3)
    assert library.load(tmp_path / "mine.yaml").data.creep.activation_energy == pytest.approx(150000.0, rel=0.1)
    assert (tmp_path / "mine.png").stat().st_size > 20_000
    assert isinstance(CliRunner().invoke(app, arguments).exception, InputError)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda text: text.replace("hours", "time"),
            "column hours: is missing; the columns are hours, temperature, loss, and stress or shear_stress, but here ",
        ),
        (lambda text: text.replace("shear_stress", "tau"), "give one of the columns stress and shear_stress"),
        (lambda text: "\n".join(text.splitlines()[:6]), "has 4 readings; 8 are needed at least"),
        (lambda text: text.replace("\n1,", "\n-1,", 1), "line 3, column hours: -1 must be between 0 and 1e+07"),
        (lambda text: text.replace(",0\n", ",-3.7\n", 1), "line 3, column loss: -3.7 must be 0 or more, and below 100"),
        (lambda text: text.replace(",0\n", ",100\n", 1), "line 3, column loss: 100 must be 0 or more, and below 100"),
    ],
)
def test_wrong_files(change, message, tmp_path):
    write(tmp_path / "tests.csv", readings())
    path = tmp_path / "wrong.csv"
    path.write_text(change((tmp_path / "tests.csv").read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(InputError) as error:
        read_relaxation(path)
    assert message in str(error.value)


POINTS = "temperature;shear_stress;loss\n353,15;600;{}\n393,15;600;{}\n393,15;750;{}\n"


def of_points(tmp_path, losses):
    path = tmp_path / "points.csv"
    path.write_text(POINTS.format(*(f"{loss:.4f}".replace(".", ",") for loss in losses)))
    return read_relaxation(path, points=True)


def test_three_points_of_a_catalogue_determine_three_constants(tmp_path):
    """The law of the points comes back; in noise of the stated error the intervals hold it 19 times of 20."""
    law = library.load("creeping")
    clean = exact(law, of_points(tmp_path, [1.0, 1.0, 1.0]))
    assert clean.hours.tolist() == [48.0] * 3
    fitted = lambda tests: creep_fit.fit_creep(law, (tests,), time_exponent=0.2, error=0.3)  # noqa: E731
    found = fitted(of_points(tmp_path, clean.loss))
    assert found.constants["exponent"] == pytest.approx(6.0, rel=2e-3)
    assert found.constants["activation_energy"] == pytest.approx(150000.0, rel=2e-3)
    assert found.range == {"stress": [1039.23, 1299.04], "temperature": [353.15, 393.15], "hours": [48.0, 48.0]}
    rng, held = np.random.default_rng(0), []
    for _ in range(60):
        one = fitted(replace(clean, loss=clean.loss + 0.3 * rng.normal(size=3)))
        held.append([low <= TRUE[name] <= high for name, (low, high) in one.interval.items() if name != "strain"])
    assert (np.mean(held, axis=0) > 0.86).all()  # of 60, fewer than 52 would happen once in 150 times
    assert not found.beyond


def test_points_that_no_law_follows_are_seen(tmp_path):
    """A loss that falls with the temperature, among six points."""
    law = library.load("creeping")
    tests = Readings("torsion", *np.array([[600.0, 750.0] * 3, [353.15] * 2 + [393.15] * 4, [48.0] * 6, [0.0] * 6]))
    clean = exact(law, tests)
    wrong = replace(clean, loss=clean.loss + np.array([0.0, 0.0, 3.0, -3.0, -3.0, 3.0]))
    assert creep_fit.fit_creep(law, (wrong,), time_exponent=0.2, error=0.5).beyond
    assert not creep_fit.fit_creep(law, (clean,), time_exponent=0.2, error=0.5).beyond


def test_one_time_needs_its_exponent(tmp_path):
    with pytest.raises(InputError, match="give p by --time-exponent"):
        creep_fit.fit_creep(library.load("creeping"), (of_points(tmp_path, [1.0, 2.0, 3.0]),), error=0.5)


def test_the_command_takes_load_losses_of_a_spring(tmp_path):
    """Forces become 8 F D/(π d³); the material file says for what it is known."""
    case = {
        "spring": {"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 6.0, "pitch": 10.0},
        "material": "creeping",
        "loading": [{"to": {"travel": 1}}],
    }
    (tmp_path / "spring.yaml").write_text(yaml.safe_dump(case))
    (tmp_path / "losses.csv").write_text("temperature,force,loss\n353.15,471,1.1\n393.15,471,6.5\n393.15,589,14\n")
    arguments = ["creep", "creeping", str(tmp_path / "losses.csv"), str(tmp_path / "spring.yaml"), "--points"]
    arguments += ["--time-exponent", "0.2", "--name", "mine", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    assert "as many readings as constants; the intervals are those of an error of 0.5 % of the load" in done.output
    known = library.load(tmp_path / "mine.yaml").data.creep.tests
    shear = np.array([471.0, 589.0]) * 8.0 * 32.0 / (np.pi * 4.0**3)
    assert known.stress == pytest.approx(np.sqrt(3.0) * shear, rel=1e-4)
    assert known.hours == (48.0, 48.0)
    done = CliRunner().invoke(app, [*arguments[:3], *arguments[4:], "--overwrite"])
    assert "its case file must follow" in str(done.exception)


def test_constants_that_the_tests_do_not_determine_are_marked(tmp_path):
    """A single reading far off drives p against its bound and leaves all intervals wide."""
    law = library.load("creeping")
    tests = readings("torsion", (450.0, 600.0), (353.0, 373.0), (1.0, 10.0, 100.0))
    clean = exact(law, tests)
    almost = replace(clean, loss=clean.loss * (1.0 + 1e-3 * np.arange(12)))
    assert creep_fit.fit_creep(law, (almost,)).undetermined == ()
    lost = np.array([0.7, 1.1, 1.9, 1.2, 2.1, 3.4, 1.2, 2.0, 3.4, 2.2, 0.0, 6.1])
    write(tmp_path / "tests.csv", replace(clean, loss=lost))
    arguments = ["creep", "creeping", str(tmp_path / "tests.csv"), "--name", "mine", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    marked = [line.split()[0] for line in done.output.splitlines() if "not determined" in line]
    assert marked == ["strain", "exponent", "time_exponent", "activation_energy"]


def test_tests_that_cannot_tell():
    with pytest.raises(InputError, match="two temperatures: Q is unknown otherwise"):
        creep_fit.fit_creep(library.load("creeping"), (readings(temperatures=(353.15,)),))
