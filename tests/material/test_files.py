"""Material and program files are read as case files are: no entry twice, no word as a number, no bomb."""

import pytest

from coilset.model.base.errors import InputError
from coilset.model.material import library, programs

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
