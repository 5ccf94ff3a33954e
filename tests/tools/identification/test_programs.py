"""Programs for one point: the shipped ones against the rate equations, stress and mixed control, wrong files."""

import csv
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.material import library
from coilset.model.tools.identification import programs
from coilset.scripts.commands.material import app
from coilset.verification.references import heun

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "material"
PATHS = {  # the strains of the shipped programs, without spin: torsion then leaves the length as it is
    "tension": [(0.15, 0, 0)],
    "torsion_reversal": [(0, 0.10, 0), (0, -0.15, 0)],
    "tension_torsion": [(0.05, 0, 0), (0, 0.08, 0)],
    "torsion_tension": [(0, 0.08, 0), (0.05, 0, 0)],
}


def program(*steps, **more):
    steps = [{"to": to, "increments": increments} for to, increments in steps]
    return programs.Program.model_validate({"name": "test", "steps": steps} | more)


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_shipped_programs(name, integrator, reference):
    """Stress at the end of each step; the return mapping with the programs' increments is within 1.5 %, Heun 0.01 %."""
    history = heun.RUNS[integrator](library.load("ck15", spin=False), programs.read(EXAMPLES / f"{name}.yaml"))
    material = reference.ck15()
    exact = reference.Reference(material).path(PATHS[name])
    for step, y in enumerate(exact):
        row = np.flatnonzero(history.step == step)[-1]
        flow = np.sqrt(1.5 * material.k2(y[12]))
        off = np.abs(history.stress[row] - y[[0, 3, 4]]).max() / flow
        assert off < (1.5e-2 if integrator == "return_mapping" else 1e-4)


@pytest.mark.parametrize("integrator", heun.UPDATES)
def test_release_is_elastic(integrator):
    """The last step of the tension program: σ11 back to zero along E, which leaves the plastic strain."""
    law = library.load("ck15")
    history = heun.RUNS[integrator](law, programs.read(EXAMPLES / "tension.yaml"))
    top = np.flatnonzero(history.step == 0)[-1]
    assert history.stress[-1, 0] == pytest.approx(0, abs=1e-4)
    assert history.strain[-1, 0] == pytest.approx(0.15 - history.stress[top, 0] / law.E, rel=1e-7)


@pytest.mark.parametrize("integrator", heun.UPDATES)
@pytest.mark.parametrize("form", ["rod", "solid"])
def test_release_from_flow_without_hardening(integrator, form):
    """The last tangent is singular there: no strain changes a stress that flows."""
    law = library.load("ideal_plastic")
    history = heun.RUNS[integrator](law, program(({"eps11": 0.02}, 20), ({"sigma11": 0}, 4), form=form))
    assert history.stress[-1, 0] == pytest.approx(0.0, abs=1e-4)
    assert history.strain[-1, 0] == pytest.approx(0.02 - law.yield_stress / law.E, rel=1e-6)


def test_stress_control_of_linear_hardening():
    """To σ = 500: ε = 500/E + (500 − 400)/2000; then τ12 = 100 with σ held raises the equivalent stress alike."""
    law = library.load("linear_isotropic", spin=False)
    history = programs.run(law, program(({"sigma11": 500}, 20), ({"tau12": 100}, 50)))
    first = np.flatnonzero(history.step == 0)[-1]
    assert history.strain[first, 0] == pytest.approx(500 / law.E + 100 / 2000, rel=1e-6)
    assert history.stress[-1] == pytest.approx([500, 100, 0], abs=1e-6)
    flow = np.sqrt(500**2 + 3 * 100**2)
    work = (flow**2 - 400**2) / (2 * 2000)  # ∫σ dεp of linear hardening
    assert history.work[-1] == pytest.approx(work, rel=1e-6)


def test_full_form_is_the_rod_in_tension():
    """Uniaxial stress in the full form: lateral stresses stay zero, σ11 as in the rod, ε22 = −νε_el − ½ε_pl."""
    law = library.load("ck15")
    steps = [({"eps11": 0.03}, 60), ({"sigma11": 0}, 5)]
    rod, full = (programs.run(law, program(*steps, form=form)) for form in ("rod", "solid"))
    np.testing.assert_allclose(full.stress[:, 0], rod.stress[:, 0], atol=1e-6)
    np.testing.assert_allclose(full.stress[:, 1:], 0, atol=1e-6)
    elastic = full.stress[:, 0] / law.E
    lateral = -law.nu * elastic - 0.5 * (full.strain[:, 0] - elastic)
    np.testing.assert_allclose(full.strain[:, 1], lateral, atol=1e-9)


def test_mixed_control():
    """Twist driven by strain under a constant tensile stress: the stress stays, the length creeps on."""
    law = library.load("ck15")
    history = programs.run(law, program(({"sigma11": 150}, 5), ({"gamma12": 0.05}, 100)))
    np.testing.assert_allclose(history.stress[6:, 0], 150, atol=1e-6)
    assert history.strain[-1, 1] == 0.05
    assert history.strain[-1, 0] > 0.005


def test_a_stress_that_cannot_be_carried():
    with pytest.raises(SolveError, match=r"step 1 of the program \(unnamed\), increment 9: no strain was found"):
        programs.run(library.load("ideal_plastic"), program(({"sigma11": 500}, 10)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            {"steps": [{"to": {"eps12": 1}, "increments": 1}]},
            "steps.0.to: 'eps12' is none of eps11, gamma12, gamma13, ",
        ),
        (
            {"steps": [{"to": {"eps11": 1, "sigma11": 2}, "increments": 1}]},
            "steps.0.to: eps11 and sigma11 cannot both be prescribed",
        ),
        (
            {"steps": [{"to": {"eps11": 1}, "increments": 0}]},
            "steps.0.increments: 0: must be greater than or equal to 1",
        ),
        (
            {"steps": [{"to": {"eps11": 1}}]},
            "steps.0.increments: this entry is required; give the number of equal increments",
        ),
        (
            {"steps": [], "speed": 3},
            "speed: unknown entry; the entries here are name, description, source, form, temperature, steps",
        ),
        ({"steps": []}, "steps: "),
    ],
)
def test_wrong_programs(content, message, tmp_path):
    path = tmp_path / "program.yaml"
    path.write_text(yaml.safe_dump({"name": "wrong"} | content), encoding="utf-8")
    with pytest.raises(InputError) as error:
        programs.read(path)
    assert str(error.value).startswith(f"{path}: {message}")
    assert "\n" not in str(error.value)


def test_the_command_draws_and_keeps(tmp_path, monkeypatch):
    """CSV and picture are written once; a second run needs --overwrite; a temperature outside the table is refused."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        return CliRunner().invoke(app, ["test", "ck15", *arguments])

    done = run(str(EXAMPLES / "tension_torsion.yaml"), "--out", "out")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "out" / "tension_torsion.png").stat().st_size > 10_000
    rows = list(csv.DictReader((tmp_path / "out" / "tension_torsion.csv").read_text().splitlines()))
    assert float(rows[-1]["gamma12"]) == 0.08
    assert float(rows[-1]["sigma11"]) < 30 < 200 < float(rows[-1]["tau12"])
    again = run(str(EXAMPLES / "tension_torsion.yaml"), "--out", "out").exception
    assert isinstance(again, InputError)
    assert again.exit_code == 2
    (tmp_path / "hot.yaml").write_text("{name: hot, steps: [{temperature: 400, increments: 5}]}")
    expected = "hot.yaml: steps.0.temperature: 400 K is outside the table of 'ck15', known only for 293.15 K"
    assert str(run("hot.yaml").exception) == expected
