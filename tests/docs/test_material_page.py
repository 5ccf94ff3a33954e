"""The examples of docs/material.md run as they stand."""

import re
from pathlib import Path

import numpy as np
import pytest

from coilset.model.core.material import library
from coilset.model.tools.identification import programs
from coilset.verification.references import heun

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "material.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


def test_python_example(capsys):
    """1000 equal points; the printed flow stress is that of the stress reached, back stress apart."""
    (code,) = blocks("python")
    names = {}
    exec(compile(code, "docs/material.md", "exec"), names)
    assert capsys.readouterr().out
    state, k2 = names["state"], names["k2"]
    assert (state == state[0]).all()
    n = [state[0, 0] / 1.5 - state[0, 3], *(state[0, 1:3] - state[0, 4:6])]
    assert 1.5 * n[0] ** 2 + 2 * (n[1] ** 2 + n[2] ** 2) == pytest.approx(k2[0])
    assert (names["iterations"] > 0).all()


def test_yaml_examples(tmp_path):
    """The annotated material file is a material, the program a program, and the one goes through the other."""
    material, program = blocks("yaml")
    (tmp_path / "my_steel.yaml").write_text(material, encoding="utf-8")
    (tmp_path / "program.yaml").write_text(program, encoding="utf-8")
    law = library.load(tmp_path / "my_steel.yaml")
    assert law.temperatures == (293.15, 473.15)
    assert law.yield_stress == pytest.approx(300)
    history = programs.run(law, programs.read(tmp_path / "program.yaml"))
    np.testing.assert_allclose(history.stress[-1], 0, atol=1e-6)
    rise = 0.9 / (7.85e-9 * 4.7e8) * history.work[-1]
    assert history.temperature[-1] == pytest.approx(293.15 + rise, rel=1e-9)
    assert set(library.names()) == set(re.findall(r"^\| `(\w+)` \|", TEXT, re.MULTILINE)) - {"return_mapping"}
    assert tuple(heun.UPDATES) == ("return_mapping", "heun")


def test_every_law_of_a_curve_is_one(tmp_path):
    """The lines `isotropic: {law: ...}`, each in the annotated material file."""
    material, lines = blocks("yaml")[0], re.findall(r"^    isotropic: (\{law:.*?\})", TEXT, re.MULTILINE)
    (tmp_path / "tension.csv").write_text("strain,stress\n0,0\n0.004,800\n0.01,900\n0.1,1000\n", encoding="utf-8")
    assert len(lines) == 5
    for number, line in enumerate(lines):
        text = re.sub(r"isotropic: \{k0_squared: 45000.*?\}", f"isotropic: {line}", material)
        assert text != material
        path = tmp_path / f"steel_{number}.yaml"
        path.write_text(text, encoding="utf-8")
        assert library.load(path).functions(10.0, 473.15)[1] > 0
