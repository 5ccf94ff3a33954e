"""A material from a certificate: the three stresses come back in a tensile test, and what is wrong is one line."""

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.tools.identification import programs
from coilset.model.tools.wires.certificate import Certificate
from coilset.scripts.commands.material import app

STATED = ["--rm", "1665", "--rp02", "1450", "--elastic-limit", "1300", "--name", "my_wire"]


def tension(law, strains):
    steps = [{"to": {"eps11": float(strain)}, "increments": 200} for strain in strains]
    history = programs.run(law, programs.Program.model_validate({"name": "tension", "steps": steps}))
    return history.strain[:, 0], history.stress[:, 0]


def test_a_tensile_test_of_the_file_gives_the_stated_stresses(tmp_path):
    """Engineering stress s = σ exp(−εp − 2ν σ/E); Rm is its maximum."""
    said = CliRunner().invoke(app, ["certificate", *STATED, "--out", str(tmp_path)], catch_exceptions=False).output
    assert "yield begins at 130" in said
    law = library.load(tmp_path / "my_wire.yaml")
    assert law.data.tensile_strength == 1665.0
    strain, stress = tension(law, [0.03])
    plastic = strain - stress / law.E
    nominal = stress * np.exp(-plastic - 2.0 * law.nu * stress / law.E)
    assert nominal.max() == pytest.approx(1665.0, rel=2e-3)
    assert np.interp(0.002, plastic, nominal) == pytest.approx(1450.0, rel=3e-3)
    assert stress[np.argmax(plastic > 1e-9) - 1] == pytest.approx(1300.0, rel=0.02)  # the last elastic increment


def test_an_elastic_limit_that_is_not_stated_is_an_estimate():
    made = Certificate(1665.0, 1450.0, 81500.0, 0.26)
    assert made.elastic_limit == pytest.approx(1235.0)
    assert "estimated" in made.material("wire", "a test")["validity"]["remark"]
    assert "estimated" not in Certificate(1665.0, 1450.0, 81500.0, 0.26, 1300.0).assumptions


@pytest.mark.parametrize(("strength", "proof"), [(1450.0, 1665.0), (1665.0, 800.0)])
def test_stresses_that_do_not_ascend_are_refused(strength, proof):
    with pytest.raises(InputError, match=r"certificate: elastic limit .* MPa: must ascend"):
        Certificate(strength, proof, 81500.0, 0.26).curve()


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "my_wire.yaml").write_text("name: mine")
    with pytest.raises(InputError, match="already exists; use --overwrite"):
        CliRunner().invoke(app, ["certificate", *STATED, "--out", str(tmp_path)], catch_exceptions=False)
    assert yaml.safe_load((tmp_path / "my_wire.yaml").read_text()) == {"name": "mine"}
