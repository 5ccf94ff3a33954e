"""Identification of the constants from the shipped synthetic tests (1 % noise), and from wrong data."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from coilset.model.errors import InputError
from coilset.model.material import library, points
from coilset.model.material.identification import experiments, fit
from coilset.scripts.material import app
from coilset.verification.cases import material_fit

DATA = Path(__file__).resolve().parents[2] / "examples" / "material" / "fit"
LIMITS = {"k0_squared": 0.04, "a1": 0.06, "a3": 0.08, "k_inf_squared": 0.12, "a5": 0.12, "a7": 0.4, "a": 0.02}


@pytest.fixture(scope="module")
def shipped():
    return [experiments.read_test(DATA / f"{name}.csv") for name in material_fit.PROGRAMS]


@pytest.fixture(scope="module")
def fitted(shipped):
    return fit.fit(shipped, 84000, 0.28989)


def test_shipped_tests_are_what_they_say(shipped):
    """The files hold the law's answer with the noise of seed 1, to the digits they are written with."""
    for test, again in zip(shipped, material_fit.noisy(material_fit.clean_tests(), 1), strict=True):
        assert test.name == again.name
        np.testing.assert_allclose(test.strain, again.strain, rtol=1e-5, atol=1e-7)
        np.testing.assert_allclose(test.stress, again.stress, rtol=1e-4, atol=2e-3)
    assert [test.kind for test in shipped] == ["tension", "torsion", "combined", "combined"]


def test_constants_of_ck15_come_back(fitted):
    """Each constant of the thesis lies within the stated uncertainty, and that is not wide where the tests tell."""
    for name, true in material_fit.true_constants().items():
        if name in fitted.constants:
            assert abs(fitted.constants[name] - true) < fitted.uncertainty[name], name
            assert 0 < fitted.standard[name] < fitted.uncertainty[name] / 2.8
    assert set(fitted.constants) == set(material_fit.true_constants()) - {"G", "nu", "alpha"}
    for name, limit in LIMITS.items():
        assert fitted.uncertainty[name] < limit * material_fit.true_constants()[name], name


def test_residual_is_the_noise(fitted, shipped):
    """The law fitted to noise of 1 % leaves this noise; the 12 constants take next to nothing from 3000 readings."""
    for test, scatter in zip(shipped, fitted.scatter, strict=True):
        assert scatter == pytest.approx(0.01 * np.abs(test.stress).max(), rel=0.08)


def test_fitted_material_file_is_a_material(fitted, tmp_path):
    """Written, read again, it answers tension to 10 % as Ck 15 does within 0.5 %."""
    path = tmp_path / "fitted.yaml"
    path.write_text(yaml.safe_dump(fitted.material("fitted")), encoding="utf-8")
    stress = []
    for law in (library.load(path), library.load("ck15")):
        state = points.initial_state(law, 1)
        for _ in range(100):
            state, _, _ = points.update(law, state, np.array([[1e-3, 0, 0]]))
        stress.append(state[0, 0])
    assert stress[0] == pytest.approx(stress[1], rel=5e-3)


@pytest.mark.parametrize(("gone", "kind"), [("tension", "tension"), ("reversed_torsion", "torsion")])
def test_a_missing_kind_of_test_is_named(shipped, gone, kind):
    with pytest.raises(InputError, match=f"there is no {kind} test"):
        fit.fit([test for test in shipped if test.name != gone], 84000, 0.28989)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: text.replace("tau12", "tau", 1), "column tau12: is missing"),
        (lambda text: text.replace("23.66,", "often,"), "line 4, column sigma11: 'often' is no number"),
        (lambda text: "\n".join(text.splitlines()[:10]), "has 7 rows; a test needs at least 20"),
    ],
)
def test_wrong_data_files(change, message, tmp_path):
    path = tmp_path / "wrong.csv"
    path.write_text(change((DATA / "tension.csv").read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(InputError) as error:
        experiments.read_test(path)
    assert str(error.value) == f"{path}: {message}" or str(error.value).startswith(f"{path}: {message};")


def test_the_command_reports_and_writes(fitted, tmp_path, monkeypatch):
    """`coilset material fit` with the fit itself taken from above: table, residuals, material file and picture."""
    monkeypatch.setattr(fit, "fit", lambda *_: fitted)
    data = [str(path) for path in sorted(DATA.glob("*.csv"))]
    arguments = ["fit", *data, "--G", "84000", "--nu", "0.28989", "--name", "mine", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    for name, value in fitted.constants.items():
        assert f"{name} " in done.output
        assert f"{value:.6g}" in done.output
    assert "tension_torsion (combined): rms residual" in done.output
    assert library.load(tmp_path / "mine.yaml").G == 84000
    assert (tmp_path / "fit.png").stat().st_size > 50_000
    again = CliRunner().invoke(app, arguments)
    assert isinstance(again.exception, InputError)
