"""What a diffractometer sees: closed means of simple fields, and a run and a slice beside each other."""

import numpy as np
import pytest

import coilset.open
from coilset.api import Case, slice_, solve
from coilset.model.core.base.errors import InputError
from coilset.model.tools.diffraction.diffraction import Wire, seen_stress

R = 2.0


def torsion(gradient=0.0):
    """τ₁θ = 100 (r/R)^gradient all round: τ₁₂ = −τ sin θ, τ₁₃ = τ cos θ."""

    def field(s, y, z):
        r = np.hypot(y, z)
        τ = 100.0 * (r / R) ** gradient
        none = np.zeros_like(r)
        return np.column_stack([none, -τ * z / r, τ * y / r, none, none, none])

    return Wire(field, R)


def test_pure_shear_is_pulled_at_45_degrees_and_pushed_at_the_other():
    found = [seen_stress(torsion(), 30.0, 0.0, 0.0, 0.0, ψ) for ψ in (45.0, -45.0, 0.0, 90.0)]
    assert found == pytest.approx([100.0, -100.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("spot", [0.4, 0.8, 1.6])
def test_a_wide_spot_sees_less_of_the_shear(spot):
    """cos δ = √(1 − x²/R²), mean over the disk: 1 − a²/(8 R²) − a⁴/(64 R⁴), a the spot's radius."""
    a = 0.5 * spot / R
    found = seen_stress(torsion(), 0.0, spot, 0.0, 0.0, 45.0)
    assert found == pytest.approx(100.0 * (1.0 - a**2 / 8.0 - a**4 / 64.0), rel=1e-4)


def test_depth_weighs_exponentially():
    """Of a stress that falls linearly by 50 MPa a mm the mean below z₀ is that at z₀ + a."""
    wire = torsion(1.0)
    assert seen_stress(wire, 0.0, 0.0, 40.0, 10.0, 45.0) == pytest.approx(100.0 - 50.0 * 0.05, rel=1e-9)


def test_axial_and_hoop_stress_in_their_directions():
    def field(s, y, z):
        r = np.hypot(y, z)
        hoop, none = 60.0, np.zeros_like(r)
        return np.column_stack([none + 80.0, none, none, hoop * z**2 / r**2, hoop * y**2 / r**2, -hoop * y * z / r**2])

    found = [seen_stress(Wire(field, R), 70.0, 0.0, 0.0, 0.0, ψ) for ψ in (0.0, 90.0, 45.0)]
    assert found == pytest.approx([80.0, 60.0, 70.0])


@pytest.fixture(scope="module")
def pressed():
    entries = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
    loading = [{"to": {"travel": 12.0}, "steps": 6}, {"to": {"force": 0}, "steps": 2}]
    return Case(
        {
            "spring": entries,
            "loading": loading,
            "ends": "clamped",
            "mesh": {"elements_per_turn": 12},
            "accuracy": "none",
        }
    )


def test_a_run_has_its_own_surface_stress_at_a_point(pressed, tmp_path):
    solve(pressed).save(tmp_path / "run")
    run = coilset.open(tmp_path / "run")
    turns = run["turn"].to_numpy()
    element = int(np.searchsorted(turns, 1.25)) - 1
    seen = run.xray(turn=1.25, angle=0.0, spot=0.8, depth=0.0)
    around = run["surface"].isel(snapshot=-1, element=element, gauss=1, angle=0)
    by_hand = 0.5 * float(around.sel(component="s11")) + float(around.sel(component="t13"))
    assert float(seen["point"].sel(direction="+45°")) == pytest.approx(by_hand, rel=0.01)
    shear = 0.5 * float(seen["stress"].sel(direction="+45°") - seen["stress"].sel(direction="-45°"))
    at_point = 0.5 * float(seen["point"].sel(direction="+45°") - seen["point"].sel(direction="-45°"))
    assert 0.9 < shear / at_point < 1.0  # a spot of a sixth of d: less than a tenth off
    with pytest.raises(InputError, match="turn: 9 is not on the wire"):
        run.xray(turn=9)
    with pytest.raises(InputError, match="spot: is 7 mm, but the wire is 5 mm thick"):
        run.xray(turn=1, spot=7)


def test_the_slice_sees_what_the_rod_sees_over_a_turn(pressed, tmp_path):
    """Clamped ends bend the rod's coils, ± 10 MPa over a turn; the slice has its mean, 57.5 and −53.3 MPa."""
    longer = pressed.change({"spring.turns": 4.5, "loading.0.to.travel": 21.6})
    slice_(longer.change({"ends": "seats"})).save(tmp_path / "slice")
    solve(longer).save(tmp_path / "run")
    run, one = coilset.open(tmp_path / "run"), coilset.open(tmp_path / "slice").xray(turn=0, spot=0.8)
    turn = np.mean([run.xray(turn=t, spot=0.8)["stress"].to_numpy() for t in 1.75 + np.arange(8) / 8], axis=0)
    assert turn[[1, 3]] == pytest.approx(one["stress"].to_numpy()[[1, 3]], rel=0.03)
    assert turn[0] == pytest.approx(float(one["stress"][0]), abs=1.0)
