"""The material library: generic laws against closed solutions, users' files, and one line for every wrong file."""

import subprocess
import sys

import numpy as np
import pytest
import yaml
from scipy.integrate import quad

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.verification.references import heun


def tension(law, strain, n):
    """σ11 by Heun's method."""
    state = points.initial_state(law, 1)
    for _ in range(n):
        state = heun.update(law, state, np.array([[strain / n, 0, 0]]), tolerance=1e-6)[0]
    return state[0, 0]


@pytest.mark.parametrize("name", library.names())
def test_every_material_says_what_it_is(name):
    law = library.load(name)
    assert law.name == name
    assert law.data.units == "N, mm, K"
    assert min(len(text) for text in (law.data.description, law.data.source, law.data.validity.remark)) > 10
    assert law.data.validity.plastic_work > 0
    state, _, count = points.update(law, points.initial_state(law, 1), np.array([[0.01, 0.01, 0]]))
    assert np.isfinite(state).all()
    assert (count[0] == 0) == (name == "elastic")


def test_ck15_has_the_thesiss_functions():
    """6.2.2 by hand: k² at b* = 0, on both branches and far out; ζ and 2Gκ at b* = 10."""
    law = library.load("ck15")
    assert law.functions(0)[0] == pytest.approx(22480)
    assert law.functions(50)[0] == pytest.approx(22480 + 86664 * (1 + 0.0049 * 50 - np.exp(-0.0574 * 50)))
    assert law.functions(120)[0] == pytest.approx(160000 - (160000 - 142238) * np.exp(-0.02675 * 40), rel=1e-5)
    k2, _, zeta, _, kappa, _ = law.functions(10)
    assert zeta == pytest.approx(7.3 * (0.0135 + 1.18 * np.exp(-11.8)) * np.sqrt(6 * k2))
    assert 2 * 84000 * kappa == pytest.approx(0.5)
    assert 2 * law.G * (1 + law.nu) == pytest.approx(216701.5, rel=1e-6)


def test_voce_in_tension():
    """εp = ∫ db*/σ with σ = sqrt(1.5 k²), k² from 106666.67 to 240000 N²/mm⁴ with 0.05 mm²/N; σ from 400 to 600."""

    def flow(b):
        return np.sqrt(1.5 * (240000 - (240000 - 106666.6667) * np.exp(-0.05 * b)))

    law = library.load("voce")
    for b in (2.0, 20.0, 80.0):
        strain = quad(lambda x: 1 / flow(x), 0, b, epsabs=0, epsrel=1e-12)[0] + flow(b) / law.E
        assert tension(law, strain, 20) == pytest.approx(flow(b), rel=1e-5)


def test_mixed_in_tension():
    """Y = 400 + 1000 εp, dB11 = ζ dεp with ζ = ⅚ sqrt(6 k²) = 5/3 Y, σ = Y + 3/2 B11 = 400 + 2000 εp + 1250 εp²."""
    law = library.load("mixed")
    for plastic in (0.002, 0.02, 0.1):
        stress = 400 + 2000 * plastic + 1250 * plastic**2
        assert tension(law, plastic + stress / law.E, 20) == pytest.approx(stress, rel=1e-5)


def test_users_own_file(tmp_path):
    """A copy with another yield stress, k0² = ⅔ 250², is a material like any other."""
    content = yaml.safe_load((library.FOLDER / "ideal_plastic.yaml").read_text(encoding="utf-8"))
    content["name"] = "soft"
    content["temperatures"][0]["isotropic"]["k0_squared"] = 2 / 3 * 250**2
    path = tmp_path / "soft.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    law = library.load(path)
    assert law.yield_stress == pytest.approx(250)
    assert tension(law, 0.02, 4) == pytest.approx(250)


def at(content):
    return content["temperatures"][0]


WRONG = {
    "missing function": (
        lambda c: at(c).pop("kinematic"),
        "temperatures.0.kinematic: this entry is required; give its constants, or 'none' if the material lacks this"
        " function; or several back stresses",
    ),
    "negative k0²": (
        lambda c: at(c)["isotropic"].update(k0_squared=-5),
        "temperatures.0.isotropic.k0_squared: -5: must be greater than 0",
    ),
    "negative k²": (
        lambda c: at(c).update(isotropic={"k0_squared": 22480, "a1": 86664, "a2": -0.05, "a3": 0.0574}),
        "temperatures.0.isotropic: k² = -209 N²/mm⁴ at b* = 18.2 N/mm² and 293.15 K; it must be positive"
        " (checked up to validity.plastic_work)",
    ),
    "not positive definite": (
        lambda c: at(c)["non_normality"].update(a=0.05),
        "temperatures.0.non_normality.a: κ k²′ = 2.024 at b* = 13.6 N/mm² and 293.15 K; it must stay below 2, or"
        " (3.1.9) is not positive definite (checked up to validity.plastic_work)",
    ),
    "unknown key": (
        lambda c: c.update(colour="red"),
        "colour: unknown entry; the entries here are name, description, source, units, validity, temperatures,"
        " tensile_strength, heating, creep, rate",
    ),
    "misspelt key": (
        lambda c: at(c)["isotropic"].update(k0_square=1),
        "temperatures.0.isotropic.k0_square: unknown entry; is k0_squared meant?",
    ),
    "decimal comma": (  # nu: 0,26 between braces
        lambda c: at(c).update(elasticity={"G": 81500, "nu": 0, 26: None}),
        "temperatures.0.elasticity.26: unknown entry; a comma begins the next entry: give nu with a decimal point,"
        " as in 0.5",
    ),
    "wrong type": (
        lambda c: at(c)["elasticity"].update(G="stiff"),
        "temperatures.0.elasticity.G: 'stiff': must be a number",
    ),
    "missing units": (
        lambda c: c.pop("units"),
        "units: this entry is required; give 'N, mm, K', the units of all numbers in the file",
    ),
    "other units": (
        lambda c: c.update(units="N, m, K"),
        "units: 'N, m, K': must be 'N, mm, K'",
    ),
    "missing source": (lambda c: c.pop("source"), "source: this entry is required; give where the constants come from"),
    "empty source": (
        lambda c: c.update(source=""),
        "source: '': must have at least 1 character",
    ),
    "jump of k²": (
        lambda c: at(c)["isotropic"]["saturation"].update(k1_squared=1e5),
        "temperatures.0.isotropic.saturation.k1_squared: 100000 N²/mm⁴, but the first branch ends at 142238;"
        " k² must not jump at b1",
    ),
    "temperatures not sorted": (
        lambda c: c.update(temperatures=[at(c) | {"temperature": 400}, at(c)]),
        "temperatures: [400.0, 293.15] K do not ascend; sort the entries, none twice",
    ),
    "heating without a table": (
        lambda c: c.update(heating={"dissipated": 0.9, "density": 7.85e-9, "specific_heat": 4.7e8}),
        "heating: plastic work warms the material; give its constants at two temperatures at least",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_files(name, tmp_path):
    change, message = WRONG[name]
    content = yaml.safe_load((library.FOLDER / "ck15.yaml").read_text(encoding="utf-8"))
    change(content)
    path = tmp_path / "wrong.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    with pytest.raises(InputError) as error:
        library.load(path)
    assert str(error.value) == f"{path}: {message}"
    assert error.value.exit_code == 2


def test_loss_of_positive_definiteness_between_two_temperatures(tmp_path):
    """κ falls and k²′ grows with T: at both ends of the table κ k²′ is 1 at b* = 10, half way it is 25."""
    content = yaml.safe_load((library.FOLDER / "linear_isotropic.yaml").read_text(encoding="utf-8"))
    content["validity"]["plastic_work"] = 10
    entries = []
    for temperature, slope, a in ((300, 10, 2e-4 * 80769), (500, 1000, 2e-6 * 80769)):
        isotropic = {"k0_squared": 1e5, "a1": 1, "a2": slope}
        entries.append(at(content) | {"temperature": temperature, "isotropic": isotropic, "non_normality": {"a": a}})
    for rows, fails in (([entries[0]], False), ([entries[1]], False), (entries, True)):
        path = tmp_path / "between.yaml"
        path.write_text(yaml.safe_dump(content | {"temperatures": rows}), encoding="utf-8")
        if fails:
            with pytest.raises(InputError, match=r"κ k²′ = .* and [34]\d\d K; it must stay below 2"):
                library.load(path)
        else:
            library.load(path)


def test_unknown_names_and_unreadable_files(tmp_path):
    with pytest.raises(
        InputError, match=r"'ck16' is neither a material of the library \(chaboche, .*elastic, .*\) nor a .yaml file"
    ):
        library.load("ck16")
    with pytest.raises(InputError, match=r"none\.yaml: the file cannot be read"):
        library.load(tmp_path / "none.yaml")
    (tmp_path / "list.yaml").write_text("- 1\n")
    with pytest.raises(InputError, match="is not a material file; it needs name, source, units"):
        library.load(tmp_path / "list.yaml")


def test_the_command_says_it_in_one_line(tmp_path):
    """Exit code 2, one line on stderr, nothing written."""
    (tmp_path / "wrong.yaml").write_text("name: x\n")
    command = [sys.executable, "-m", "coilset.scripts", "material", "show", "wrong.yaml"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    problem = "this entry is required; give a sentence that says what it is"
    assert done.stderr == f"coilset: wrong.yaml: description: {problem}\n"
    assert [path.name for path in tmp_path.iterdir()] == ["wrong.yaml"]
