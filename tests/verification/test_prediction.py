"""Section forces predicted by a correction, and Newton's iterations where they matter."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.core.material import library
from coilset.model.core.rod import rod as rods
from coilset.verification.cases.rods.slender_rods import circles, elastica

LENGTH, WANTED = 80.0, 8


@pytest.fixture
def turned(make_rod):
    """An elastic rod of two elements, turned by 0.1 rad at its nodes, and a direction."""
    rng = np.random.default_rng(5)
    rod = make_rod([[0, 0, 0], [LENGTH, 0, 0], [LENGTH, 60, 20]], law=library.load("elastic"))
    values, direction = (0.1 * rng.normal(size=len(rod.increment.x.array)) for _ in range(2))
    return rod, values, direction


def at(rod, values):
    """Bring the rod there; its section forces."""
    rod.increment.x.array[:] = values
    assert rod.update()
    return rod.coefficients.s.copy()


def test_predicted_forces_are_the_derivative_of_the_forces(turned):
    """D B δ against central differences at a turned state, where the charts' tangents are not 1; good to 1e-8."""
    rod, base, direction = turned
    h = 1e-6
    exact = (at(rod, base + h * direction) - at(rod, base - h * direction)) / (2 * h)
    forces = at(rod, base)
    rod.predict(direction)
    rod.element_tangents(1.0)
    scale = np.abs(exact).max(axis=(0, 1))
    np.testing.assert_allclose((rod.coefficients.predicted - forces - exact) / scale, 0.0, atol=1e-7)
    rod.element_tangents()
    np.testing.assert_array_equal(rod.coefficients.predicted, forces)
    np.testing.assert_array_equal(rod.coefficients.s, forces)


def test_without_strains_of_second_order_an_elastic_rod_has_its_predicted_forces(turned):
    """After 0.7 of a correction of 0.1 rad and 10 mm; the forces themselves differ from the predicted ones by far."""
    rod, base, direction = turned
    direction[rod.numbering.u] *= 100.0
    direction[rod.numbering.own] = 0.0
    at(rod, base)
    rod.predict(direction)
    there = at(rod, base + 0.7 * direction)
    found, expected = (np.zeros(len(base)) for _ in range(2))
    rod.first_order_forces(found, 0.7)
    np.testing.assert_array_equal(rod.coefficients.s, there)
    rod.element_tangents(0.7)
    predicted = rod.coefficients.predicted
    assert np.abs(there - predicted).max() > 0.02 * np.abs(predicted).max()
    rod.coefficients.s[:] = predicted
    rod.internal_forces(expected)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_a_rod_recalls_the_end_of_its_last_step_without_evaluating_the_law(make_rod):
    """With that step's own tangents, which are those of plastic flow; not as at the place tried since."""
    rod = make_rod([[0, 0, 0], [LENGTH, 0, 0], [LENGTH, 60, 20]])
    increments = 0.02 * np.random.default_rng(5).normal(size=len(rod.increment.x.array))
    at(rod, increments)
    known = [getattr(rod.coefficients, name) for name in ("s", "D", "E", "P", "W", "e")]
    there = [field.copy() for field in known]
    assert there[0].any()
    rod.advance()
    rod.state.commit()
    at(rod, -2.0 * increments)
    tried = rod.point_state.copy()
    rod.increment.x.array[:] = 0.0
    assert rod.recall()
    for field, values in zip(known, there, strict=True):
        np.testing.assert_array_equal(field, values)
    np.testing.assert_array_equal(rod.point_state, tried)
    assert rod.update()  # the material at rest yields no more
    assert np.abs(rod.coefficients.D[..., 3, 3] / there[1][..., 3, 3]).max() > 1.5


def test_a_long_rod_uses_the_law_instead(example, monkeypatch):
    """It keeps no tangents of its last equilibrium: another one for each start of a step, and the same forces."""
    settings = [
        "ends=clamped",
        "mesh={elements_per_turn: 8, section: {rule: abramowitz9}}",
        "loading=[{to: {travel: 12}, steps: 6}, {to: {force: 0}, steps: 3}]",
    ]
    runs = []
    for kept in (20, 19):
        monkeypatch.setattr(rods, "KEPT", kept)
        runs.append(Analysis(read_case(example, settings), MPI.COMM_SELF))
        runs[-1].run()
    known, asked = runs
    assert ("section_tangents" in known.system.state, "section_tangents" in asked.system.state) == (True, False)
    assert asked.system.evaluations - known.system.evaluations >= 7  # steps whose path has one before it
    for one, other in zip(known.result.steps, asked.result.steps, strict=True):
        assert one.force_N == pytest.approx(other.force_N, abs=1e-7)  # of 200 N, balanced to 1e-9


@pytest.mark.parametrize("slenderness", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("problem", [elastica, circles])
def test_newton_does_not_mind_slenderness(problem, slenderness):
    """Ten steps of 8 rods, at most 8 iterations each; without predicted forces r/L = 1e-3 fails in its first step."""
    counts, done, _value = problem(slenderness, 8)
    assert done
    assert max(counts) <= WANTED, counts
