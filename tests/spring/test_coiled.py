"""Springs made of coiled wire: they stand as drawn, without a force, and what coiling left counts in their set."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_warnings import run_warnings
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import check
from coilset.model.physics.slice.analysis import SliceAnalysis
from coilset.verification.references.springback import Bar

SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.0, "pitch": 20.0, "made_by": "coiling"}
CASE = {
    "spring": SPRING,
    "material": "ck15",
    "ends": "clamped",
    "mesh": {"elements_per_turn": 8, "section": {"radial": 4, "angular": 12}},
    "loading": [{"to": {"travel": 6}, "steps": 3}, {"to": {"force": 0}, "steps": 2}],
    "accuracy": "none",
}
RELIEF = {"temperature": 523.15, "minutes": 30.0}


def peened(depth, stress, **more):
    """An uncoiled spring with a peened layer."""
    return {**SPRING, "made_by": None, "peening": {"depth": depth, "stress": stress, **more}}


PEENED = peened([0.0, 0.2, 0.6], [-200.0, -200.0, 0.0])


def analysis_of(**changes):
    return Analysis(check(CASE | changes), MPI.COMM_SELF)


def test_a_coiled_spring_stands_as_drawn_and_is_as_stiff():
    """It bears no force at its drawn height, and starts elastically; Ck 15, hardened by coiling, sets less."""
    coiled, free = analysis_of(), analysis_of(spring={**SPRING, "made_by": None})
    scale = np.array([1.0, 1.0, 1.0, 2.5, 2.5, 2.5])
    area = np.pi * 2.5**2
    assert np.abs(coiled.rod.coefficients.s / scale).max() < 1e-3 * area  # of 1 N/mm²
    assert np.abs(coiled.rod.surface_state[..., 0]).max() > 100.0
    results = [one.run() for one in (coiled, free)]
    summaries = [summarise(one.setup, run) for one, run in zip((coiled, free), results, strict=True)]
    assert summaries[0]["rate_N_per_mm"] == pytest.approx(summaries[1]["rate_N_per_mm"], rel=1e-9)
    assert 0.0 < summaries[0]["set_mm"] < 0.8 * summaries[1]["set_mm"]
    assert 36.0 < summaries[0]["coiling_diameter_mm"] < 40.0
    assert summaries[1]["coiling_diameter_mm"] is None


def test_work_beyond_the_materials_constants_is_that_of_coiling():
    """The first step only shows it: bent to D/d = 8, the wire has flowed by more than its curve is valid for."""
    analysis = analysis_of(material={"wire": "EN 10270-1 SH"})
    (warning,) = [one for one in run_warnings(analysis.setup, analysis.run()) if one.name == "plastic work"]
    assert warning.place == "the start"
    assert warning.message.endswith("only; exceeded since the start")


def test_the_inside_of_a_left_handed_coil_of_plane_sections_is_found():
    """Sections with a past have y towards the coil's axis: what remains is that of the mirrored spring, to rounding."""
    spring = {**PEENED, "made_by": "coiling"}
    plane = {"elements_per_turn": 8, "section": {"kind": "plane", "radial": 4, "angular": 12}}
    found = []
    for hand in ("right", "left"):
        analysis = analysis_of(spring={**spring, "hand": hand}, mesh=plane)
        found.append(summarise(analysis.setup, analysis.run()))
    for name in ("residual_shear_inside_MPa", "shear_inside_max_MPa"):
        assert found[1][name] == pytest.approx(found[0][name], rel=1e-6)
    name = "residual_shear_surface_max_angle_deg"
    assert found[1][name] == pytest.approx(-found[0][name], abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"material": "elastic"}, "spring.made_by: 'coiling' needs a wire that yields and keeps its shape"),
        ({"mesh": {"section": {"kind": "warping"}}}, "spring.made_by needs sections of fibres"),
        ({"mesh": {"axis": "chords", "section": {"kind": "plane"}}}, "coiling bends the wire to its axis"),
        ({"spring": PEENED, "mesh": {"section": {"kind": "warping"}}}, "spring.peening needs sections of fibres"),
        ({"spring": peened([0, 3], [-1, 0])}, "spring.peening.depth: goes down to 3 mm, below the wire's axis at 2.5"),
        ({"spring": peened([0, 1], [-1, 2])}, "spring.peening: the last value must be 0: the layer ends there"),
        ({"spring": peened([0, 1], [-1, 1, 0])}, "spring.peening: there are 2 depths, but 3 values"),
        ({"spring": peened([0.1, 1], [-1, 0])}, "spring.peening: depth must ascend from 0"),
        ({"spring": peened([0, 1], [-1, 0], strain=[0.1, 0])}, "spring.peening: give exactly one of strain or stress"),
        ({"spring": {**SPRING, "relieved": RELIEF}}, "spring.relieved: 'ck15' does not creep"),
        ({"spring": {**SPRING, "made_by": None, "relieved": RELIEF}}, "there is no stress to relieve"),
        (
            {"spring": {**SPRING, "relieved": {"temperature": 900.0, "minutes": 30.0}}, "material": "creeping"},
            "spring.relieved.temperature: 900 K is outside the table",
        ),
    ],
)
def test_what_cannot_be_coiled(changes, message):
    with pytest.raises(InputError) as caught:
        analysis_of(**changes)
    assert message in str(caught.value)


@pytest.mark.parametrize("spring", [SPRING, PEENED])
def test_a_slice_has_no_past(spring):
    with pytest.raises(InputError, match="a slice begins free of stress"):
        SliceAnalysis(check(CASE | {"spring": spring}))


@pytest.mark.parametrize("kind", ["curved", "plane"])
def test_a_peened_spring_stands_as_drawn(kind):
    """No section bears a force; at the surface is the stress that was asked for, less what the core takes of it."""
    mesh = {"elements_per_turn": 8, "section": {"kind": kind, "radial": 8, "angular": 12}}
    spring = analysis_of(spring=PEENED, mesh=mesh)
    scale = np.array([1.0, 1.0, 1.0, 2.5, 2.5, 2.5])
    assert np.abs(spring.rod.coefficients.s / scale).max() < 1e-3 * np.pi * 2.5**2
    layer = (
        2.0
        / 2.5**2
        * 200.0
        * sum(
            np.trapezoid(f * r, r)
            for r, f in ((np.linspace(2.3, 2.5, 100), 1.0), (np.linspace(1.9, 2.3, 100), np.linspace(0.0, 1.0, 100)))
        )
    )
    assert spring.rod.surface_state[..., 0].mean() == pytest.approx(layer - 200.0, abs=3.0)


def test_plane_sections_are_coiled_as_a_straight_bar_is():
    """With hardly any pitch the stress at the inside is that of the closed form with ε = κ y; it bears no force."""
    mesh = {"elements_per_turn": 8, "section": {"kind": "plane", "radial": 8, "angular": 20}}
    flat = {**SPRING, "pitch": 5.5}
    spring = analysis_of(
        mesh=mesh, spring=flat, material="linear_isotropic", loading=[{"to": {"travel": 0.1}, "steps": 1}]
    )
    scale, law = np.array([1.0, 1.0, 1.0, 2.5, 2.5, 2.5]), spring.law
    assert np.abs(spring.rod.coefficients.s / scale).max() < 1e-3 * np.pi * 2.5**2
    bar = Bar(law.yield_stress, law.E, law.E * 2000.0 / (law.E + 2000.0), 2.5)
    exact = bar.straight(0.05)[2]
    assert spring.rod.surface_state[4, 0, 0, 0] == pytest.approx(exact, rel=0.01)
    assert spring.rod.surface_state[4, 0, 12, 0] == pytest.approx(-exact, rel=0.01)


def test_relief_in_the_past_is_relief_in_the_load_program():
    """Coiled, relieved free of load, cooled: nearly the same stress at the inside either way.

    Between clamped ends the wire cannot unbend; a section with a past can, and is bent tighter before. How sections are
    relieved is judged by `tests/physics/manufacture/test_coiling.py`.
    """
    relieved = analysis_of(spring={**SPRING, "relieved": RELIEF}, material="creeping")
    program = [
        {"heat": {"to": 523.15, "minutes": 0.001, "keep": "force"}, "steps": 1},
        {"hold": {"minutes": 30, "keep": "force"}, "steps": 12},
        {"heat": {"to": 293.15, "minutes": 0.001, "keep": "force"}, "steps": 1},
    ]
    coiled = analysis_of(material="creeping", loading=program)
    before = coiled.rod.surface_state[4, 0, 0, 0].copy()
    coiled.run()
    after = [one.rod.surface_state[4, 0, 0, 0] for one in (relieved, coiled)]
    assert after[0] == pytest.approx(after[1], rel=0.08)
    assert max(after) < 0.8 * before
    scale = np.array([1.0, 1.0, 1.0, 2.5, 2.5, 2.5])
    assert np.abs(relieved.rod.coefficients.s / scale).max() < 1e-3 * np.pi * 2.5**2
    assert relieved.rod.clock[0] == 0.0


def test_several_back_stresses_remember_coiling():
    """The coiled section's states hold all back stresses, of which some saturated; the spring bears no force."""
    spring = analysis_of(material="chaboche")
    scale = np.array([1.0, 1.0, 1.0, 2.5, 2.5, 2.5])
    assert np.abs(spring.rod.coefficients.s / scale).max() < 1e-3 * np.pi * 2.5**2
    names = spring.rod.sections.components
    backs = [names.index(name) for name in names if name.startswith("B11")]
    assert len(backs) == 3
    assert (np.abs(spring.rod.surface_state[4, 0, 0, backs]) > 1.0).all()
