"""Hardening by laws and tables over plastic strain: one point driven in tension and torsion comes to the curve."""

import numpy as np
import pytest

from coilset.model.core.base.entry import check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.tools.identification import programs

G, NU = 80000.0, 0.3
E = 2 * G * (1 + NU)
STRAINS = [0.001, 0.01, 0.08]  # plastic
LAWS = {
    "swift": ({"law": "swift", "C": 1400.0, "strain_0": 0.002, "n": 0.15}, lambda e: 1400.0 * (0.002 + e) ** 0.15),
    "voce": (
        {"law": "voce", "yield_stress": 900.0, "rise": 400.0, "rate": 40.0},
        lambda e: 900.0 + 400.0 * (1 - np.exp(-40.0 * e)),
    ),
    "ramberg-osgood": (
        {"law": "ramberg-osgood", "proof_stress": 1000.0, "n": 12.0, "elastic_limit": 800.0},
        lambda e: 1000.0 * ((e + 0.002 * 0.8**12) / 0.002) ** (1 / 12),
    ),
}


def law(isotropic, file=""):
    return Law(
        check_entries(
            {
                "name": "a steel",
                "description": "of a test",
                "source": "none",
                "units": "N, mm, K",
                "validity": {"plastic_work": 100.0, "remark": "of a test"},
                "temperatures": [
                    {
                        "temperature": 293.15,
                        "elasticity": {"G": G, "nu": NU},
                        "isotropic": isotropic,
                        "kinematic": "none",
                        "non_normality": "none",
                    }
                ],
            },
            MaterialFile,
            file,
        )
    )


def driven(material, **to):
    """Stress at the end of one step in 400 increments."""
    steps = [{"to": to, "increments": 400}]
    return programs.run(material, programs.Program.model_validate({"name": "test", "steps": steps})).stress[-1]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("plastic", STRAINS)
def test_tension_and_torsion_come_to_the_law(name, plastic):
    """σ(εᵖ) at the total strain εᵖ + σ/E; in torsion τ = σ/√3 at γ = √3 εᵖ + τ/G. Increments leave less than 1e-4."""
    entries, stress = LAWS[name]
    material, wanted = law(entries), stress(plastic)
    assert driven(material, eps11=plastic + wanted / E)[0] == pytest.approx(wanted, rel=1e-4)
    shear = wanted / np.sqrt(3)
    assert driven(material, gamma12=np.sqrt(3) * plastic + shear / G)[1] == pytest.approx(shear, rel=1e-4)


@pytest.mark.parametrize("name", LAWS)
def test_the_work_of_a_law_is_its_integral(name):
    """k² at b* = ∫ σ dεᵖ by the midpoint rule; its slope by differences."""
    entries, stress = LAWS[name]
    strain = np.concatenate([np.linspace(0, 0.001, 20001), np.linspace(0.001, 0.25, 20001)[1:]])
    work = np.cumsum(stress(0.5 * (strain[1:] + strain[:-1])) * np.diff(strain))
    k2, slope = law(entries).functions(work)[:2]
    np.testing.assert_allclose(k2, stress(strain[1:]) ** 2 / 1.5, rtol=1e-5)
    middle = 0.5 * (work[1:] + work[:-1])
    np.testing.assert_allclose(law(entries).functions(middle)[1], np.diff(k2) / np.diff(work), rtol=5e-3)
    assert (slope > 0).all()


def test_a_table_passes_through_its_points_and_never_falls():
    strain, stress = [0.0, 0.001, 0.004, 0.02, 0.1], [600.0, 900.0, 1000.0, 1000.0, 1150.0]
    entries = {"law": "table", "strain": strain, "stress": stress, "strains": "plastic"}
    for plastic, wanted in list(zip(strain, stress, strict=True))[1:]:
        assert driven(law(entries), eps11=plastic + wanted / E)[0] == pytest.approx(wanted, rel=2e-4)
    assert (law(entries).functions(np.linspace(0, 200, 4001))[1] >= 0).all()


def test_total_strain_torsion_and_first_lengths_are_taken_off(tmp_path):
    """Swift's law sampled as five kinds of test gives five times the same k²."""
    plastic = np.concatenate([[0.0], np.geomspace(2e-4, 0.2, 120)])
    stress = LAWS["swift"][1](plastic)
    total = plastic + stress / E
    shear, force = stress / np.sqrt(3), stress / np.exp(total)
    tables = [
        {"strain": plastic, "stress": stress, "strains": "plastic"},
        {"strain": total, "stress": stress},
        {"strain": np.expm1(total), "stress": force, "measure": "engineering"},
        {"strain": np.expm1(total) - force / E, "stress": force, "measure": "engineering", "strains": "plastic"},
        {"strain": np.sqrt(3) * plastic + shear / G, "stress": shear, "test": "torsion"},
    ]
    works = np.linspace(0.5, 150.0, 300)
    wanted = law(LAWS["swift"][0]).functions(works)[0]
    for table in tables:
        values = {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in table.items()}
        np.testing.assert_allclose(law({"law": "table", **values}).functions(works)[0], wanted, rtol=1e-3)
    lines = [f"{e},{s}" for e, s in zip(total, stress, strict=True)]
    (tmp_path / "test.csv").write_text("# of a test\nstrain,stress\n0,0\n" + "\n".join(lines), encoding="utf-8")
    found = law({"law": "table", "file": "test.csv"}, tmp_path / "steel.yaml").functions(works)[0]
    np.testing.assert_allclose(found, wanted, rtol=1e-3)


@pytest.mark.parametrize(
    ("isotropic", "problem"),
    [
        ({"law": "hollomon"}, "temperatures.0.isotropic: .*law must be swift, voce, ramberg-osgood or table"),
        (
            {"law": "table", "strain": [0, 0.1], "stress": [500.0, 400.0], "strains": "plastic"},
            "the stress falls from 500",
        ),
        ({"law": "table", "strain": [0, 0.1, 0.1], "stress": [5e2, 6e2, 7e2], "strains": "plastic"}, "does not ascend"),
        ({"law": "table", "strain": [0.01, 0.1], "stress": [500.0, 600.0]}, "has a plastic strain of 0.007"),
        ({"law": "table", "strain": [0, 0.1]}, "give either file, or strain and stress"),
        ({"law": "table", "file": "none.csv"}, "none.csv: cannot be read"),
        ({"law": "ramberg-osgood", "proof_stress": 9e2, "n": 9.0, "elastic_limit": 950.0}, "must be below the proof"),
        ({"law": "swift", "C": 1400.0, "n": 0.15}, "strain_0: this entry is required"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(isotropic, problem):
    with pytest.raises(InputError, match=problem) as caught:
        law(isotropic)
    assert "\n" not in str(caught.value)
