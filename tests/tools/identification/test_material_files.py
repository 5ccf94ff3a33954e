"""Material and program files are read as case files are: no entry twice, no word as a number, no bomb."""

import re

import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.tools.identification import programs

CK15 = (library.FOLDER / "ck15.yaml").read_text(encoding="utf-8")
PROGRAM = "name: pull\nsteps:\n  - {to: {eps11: 0.01}, increments: 3}\n"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name: ck15\n", "name: ck15\nname: other\n", "the entry 'name' is given twice"),
        ("{G: 84000,", "{G: 84000, G: 60000,", "the entry 'G' is given twice"),
        ("G: 84000", "G: '84000'", "temperatures.0.elasticity.G: '84000': must be a number"),
        ("G: 84000", "G: yes", "temperatures.0.elasticity.G: 'yes': must be a number"),
        ("G: 84000", "G: true", "temperatures.0.elasticity.G: True: must be a number"),
        ("kinematic: {a5: 7.3,", "kinematic: [{a5: 7.3}]  #", "0.kinematic: [{'a5': 7.3}]: must be a group"),
        ("non_normality: {a: 0.0005}", "non_normality: no", "'no': must be 'none', or a group of constants"),
        ("units: N, mm, K", "units: " + "m" * 5000, "units: 'mmm"),
        ("{a5: 7.3,", "{a5: 1e308,", "temperatures.0: its functions overflow at 293.15 K; are the units N and mm?"),
    ],
)
def test_material_files(old, new, message, tmp_path):
    assert old in CK15
    path = tmp_path / "wrong.yaml"
    path.write_text(CK15.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as error:
        library.load(path)
    assert message in str(error.value)
    assert str(error.value).startswith(f"{path}: ")
    assert len(str(error.value)) < 300


CHABOCHE, CREEPING, LINEAR = (
    (library.FOLDER / f"{name}.yaml").read_text(encoding="utf-8")
    for name in ("chaboche", "creeping", "linear_isotropic")
)
CURVE = "isotropic: {law: table, strains: plastic, strain: [0, 0.01, 0.02], stress: [300, 400, 450]}"
TABLE = re.sub("isotropic: {.*}", CURVE, LINEAR)
HOT = "tests: {temperature: [290, 400], stress: [3e8, 8e8], hours: [1, 10]}"


@pytest.mark.parametrize(
    ("text", "old", "new", "place", "message"),
    [
        (CK15, "G: 84000", "G: 8.4e10", "elasticity.G", "the shear modulus is 8.4e+10 N/mm², above 6e+05 N/mm²"),
        (CK15, "G: 84000", "G: 84", "elasticity.G", "the shear modulus is 84 N/mm², below 500 N/mm², as in GPa"),
        (LINEAR, "k0_squared: 106666.6667", "k0_squared: 1e17", "isotropic", "the greatest yield stress is "),
        (CK15, "a5: 7.3", "a5: 7.3e6", "kinematic", "the slope of a back stress is "),
        # of a table in Pa the plastic work for which it is valid ends where flow begins
        (TABLE, "[300, 400, 450]", "[300e6, 400e6, 450e6]", "isotropic", "the greatest yield stress is 3e+08 N/mm²"),
        (TABLE, "[300, 400, 450]", "[0.3, 0.4, 0.45]", "isotropic", "the greatest yield stress is 0.45 N/mm², below 8"),
        (CHABOCHE, "yield_stress: 400", "yield_stress: 4e8", "isotropic", "the greatest yield stress is 4e+08 N/mm²"),
        (CHABOCHE, "C: 22500,", "C: 2.25e10,", "kinematic.terms.1.C", "the slope of a back stress is 2.25e+10 N/mm²"),
        (CREEPING, "stress: 800", "stress: 8e8", "creep.stress", "the reference stress is 8e+08 N/mm², above 7.9e+04"),
        (CREEPING, "name: c", "tensile_strength: 1.8\nname: c", "tensile_strength", "the strength is 1.8 N/mm², below"),
        (CREEPING, "form:", f"{HOT}\n  form:", "creep.tests.stress", "the greatest stress is 8e+08 N/mm², above"),
    ],
)
def test_stresses_in_other_units_are_refused(text, old, new, place, message, tmp_path):
    """G in Pa alone gave 2.9 MN/mm from a wire of 2 mm, with exit code 0."""
    assert old in text
    path = tmp_path / "wrong.yaml"
    path.write_text(text, encoding="utf-8")
    library.load(path)
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as error:
        library.load(path)
    assert f"{place}: {message}" in str(error.value)
    assert str(error.value).startswith(f"{path}: ")
    assert str(error.value).endswith("; give all stresses in N/mm² = MPa")


@pytest.mark.parametrize("G", [1000, 30000, 161000])
def test_plastics_and_metals_are_solids(G, tmp_path):
    """The elasticity of a plastic, of tungsten, and the softest of metals as it hardens: pure aluminium."""
    path = tmp_path / "own.yaml"
    stresses = [2e-4 * G, 3e-4 * G, 4e-4 * G]
    path.write_text(re.sub("G: [0-9.]+", f"G: {G}", TABLE).replace("[300, 400, 450]", str(stresses)), encoding="utf-8")
    assert library.load(path).G == G


def test_numbers_with_an_exponent_are_numbers(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(CK15.replace("k0_squared: 22480", "k0_squared: 2248e1").replace("a: 0.0005", "a: 5e-4"))
    assert (library.load(path).parameters() == library.load("ck15").parameters()).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (PROGRAM + "name: twice\n", "the entry 'name' is given twice"),
        (PROGRAM.replace("0.01}", "0.01, eps11: 0.02}"), "the entry 'eps11' is given twice"),
        (PROGRAM.replace("0.01", "true"), "steps.0.to.eps11: True: must be a number"),
        (PROGRAM.replace("increments: 3", "increments: yes"), "steps.0.increments: 'yes': must be a whole number"),
        (PROGRAM.replace("increments", "increment"), "steps.0.increment: unknown entry; is increments meant?"),
        ("- 1", "a program file holds the entries name: and steps:"),
        ("", "a program file holds the entries name: and steps:"),
    ],
)
def test_program_files(text, message, tmp_path):
    path = tmp_path / "program.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        programs.read(path)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
