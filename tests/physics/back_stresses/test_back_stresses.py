"""Several back stresses (Chaboche) against closed curves of tension and the rate equations in 3 × 3 tensors."""

import copy
import math

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from coilset.model.core.base.errors import InputError
from coilset.model.core.material import library
from coilset.model.core.material.law.functions import HEATING
from coilset.model.core.material.law.parts import saturation
from coilset.model.core.material.point import groups, points
from coilset.model.core.material.point.loops import follow
from coilset.model.physics.back_stresses import back_stresses
from coilset.model.tools.identification import programs

LAW = library.load("chaboche")
TERMS = [(200000.0, 1000.0), (22500.0, 150.0), (2000.0, 20.0)]  # C and γ of the file
PLACES = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def yield_stress(p):
    """Of the file: 400 N/mm² and 50 more."""
    return 400.0 + 50.0 * (1.0 - np.exp(-30.0 * p))


def driven(strains, increments=400):
    """Stress, sum of back stresses and b* of the rod at the end of each piece of a tension test."""
    steps = [programs.Step(name="", to={"eps11": strain}, increments=increments) for strain in strains]
    history = programs.run(LAW, programs.Program(name="tension", steps=tuple(steps)))
    last = [(history.step == i).nonzero()[0][-1] for i in range(len(strains))]
    return history.strain[last, 0], history.stress[last, 0], 1.5 * history.back[last, 0]


def test_tension_and_reversal_are_the_closed_curves():
    """Each Xᵢ = ν C/γ + (X₀ − ν C/γ) exp(−γ |Δεᵖ|) between reversals; the yield stress grows with the whole way."""
    strain, stress, back = driven([0.01, -0.008, 0.02])
    plastic = strain - stress / LAW.E
    way, X = np.cumsum(np.abs(np.diff(plastic, prepend=0.0))), np.zeros(3)
    for i, change in enumerate(np.diff(plastic, prepend=0.0)):
        sign = np.sign(change)
        for k, (C, γ) in enumerate(TERMS):
            X[k] = sign * C / γ + (X[k] - sign * C / γ) * math.exp(-γ * abs(change))
        assert back[i] == pytest.approx(X.sum(), rel=2e-4)
        assert stress[i] == pytest.approx(X.sum() + sign * yield_stress(way[i]), rel=1e-4)


def tensor(six, shear=1.0):
    out = np.zeros((3, 3))
    for value, (i, j) in zip(six, PLACES, strict=True):
        out[i, j] = out[j, i] = value * (shear if i != j else 1.0)
    return out


def deviator(a):
    return a - np.trace(a) / 3 * np.eye(3)


FREE = [(1, 1), (2, 2), (1, 2)]  # components of strain that the rod leaves free
UNITS = np.array([tensor(np.eye(6)[PLACES.index(place)]) for place in FREE])


def follow_rates(D, start, rod):
    """σ, Bᵢ and p after the strain D, from the rates as they stand, by DOP853 from first yield on."""
    G, K = LAW.G, 2 * LAW.G * (1 + LAW.nu) / (3 * (1 - 2 * LAW.nu))

    def flow(y, d):
        """Rates of the state for a rate of strain."""
        σ, B, p = y[:9].reshape(3, 3), y[9:-1].reshape(-1, 3, 3), y[-1]
        n = deviator(σ) - B.sum(axis=0)
        k = math.sqrt(2 / 3) * yield_stress(p)
        on = np.sum(n * n) >= k * k * (1 - 1e-9)
        # k² = ⅔ σ², d(k²)/dt = 4/3 σ dσ/dp ṗ, ṗ = √⅔ λ k
        hardening = 2 / 3 * yield_stress(p) * 1500 * math.exp(-30 * p) * math.sqrt(2 / 3) * k
        hardening += k * k * sum(2 / 3 * C for C, _ in TERMS)
        hardening -= math.sqrt(2 / 3) * k * sum(γ * np.sum(n * b) for (_, γ), b in zip(TERMS, B, strict=True))

        def linear(d, on):
            λ = 2 * G * np.sum(n * d) / (2 * G * k * k + hardening) if on else 0.0
            return 2 * G * deviator(d - λ * n) + K * np.trace(d) * np.eye(3), λ

        def freed(on):
            """The rate of strain with that of the rod's free components, for which their stresses stay."""
            if not rod:
                return d
            A = np.array([[linear(u, on)[0][f] for u in UNITS] for f in FREE])
            x = np.linalg.solve(A, [-linear(d, on)[0][f] for f in FREE])
            return d + np.einsum("k,kij->ij", x, UNITS)

        on = on and np.sum(n * freed(True)) > 0
        σ_rate, λ = linear(freed(on), on)
        ṗ = math.sqrt(2 / 3) * λ * k
        B_rate = [2 / 3 * C * λ * n - γ * b * ṗ for (C, γ), b in zip(TERMS, B, strict=True)]
        return np.concatenate([σ_rate.ravel(), *(b.ravel() for b in B_rate), [ṗ]])

    y = solve_ivp(lambda _, y: flow(y, D), (0, 1), start, method="DOP853", rtol=1e-9, atol=1e-8, max_step=0.01).y
    return y[:, -1]


def path(components, seed):
    """Three straight pieces of 0.6 % in random directions."""
    pieces = np.random.default_rng(seed).normal(size=(3, components))
    return 0.006 * pieces / np.linalg.norm(pieces, axis=1)[:, None]


def mapped(pieces, increments):
    state = points.initial_state(LAW, 1, pieces.shape[1])
    for piece in pieces:
        for _ in range(increments):
            state, _, _ = points.update(LAW, state, piece[None] / increments)
    return state[0]


@pytest.mark.parametrize("components", [3, 6])
def test_random_paths_are_those_of_the_rates_and_of_second_order(components):
    pieces, y = path(components, 5), np.zeros(9 * 4 + 1)
    for piece in pieces:
        whole = piece if components == 6 else np.array([piece[0], 0, 0, piece[1], piece[2], 0])
        y = follow_rates(tensor(whole, 0.5), y, components == 3)
    exact = np.array([y[:9].reshape(3, 3)[place] for place in PLACES])
    exact = exact if components == 6 else exact[[0, 3, 4]]
    errors = [np.abs(mapped(pieces, n)[:components] - exact).max() / 450 for n in (25, 50, 100)]
    assert errors[-1] < 5e-4
    assert errors[0] / errors[1] > 3
    assert errors[1] / errors[2] > 3


def test_one_that_does_not_saturate_is_pragers(tmp_path):
    """Against the law with ζ = ⅔ C, which is exact on straight paths, as backward Euler is."""
    data = yaml.safe_load((library.FOLDER / "linear_kinematic.yaml").read_text(encoding="utf-8"))
    ours = library.load("linear_kinematic")
    ζ = ours.functions(0.0)[2]
    data["temperatures"][0]["kinematic"] = {"law": "chaboche", "terms": [{"C": float(1.5 * ζ), "gamma": 0.0}]}
    written = tmp_path / "prager.yaml"
    written.write_text(yaml.safe_dump(data), encoding="utf-8")
    law = library.load(written)
    for components in (3, 6):
        D = np.zeros((1, components))
        D[0, -2:] = 0.004, 0.003
        new = [points.update(each, points.initial_state(each, 1, components), D)[0][0] for each in (law, ours)]
        assert new[0] == pytest.approx(new[1], rel=1e-9, abs=1e-9)


def test_turned_frame():
    """The whole state, back stresses among it, turns with the frame."""
    R = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
    pieces = path(6, 2)

    def turned(six, shear=1.0):
        return np.array([(R @ tensor(six, shear) @ R.T)[place] for place in PLACES])

    strains = np.array([turned(one, 0.5) for one in pieces])
    strains[:, 3:] *= 2
    still, moved = mapped(pieces, 10), mapped(strains, 10)
    tensors = [0, 6, *range(13, LAW.columns(6) - 5, 6)]  # columns at which σ, B and the parts of B begin
    assert len(tensors) >= len(TERMS)
    for first in tensors:
        assert moved[first : first + 6] == pytest.approx(turned(still[first : first + 6]), rel=1e-9, abs=1e-8)
    assert moved[12] == pytest.approx(still[12], rel=1e-9)


@pytest.mark.parametrize(("components", "terms", "warm"), [(3, 1, False), (3, 3, True), (6, 3, False), (6, 2, True)])
def test_both_ways_through_a_point(tmp_path, components, terms, warm):
    """By one unknown a stage, many at once, and by the general iteration: the same state, count of flow, tangent.

    From states that flow, unload and flow back; a few increments that leave the surface for a moment have one way only.
    Warm points have constants between those of two temperatures. Tangents differ by the last correction, of 1e-6.
    """
    data = yaml.safe_load((library.FOLDER / "chaboche.yaml").read_text(encoding="utf-8"))
    del data["temperatures"][0]["kinematic"]["terms"][terms:]
    if warm:
        data["temperatures"].append(copy.deepcopy(data["temperatures"][0]) | {"temperature": 400.0})
        data["temperatures"][1]["elasticity"]["G"] *= 0.9
        data["temperatures"][1]["kinematic"]["terms"][0]["C"] *= 0.8
    written = tmp_path / "law.yaml"
    written.write_text(yaml.safe_dump(data), encoding="utf-8")
    law = library.load(written)
    n, many, form = components, 40, groups.ROD if components == 3 else groups.SOLID
    rng, parts = np.random.default_rng(5), law.parts(law.parameters(350.0 if warm else None))
    state = np.zeros((many, law.columns(n)))
    flowed = both = 0
    general = parts._replace(plastic=parts.plastic.copy())  # heats, but no point has a temperature of its own
    general.plastic[HEATING] = 1e-300
    for i in range(6):
        size = 10.0 ** rng.uniform(-5, -1.7, size=(many, 1))
        de = size * rng.normal(size=(many, n)) * (-1.0 if i % 3 == 2 else 1.0)
        new, rows, quick = np.empty_like(state), np.empty((n * n, many)), np.empty(many, np.int64)
        back_stresses.flow_points(parts, form, state, de.T.copy(), new, rows, True, quick)
        other, D, count = follow(general, state, de)
        at_once = quick >= 0
        assert (count >= 0).all()
        assert ((quick > 0) == (count > 0))[at_once].all()
        np.testing.assert_allclose(new[at_once], other[at_once], rtol=1e-9, atol=1e-8)
        np.testing.assert_allclose(rows.T.reshape(-1, n, n)[at_once], D[at_once], atol=1e-6 * law.E)
        flowed, both, state = flowed + (count > 0).sum(), both + (quick > 0).sum(), other.copy()
    assert 0.3 * 6 * many < flowed < 0.95 * 6 * many
    assert both > 0.95 * flowed


REFUSED = [
    ({"kinematic": {"law": "chaboche", "terms": []}}, "terms"),
    ({"kinematic": {"law": "chaboche", "terms": [{"C": 1000, "gamma": -1}]}}, "gamma"),
    ({"kinematic": {"law": "prager", "terms": []}}, "chaboche"),
]


@pytest.mark.parametrize(("change", "words"), REFUSED)
def test_what_is_refused(tmp_path, change, words):
    data = yaml.safe_load((library.FOLDER / "chaboche.yaml").read_text(encoding="utf-8"))
    for name, value in change.items():
        (data["temperatures"][0] if name in data["temperatures"][0] else data)[name] = value
    written = tmp_path / "law.yaml"
    written.write_text(yaml.safe_dump(data), encoding="utf-8")
    with pytest.raises(InputError, match=words):
        library.load(written)


def test_constants_between_two_temperatures(tmp_path):
    data = yaml.safe_load((library.FOLDER / "chaboche.yaml").read_text(encoding="utf-8"))
    warm = yaml.safe_load(yaml.safe_dump(data["temperatures"][0])) | {"temperature": 493.15}
    for term in warm["kinematic"]["terms"]:
        term["C"] *= 0.5
    data["temperatures"].append(warm)
    written = tmp_path / "law.yaml"
    written.write_text(yaml.safe_dump(data), encoding="utf-8")
    law = library.load(written)
    parts = law.parts()
    halfway = [saturation(parts, i, 393.15).zeta for i in range(len(TERMS))]
    assert halfway == pytest.approx([0.75 * 2 / 3 * C for C, _ in TERMS])
    del warm["kinematic"]["terms"][0]
    written.write_text(yaml.safe_dump(data), encoding="utf-8")
    with pytest.raises(InputError, match="same number of back stresses"):
        library.load(written)
