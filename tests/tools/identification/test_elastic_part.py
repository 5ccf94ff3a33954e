"""The slope and the start of tests beside the elastic constants: refused with the number, or corrected on request.

The wire is made up: E = 206,032 N/mm² (G = 81,500, nu = 0.264), plastic strain 0.002 (σ/1450)^14, 0.1 % of scatter.
"""

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from coilset.model.core.base.errors import InputError
from coilset.model.tools.identification import cyclic, fit
from coilset.model.tools.identification.elastic_part import check_elastic, corrected, elastic_part
from coilset.model.tools.identification.experiments import Test
from coilset.scripts.commands.material import app
from coilset.verification.cases.law import material_fit

G, NU = 81500.0, 0.264
E = 2.0 * G * (1.0 + NU)
STRESS = np.r_[np.linspace(40, 1200, 30), np.linspace(1220, 1690, 40)]
READ = STRESS * (1 + 0.001 * np.random.default_rng(1).standard_normal(len(STRESS)))
TOE = 0.001 * -np.expm1(-STRESS / 100.0)


def measured(soft=1.0, offset=0.0, sense=1.0):
    """A tension test whose elastic strain is `soft` times as large, after an `offset`."""
    strain = STRESS / E * soft + 0.002 * (STRESS / 1450) ** 14 + offset
    return Test("wire", sense * np.column_stack([strain, 0 * STRESS]), sense * np.column_stack([READ, 0 * STRESS]))


def yield_stress(test):
    return np.sqrt(1.5 * fit.fit([test], G, NU).constants["k0_squared"])


def test_small_deviations_move_the_yield_stress_by_little():
    """What is allowed: 2 % of the slope and a strain of 1e-4 together with what scatter may be."""
    right = yield_stress(measured())
    assert right == pytest.approx(1204.0, rel=2e-3)
    for test in (measured(1.019), measured(offset=9e-5), measured(offset=-9e-5)):
        assert yield_stress(test) == pytest.approx(right, rel=0.04)


@pytest.mark.parametrize(("soft", "share"), [(1.05, "4.9 % below"), (1.35, "26 % below"), (0.9, "11 % above")])
def test_another_slope_is_refused_with_its_size(soft, share):
    """The first two, as engineering readings, gave yield stresses of 966 and 2.1 N/mm² without a word."""
    with pytest.raises(InputError) as error:
        fit.fit([measured(soft)], G, NU)
    said = str(error.value)
    assert said.startswith("wire: where it is straight, between ")
    assert f"{share} 2 G (1 + nu) = 206032 and more than the 2 %" in said
    assert ("--tester compliance" in said) == (soft > 1.0)
    assert "\n" not in said


@pytest.mark.parametrize("slack", [0.001, TOE, -0.001], ids=["slack", "toe", "zero under load"])
def test_slack_is_refused_with_its_size(slack):
    with pytest.raises(InputError, match=r"wire: its straight part begins at a strain of -?0\.0009\d|0\.001") as error:
        fit.fit([measured(offset=slack)], G, NU)
    assert "give --tester offset" in str(error.value)


@pytest.mark.parametrize(
    ("test", "found"),
    [
        (measured(1.05), {"compliance": 0.05 / E}),
        (measured(1.35), {"compliance": 0.35 / E}),
        (measured(offset=0.001), {"offset": 0.001}),
        (measured(offset=TOE), {"offset": 0.001}),
        (measured(1.1, TOE), {"compliance": 0.1 / E, "offset": 0.001}),
    ],
    ids=["5 % soft", "35 % soft", "slack", "toe", "both"],
)
def test_what_the_tester_adds_is_taken_off_on_request(test, found):
    """The yield stress of the test without it comes back; of a toe that fades as exp(-σ/100) up to 4e-5 are left."""
    better = corrected(test, G, NU, {}, list(found))
    for name, limit in (("compliance", 0.01 / E), ("offset", 5e-5)):
        assert better.tester.get(name, 0.0) == pytest.approx(found.get(name, 0.0), abs=limit)
    assert yield_stress(better) == pytest.approx(1204.0, rel=0.02)
    assert yield_stress(corrected(test, G, NU, found)) == pytest.approx(1204.0, rel=0.02)


def test_what_is_given_is_not_questioned():
    soft = corrected(measured(1.1), G, NU, {"compliance": 0.0})
    check_elastic(soft, G, NU)
    with pytest.raises(InputError, match="begins at a strain"):
        check_elastic(corrected(measured(1.1, 0.001), G, NU, {"compliance": 0.0}), G, NU)


def test_compression_is_judged_as_tension():
    assert elastic_part(measured(sense=-1.0), (E, G)).slope == elastic_part(measured(), (E, G)).slope
    with pytest.raises(InputError, match="begins at a strain of -0\\.000999"):
        check_elastic(measured(offset=0.001, sense=-1.0), G, NU)


def test_torsion_and_cycles_are_judged_by_their_first_loading():
    """A turned wire that flows at 800 N/mm² and hardens, turned back: back stresses are refused just so."""
    forth = np.linspace(0.0, 0.03, 61)[1:]
    back = np.linspace(0.03, -0.02, 101)[1:]
    shear = np.concatenate([np.minimum(G * forth, 760 + 4000 * forth), np.maximum(880 - G * (0.03 - back), -1000)])
    for soft in (1.0, 1.08):
        gamma = np.concatenate([forth, back]) + (soft - 1.0) * shear / G
        test = Test("turned", np.column_stack([0 * gamma, gamma]), np.column_stack([0 * shear, shear]))
        assert elastic_part(test, (E, G)).slope == pytest.approx(G / soft, rel=1e-3)
        if soft > 1.0:
            with pytest.raises(InputError, match=r"turned: where .* 7\.4 % below G = 81500"):
                cyclic.fit_back_stresses([test], G, NU, 1)
        else:
            check_elastic(test, G, NU)


@pytest.mark.parametrize("seed", range(5))
def test_scatter_of_one_per_cent_is_not_refused(seed):
    """Some eight elastic readings in each, with 1 % of the maximum stress as scatter; of 200 seeds none was."""
    for test in material_fit.noisy(material_fit.clean_tests(), seed):
        check_elastic(test, 84000, 0.28989)


def test_few_elastic_readings_are_enough():
    """A curve read off a diagram: three of its readings are elastic, or the first one is about to yield."""
    plastic = np.geomspace(1e-3, 0.05, 22)
    flowing = 1200 + 400 * (1 - np.exp(-plastic / 0.01))
    for elastic in ([0.0, 400.0, 800.0], [1200.0]):
        stress = np.concatenate([elastic, flowing])
        strain = stress / E + np.concatenate([0 * np.array(elastic), plastic])
        check_elastic(Test("read", np.column_stack([strain, 0 * strain]), np.column_stack([stress, 0 * stress])), G, NU)


def test_the_command_corrects_and_records_it(tmp_path):
    """Engineering readings with slack and a soft machine; compression by its sign."""
    strain = 1.05 * STRESS / 206000 + 0.002 * (STRESS / 1450) ** 14 + 0.001
    for sign, name in ((1, "pulled"), (-1, "pressed")):
        rows = "".join(f"{sign * e:.7f},{sign * s:.3f}\n" for e, s in zip(strain, READ, strict=True))
        (tmp_path / f"{name}.csv").write_text("strain,stress\n" + rows, encoding="utf-8")
    arguments = ["fit", str(tmp_path / "pulled.csv"), "--G", "81500", "--nu", "0.264", "--engineering"]
    arguments += ["--out", str(tmp_path / "out")]
    done = CliRunner().invoke(app, arguments)
    assert isinstance(done.exception, InputError)
    assert not Path(tmp_path / "out").exists()
    done = CliRunner().invoke(app, [*arguments, "--tester", "compliance", "--tester", "offset"])
    assert done.exit_code == 0, done.output
    assert "pulled: compliance 2.5" in done.output
    written = yaml.safe_load((tmp_path / "out" / "fitted.yaml").read_text(encoding="utf-8"))
    assert "offset 0.000998 taken off the strain" in written["validity"]["remark"]
    k0 = written["temperatures"][0]["isotropic"]["k0_squared"]
    assert np.sqrt(1.5 * k0) == pytest.approx(1231.0, rel=0.01)  # of the curve without both
    arguments[1] = str(tmp_path / "pressed.csv")
    pressed = CliRunner().invoke(app, [*arguments, "--overwrite"])
    assert "its stresses are negative, down to -1690 N/mm², as in compression" in str(pressed.exception)


@pytest.mark.parametrize(
    ("known", "found", "message"),
    [
        ({"G": 1.0}, [], "--known: 'G' is none of compliance, offset"),
        ({}, ["slack"], "--tester: 'slack' is none of compliance, offset"),
    ],
)
def test_properties_that_no_tester_of_wire_has(known, found, message):
    with pytest.raises(InputError, match=message):
        corrected(measured(), G, NU, known, found)
