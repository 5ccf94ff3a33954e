"""Back stresses from cyclic tests: those of a law come back, and what the tests do not determine is reported."""

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.model.tools.identification import cyclic, programs
from coilset.model.tools.identification.experiments import Test
from coilset.scripts.commands.material import app

G, NU = 80000.0, 0.3
TRUE = {"yield_stress": 500.0, "C_1": 150000.0, "gamma_1": 600.0, "C_2": 10000.0, "gamma_2": 50.0}
FILE = {
    "name": "two",
    "description": "two back stresses",
    "source": "made up",
    "units": "N, mm, K",
    "validity": {"plastic_work": 300, "remark": "a test"},
    "temperatures": [
        {
            "temperature": 293.15,
            "elasticity": {"G": G, "nu": NU},
            "isotropic": {"k0_squared": 2 / 3 * TRUE["yield_stress"] ** 2},
            "kinematic": {
                "law": "chaboche",
                "terms": [{"C": TRUE[f"C_{i}"], "gamma": TRUE[f"gamma_{i}"]} for i in (1, 2)],
            },
            "non_normality": "none",
        }
    ],
}


@pytest.fixture(scope="module")
def law(tmp_path_factory):
    path = tmp_path_factory.mktemp("material") / "two.yaml"
    path.write_text(yaml.safe_dump(FILE), encoding="utf-8")
    return library.load(path)


def driven(law, targets, component="eps11", increments=60):
    """A test by the law's own integration in time, which is not that of the fit."""
    steps = [programs.Step(name="", to={component: to}, increments=increments) for to in targets]
    history = programs.run(law, programs.Program(name=component, steps=tuple(steps)))
    return Test(component, history.strain[1:, :2], history.stress[1:, :2])


@pytest.fixture(scope="module")
def tension(law):
    return driven(law, [0.015, -0.015, 0.03])


@pytest.fixture(scope="module")
def found(tension):
    return cyclic.fit_back_stresses([tension], G, NU, 2)


def test_one_direction_is_followed_exactly(law, tension):
    """The law's own integration in 180 increments, and in one increment a piece the same as in many."""
    path = tension.strain[:, 0]
    size, back = np.array([500.0, 0.0, 1.0]), np.array([[250.0, 600.0], [200.0, 50.0]])
    stress, few = np.empty_like(path), np.empty(3)
    cyclic.follow(law.E, size, back, path, stress)
    np.testing.assert_allclose(stress, tension.stress[:, 0], atol=0.3)  # of 900 N/mm²
    cyclic.follow(law.E, size, back, path[59::60], few)
    np.testing.assert_allclose(few, stress[59::60], rtol=1e-12)


def test_the_constants_come_back(found):
    """From a test without scatter: they differ by what the law's integration in time leaves, 1e-3 of them."""
    assert list(found.constants) == list(TRUE)  # without a rise of the yield stress: there is none
    assert found.constants == pytest.approx(TRUE, rel=3e-3)
    assert found.enough == 2
    assert found.doubtful == ()
    assert found.scatter[0] < 0.1


def test_torsion_gives_the_same(law):
    test = driven(law, [0.025, -0.025, 0.05], "gamma12")
    found = cyclic.fit_back_stresses([test], G, NU, 2)
    assert found.constants == pytest.approx(TRUE, rel=3e-3)


def test_the_material_file_is_the_law(found, law, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(found.material("mine")), encoding="utf-8")
    ours, stress = library.load(path), []
    for one in (ours, law):
        state = points.initial_state(one, 1)
        for strain in (*[5e-4] * 20, *[-5e-4] * 30):
            state, _, _ = points.update(one, state, np.array([[strain, 0, 0]]))
        stress.append(state[0, 0])
    assert stress[0] == pytest.approx(stress[1], rel=2e-3)


def test_scatter_is_inside_the_uncertainty_and_an_idle_back_stress_is_told(tension):
    """One per cent of the maximum stress as scatter; a third back stress is one too many."""
    rng = np.random.default_rng(3)
    stress = tension.stress + 0.01 * np.abs(tension.stress).max() * rng.normal(size=tension.stress.shape) * [1, 0]
    test = Test("noisy", tension.strain, stress)
    two = cyclic.fit_back_stresses([test], G, NU, 2)
    for name, true in TRUE.items():
        assert abs(two.constants[name] - true) < two.uncertainty[name], name
    three = cyclic.fit_back_stresses([test], G, NU, 3)
    assert three.enough == 2
    assert three.doubtful
    assert three.material("three")["validity"]["undetermined"] == list(three.doubtful)


def test_tests_that_do_not_tell_back_stresses_are_refused(law, tension):
    one_way = driven(law, [0.03])
    with pytest.raises(InputError, match="no test flows in both directions"):
        cyclic.fit_back_stresses([one_way], G, NU, 1)
    both = Test("both", tension.strain, tension.stress + np.array([0.0, 300.0]))
    with pytest.raises(InputError, match="both: is a test of both tension and torsion"):
        cyclic.fit_back_stresses([both], G, NU, 1)
    with pytest.raises(InputError, match="5 is not possible; give 1 to 4"):
        cyclic.fit_back_stresses([tension], G, NU, 5)


def test_the_command(tension, found, tmp_path, monkeypatch):
    """`coilset material fit --back-stresses`, with the fit itself taken from above."""
    monkeypatch.setattr(cyclic, "fit_back_stresses", lambda *_: found)
    rows = np.hstack([tension.strain[:, :1], tension.stress[:, :1]])
    lines = [f"{strain:.9g},{stress:.9g}" for strain, stress in rows]
    (tmp_path / "cycles.csv").write_text("\n".join(["strain,stress", *lines]) + "\n", encoding="utf-8")
    arguments = [
        "fit",
        str(tmp_path / "cycles.csv"),
        "--G",
        str(G),
        "--nu",
        str(NU),
        "--back-stresses",
        "2",
        "--name",
        "mine",
        "--out",
        str(tmp_path),
    ]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 0, done.output
    assert "gamma_2" in done.output
    assert library.load(tmp_path / "mine.yaml").n_terms == 2
