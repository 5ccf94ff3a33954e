"""Laws of one's own: against the built-in ones in both forms, condensed, and what the door refuses."""

import numpy as np
import pytest
from scipy.optimize import root

from coilset.api import Case, InputError, Law, condense, solve
from coilset.model.core.material import library
from coilset.model.core.material.point.points import initial_state, update
from coilset.verification.references.own_laws import drucker, kinematic, kinematic_3d, mises

PRAGER = library.load("linear_kinematic")
ZETA = 2.0 / 3.0 * 2000.0
CONSTANTS = [PRAGER.E, PRAGER.G, 106666.6667, float(PRAGER.functions(0.0)[2])]


def path(steps, size=2e-3, seed=3):
    """Strain increments with turns, shape (steps, 3)."""
    return size * np.random.default_rng(seed).normal(size=(steps, 3))


def driven(law, increments, row=None):
    """Stresses along a path, shape (steps, 3)."""
    row = initial_state(law, 1) if row is None else row
    found = []
    for strain in increments:
        row, C, _ = update(law, row, strain[None])
        found.append(row[0, :3])
    return np.array(found), C[0]


@pytest.fixture(scope="module")
def prager():
    return Law(kinematic, CONSTANTS)


def test_linear_kinematic_hardening_is_the_built_in(prager):
    """Stress, back stress and tangent at the end of a path with turns, far beyond yield."""
    assert CONSTANTS[3] == pytest.approx(ZETA, rel=1e-7)
    (ours, C), (theirs, D) = (driven(law, path(30)) for law in (prager, PRAGER))
    assert np.abs(theirs).max() > 400.0
    assert np.abs(ours - theirs).max() < 1e-10 * np.abs(theirs).max()
    assert np.abs(C - D).max() < 1e-9 * np.abs(D).max()


def test_isotropic_hardening_by_radial_return_meets_the_built_in_as_increments_become_short():
    """Backward Euler is of first order where the strain turns, the built-in law of second."""
    theirs, law, worst = library.load("linear_isotropic"), Law(mises, [210e3, 80769.2308, 400.0, 2000.0], ["p"]), []
    for parts in (50, 100):
        increments = np.repeat(path(6) / parts, parts, axis=0)
        found, exact = (driven(one, increments)[0] for one in (law, theirs))
        worst.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert worst[1] < 2.5e-3
    assert worst[0] / worst[1] == pytest.approx(2.0, abs=0.2)


def condensed_built_in(increments):
    """Stresses of the built-in law of six stresses along a path, those across the wire brought to zero by scipy."""
    row, along, across, found = initial_state(PRAGER, 1, 6), [0, 3, 4], [1, 2, 5], []
    for strain in increments:
        full = np.zeros(6)
        full[along] = strain

        def at(f, full=full, row=row):
            full[across] = f
            return update(PRAGER, row, full[None])[0]

        row = at(root(lambda f, at=at: at(f)[0, across], np.zeros(3), tol=1e-13).x)
        assert np.abs(row[0, across]).max() < 1e-8
        found.append(row[0, along])
    return np.array(found)


def test_the_condensed_three_dimensional_law_is_the_built_in_condensed():
    """And on a proportional path both are the built-in law of the rod; the door has judged the condensed tangent."""
    own = Law(condense(kinematic_3d), CONSTANTS, ["B12", "B13", "B23"])
    ours, theirs = driven(own, path(12))[0], condensed_built_in(path(12))
    assert np.abs(ours - theirs).max() < 1e-10 * np.abs(theirs).max()
    pulled = np.array([[1e-3, 0.0, 0.0]] * 5 + [[-1e-3, 0.0, 0.0]] * 8)
    for increments in (pulled, pulled[:, [1, 0, 2]]):
        assert np.abs(driven(own, increments)[0] - driven(PRAGER, increments)[0]).max() < 1e-10 * 400.0


def test_a_spring_of_the_own_law_is_that_of_the_built_in(prager, tmp_path):
    loading = [{"to": {"travel": 14.0}, "steps": 4}, {"to": {"force": 0.0}, "steps": 1}]
    spring = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
    mesh = {"elements_per_turn": 8, "section": {"radial": 3, "angular": 8}}
    case = Case(
        {"spring": spring, "material": "linear_kinematic", "loading": loading, "mesh": mesh, "accuracy": "none"}
    )
    ours, theirs = solve(case, law=prager), solve(case)
    assert np.abs(ours.force - theirs.force).max() < 1e-9 * theirs.force.max()
    assert ours.set == pytest.approx(theirs.set, abs=1e-9)
    assert ours.set > 0.5
    assert ours.summary["plastic_work_max_N_per_mm2"] > 1.0


def test_a_law_that_coilset_has_not():
    """Drucker's yield stress that grows with pressure: σ_c/σ_t = (1 + α)/(1 − α), so a bent bar shifts its axis."""
    E, G, k, α = 210e3, 80769.0, 400.0, 0.05
    law = Law(drucker, [E, G, k, α])
    for sign in (1.0, -1.0):
        stress, C = driven(law, np.array([[sign * 1e-3, 0.0, 0.0]] * 4))
        assert abs(stress[-1, 0]) == pytest.approx(k / (1.0 + sign * α), rel=1e-9)
        assert abs(C[0, 0]) < 1e-6 * E
    (_, (σ, τ, _)), _ = driven(law, np.array([[0.0, 2e-3, 0.0]] * 2))
    assert np.sqrt(σ**2 + 3.0 * τ**2) + α * σ == pytest.approx(k, rel=1e-9)
    assert σ < -1.0  # sheared between fixed ends it wants to grow


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("strain[0] = 0.0", "writes into its arguments"),
        ("tangent[0, 0] *= 1.01", "fails the Taylor test"),
        ("new_stress[2] = np.nan", "unset or not finite"),
        ("new_stress[0] += 1.0", "changes the stress where no strain is added"),
        ("return False", "finds no solution"),
        ("new_stress[0] = no_such_name", "numba cannot compile it"),
        ("import math", "numba cannot compile it"),
        ("return", "returns nothing; it must return True"),
    ],
)
def test_the_door_refuses(change, said):
    text = f"""
def wrong(stress, state, strain, parameters, new_stress, new_state, tangent):
    new_state[:] = state
    tangent[:] = 0.0
    for i in range(3):
        tangent[i, i] = 1e5
        new_stress[i] = stress[i] + 1e5 * strain[i]
    {change}
    return True
"""
    names = {"np": np}
    exec(text, names)
    with pytest.raises(InputError, match=said):
        Law(names["wrong"])


def test_a_law_with_directions_needs_sections_that_have_them():
    def soft_along_y(stress, state, strain, parameters, new_stress, new_state, tangent):
        new_state[:] = state
        tangent[:] = 0.0
        for i in range(3):
            tangent[i, i] = parameters[i]
            new_stress[i] = stress[i] + parameters[i] * strain[i]
        return True

    law = Law(soft_along_y, [2e5, 6e4, 8e4])
    assert not law.keeps_direction
    assert Law(soft_along_y, [2e5, 8e4, 8e4]).keeps_direction
    entries = {"spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}}
    entries |= {"material": "elastic", "loading": [{"to": {"travel": 1.0}}], "mesh": {"section": {"kind": "plane"}}}
    with pytest.raises(InputError, match=r"mesh\.section\.kind: the law differs with the direction"):
        solve(Case(entries), law=law)
