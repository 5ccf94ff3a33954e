"""The coarse case of the study, its sampling, its store and its output."""

import json

import numpy as np
import pytest
import pyvista
from mpi4py import MPI
from solid_laws import Elastic

from coilset.meshes.solids.solid import SectionGrid, coil_section
from coilset.model.physics.solid import output
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.sampling import SectionSample, disk_grid
from coilset.verification.solid_study import elastic, pressing, references, study
from coilset.verification.solid_study.store import Store


def test_goehners_equation_meets_his_series():
    # the series is cut after C⁻³: its error is of the order C⁻⁴
    for index in (4.0, 8.0, 16.0):
        inside, outside = references.goehner_exact(index)
        assert abs(inside - references.goehner_series(index)) < 0.5 / index**3
        assert inside == pytest.approx(references.goehner_exact(index, 10)[0], rel=1e-9)
        assert outside < 1 < inside
    assert references.goehner_exact(200.0)[0] == pytest.approx(1 + 1.25 / 200, abs=1e-4)


def goehner_by_displacements(C, degree=12):
    """Inside factor and rate over G d⁴/(8 D³) of Göhner's wire from the dual problem: u_z = c θ and a warping u_θ.

    Ritz's method, polynomials odd in z: ½ ∫ (γ_rθ² + γ_θz²) r dA with γ_rθ = ∂v/∂r − v/r, γ_θz = ∂v/∂z + c/r, c = 1.
    """
    ρ, w = np.polynomial.legendre.leggauss(30)
    φ = 2 * np.pi * np.arange(64) / 64
    ρ, w = 0.5 * (ρ + 1), 0.25 * w * (ρ + 1) * 2 * np.pi / 64
    powers = [(i, j) for i in range(degree) for j in range(1, degree, 2) if i + j < degree]

    def strains(x, z):
        rθ = np.array([i * x ** max(i - 1, 0) * z**j - x**i * z**j / (C + x) for i, j in powers])
        return rθ, np.array([j * x**i * z ** (j - 1) for i, j in powers])

    x, z, w = np.outer(ρ, np.cos(φ)).ravel(), np.outer(ρ, np.sin(φ)).ravel(), np.repeat(w, 64)
    rθ, θz = strains(x, z)
    matrix = (rθ * w * (C + x)) @ rθ.T + (θz * w * (C + x)) @ θz.T
    a = np.linalg.lstsq(matrix, -θz @ w, rcond=1e-14)[0]
    force = w @ (a @ θz + 1 / (C + x))
    inside = a @ strains(np.array([-1.0]), np.zeros(1))[1] + 1 / (C - 1)
    return inside[0] * np.pi / (2 * C * force), 2 * C**3 * force / np.pi


@pytest.mark.parametrize("index", [4.0, 8.0, 12.0])
def test_goehners_equation_meets_its_dual(index):
    # stress function and warping are independent discretisations of one problem; the rate is Göhner's to C⁻⁴
    inside, rate = goehner_by_displacements(index)
    assert references.goehner_exact(index)[0] == pytest.approx(inside, rel=1e-6)
    assert rate == pytest.approx(1 / (1 - 3 / 16 / index**2), abs=0.25 / index**4)


def test_coarse_elastic_coil():
    # 2 % is asked for; this mesh has 0.5 %, of which the sampling's averaging over 22.5° of the coil is the most
    result = elastic.run(elastic.ElasticCase(8.0, 2, 16), MPI.COMM_SELF)
    inside, outside = references.goehner_exact(8.0)
    assert result["inside"] == pytest.approx(inside, rel=0.01)
    assert result["outside"] == pytest.approx(outside, rel=0.01)
    # rate of the curved wire: G d⁴/(8 D³) / (1 − 3/(16 C²)) (Göhner 1930)
    assert result["force"] == pytest.approx(1 / (1 - 3 / 16 / 8**2), rel=0.005)


@pytest.mark.slow
def test_coarse_pressed_section_meets_the_rod(tmp_path):
    # force within 2 % and set within 3 % are asked for; on finer meshes 0.0 % and 0.4 % are found
    cases = {"elastic": [], "pressed": [pressing.PressedSection(8.0, 2, 12, steps=4)]}
    found = study.run(Store(tmp_path, MPI.COMM_SELF), cases)
    records = study.records(found)
    assert [record["tolerance"] for record in records] == [0.02, 0.03]
    for record in records:
        assert record["ours"] == pytest.approx(record["reference"], rel=record["tolerance"])
    compared = study.numbers(*found["pressed"][0])
    for side in ("inside", "outside"):  # flow levels what the curvature makes of the stress; 2.5 % and 0.05 % are found
        solid, rod = compared[f"shear {side} at full travel"]
        assert rod == pytest.approx(solid, rel=0.04)
    # release is elastic: the solid loses Göhner's stress, 0.2 % are found, and the rod that of torsion, which is 0.9 of
    # the surface's there, and of direct shear without the curvature, F/A; 0.3 % are found
    force, factors = compared["force at full travel"][0], references.goehner_exact(8.0, places=(-0.9, 0.9))
    nominal, direct = 8 * force * 40.0 / (np.pi * 5.0**3), force / (np.pi * 2.5**2)
    for side, sign, factor in (("inside", 1, factors[0]), ("outside", -1, factors[1])):
        full, end = (np.array(compared[f"shear {side} {when}"]) for when in ("at full travel", "after release"))
        assert full - end == pytest.approx([sign * factor * nominal, sign * 0.9 * nominal + direct], rel=0.01)
    # and a second run reads what the first has written
    lines = []
    again = study.run(Store(tmp_path, MPI.COMM_SELF, lines.append), cases)
    assert all(line.endswith(": known") for line in lines)
    assert again["pressed"][0][1] == json.loads(json.dumps(found["pressed"][0][1]))


@pytest.fixture(scope="module")
def bent():
    problem = SolidProblem(coil_section(5.0, 30.0, 10.0, 120.0, 12, MPI.COMM_SELF, SectionGrid(3, 2)), Elastic())
    problem.step(Motion((0.0, 0.0, -0.2), (0.0, 0.0, 0.05)))
    return problem


def test_resultants_of_the_sampled_stress_are_the_heads_reactions(bent):
    # ∫ over the mid-section of the sampled stress against the virtual work at the head; the error of 2.3 % with
    # 8 layers, 0.8 % with 12 and 0.1 % with 16 is that of a parabola through two layers of a curved wire
    solid = bent.solid
    r, w = np.polynomial.legendre.leggauss(8)
    r, w = 1.25 * (r + 1), 1.25 * w
    angle = 2 * np.pi * np.arange(24) / 24
    y, z = np.outer(r, np.cos(angle)).ravel(), np.outer(r, np.sin(angle)).ravel()
    sample = SectionSample(solid, 0.5 * solid.wire.length, y, z)
    area = np.repeat(w * r, 24) * 2 * np.pi / 24
    σ, (centre, axes) = sample.stress(), sample.frame()
    arm = sample.positions() - centre
    traction = σ @ axes.T
    top = bent.reactions(centre)[1]
    force, moment = area @ traction, area @ np.cross(arm, traction)
    assert np.allclose(force, top.force, atol=0.01 * np.abs(top.force).max())
    assert np.allclose(moment, top.moment, atol=0.01 * np.abs(top.moment).max())


def test_sample_points_stay_with_the_material(bent):
    y, z = disk_grid(2.5, 2, 8)
    sample = SectionSample(bent.solid, 0.3 * bent.solid.wire.length, y, z)
    centre, axes = sample.frame()
    local = (sample.positions() - centre) @ axes
    assert np.allclose(local[:, 1:], np.stack([y, z], axis=1), atol=0.01)
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-12)


def test_fields_for_paraview(bent, tmp_path):
    output.write_fields(tmp_path / "body.vtu", bent.solid)
    body = pyvista.read(tmp_path / "body.vtu")
    assert body.n_cells == bent.solid.n_cells
    assert set(body.point_data) == {"displacement", "stress", "von Mises stress", "plastic work"}
    moved = np.abs(body["displacement"][:, 2]).max()
    assert moved == pytest.approx(0.2, rel=0.2)
    assert body["von Mises stress"].max() > 0
