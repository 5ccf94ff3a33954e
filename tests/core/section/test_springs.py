"""Whole springs with each kind of section: what is asked for, what comes out, and going on after a stop."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.core.results.files.checkpoint import Checkpoint

PROGRAM = "loading=[{to: {travel: 8}, steps: 3}, {to: {force: 0}, steps: 2}]"
COARSE = ["mesh.elements_per_turn=8", "ends=clamped", "accuracy=none", PROGRAM]


def press(example, kind, *settings):
    analysis = Analysis(read_case(example, [*COARSE, f"mesh.section.kind={kind}", *settings]), MPI.COMM_SELF)
    return analysis, summarise(analysis.setup, analysis.run())


@pytest.mark.parametrize("kind", ["plane", "curved", "warping"])
def test_left_and_right_handed_coils_bear_the_same(example, kind):
    """Mirror images: the same set, and the same shear at the inside, positive under load and negative after it."""
    found = [press(example, kind, f"spring.hand={hand}")[1] for hand in ("right", "left")]
    for name in ("set_mm", "force_max_N", "shear_inside_max_MPa", "residual_shear_inside_MPa"):
        assert found[1][name] == pytest.approx(found[0][name], rel=1e-6), name
    assert found[0]["residual_shear_inside_MPa"] < -20.0
    assert 100.0 < found[0]["shear_inside_max_MPa"] <= found[0]["shear_surface_max_MPa"]


def test_kinds_differ_as_the_curvature_makes_them(example):
    """Of D/d = 8: residual shear inside is a third greater with the curvature than without, and warping changes 1 %."""
    plane, curved, warping = (
        press(example, kind)[1]["residual_shear_inside_MPa"] for kind in ("plane", "curved", "warping")
    )
    assert 1.2 < curved / plane < 1.5
    assert warping == pytest.approx(curved, rel=0.02)


def test_greatest_residual_shear_is_a_number_of_the_spring(example):
    """Between 4 × 12 and 8 × 20 points it changes by less than 1 %; the ends' is named apart, with its place."""
    rules = ({"radial": 4, "angular": 12}, {"radial": 8, "angular": 20})
    few, many = (press(example, "curved", f"mesh.section={rule}")[1] for rule in rules)
    for name in ("residual_shear_max_MPa", "residual_shear_ends_max_MPa", "shear_max_MPa"):
        assert few[name] == pytest.approx(many[name], rel=0.01), name
    assert many["residual_shear_surface_max_MPa"] == pytest.approx(
        max(many["residual_shear_max_MPa"], many["residual_shear_ends_max_MPa"]), rel=1e-12
    )
    assert abs(many["residual_shear_inside_MPa"]) <= many["residual_shear_max_MPa"]
    turn = many["residual_shear_ends_max_turn"]
    assert turn < 1.0 or turn > 1.5


def test_half_a_turn_has_no_ends(example):
    """All of it is its middle; a spring of a turn has both."""
    for turns, has_ends in ((0.5, False), (1.0, True)):
        summary = press(example, "curved", f"spring.turns={turns}", "loading.0.to.travel=1")[1]
        ends = [value for name, value in summary.items() if name.startswith("residual_shear_ends")]
        assert (ends != [None] * 3) == has_ends
        greatest = max(summary["residual_shear_max_MPa"], ends[0] or 0.0)
        assert summary["residual_shear_surface_max_MPa"] == greatest


class Stop(Exception):
    pass


def test_a_stopped_press_with_warping_goes_on_to_the_same_bits(example, tmp_path):
    whole, _ = press(example, "warping")
    checkpoint = Checkpoint(tmp_path, whole.case)

    def stop(step):
        if step.number == 2:
            raise Stop

    with pytest.raises(Stop):
        Analysis(whole.case, MPI.COMM_SELF).run(stop, checkpoint.save)
    resumed = Analysis(whole.case, MPI.COMM_SELF)
    resumed.resume(checkpoint.load(MPI.COMM_SELF))
    resumed.run()
    assert resumed.result.steps == whole.result.steps
    for name, field in whole.rod.state.items():
        np.testing.assert_array_equal(resumed.rod.state[name].equilibrium, field.equilibrium)


@pytest.mark.mpi
@pytest.mark.parametrize("kind", ["curved", "warping"])
def test_ranks_agree(example, kind):
    """All ranks together, and each by itself: forces, section points, surface and warping."""
    case = read_case(example, [*COARSE, f"mesh.section.kind={kind}"])
    together, alone = (Analysis(case, comm) for comm in (MPI.COMM_WORLD, MPI.COMM_SELF))
    a, b = together.run(), alone.run()
    forces = [np.array([step.force_N for step in run.steps]) for run in (a, b)]
    np.testing.assert_allclose(forces[0], forces[1], rtol=0, atol=1e-10 * np.abs(forces[1]).max())
    if MPI.COMM_WORLD.rank == 0:
        for name in ("point_state", "surface_state"):
            ours, reference = (getattr(run.snapshots[-1], name) for run in (a, b))
            np.testing.assert_allclose(ours, reference, rtol=0, atol=1e-9 * np.abs(reference).max())
    if kind == "warping":
        ours, reference = (one.rod.state["warping"].equilibrium for one in (together, alone))
        by_element = reference[np.argsort(alone.rod.line.element)]
        mine = by_element[together.rod.line.element[: len(ours)]]
        np.testing.assert_allclose(ours, mine, rtol=0, atol=1e-9 * np.abs(reference).max())


@pytest.mark.parametrize(
    ("setting", "place"),
    [
        ("mesh={axis: chords, section: {kind: curved}}", "mesh"),
        ("mesh.section={kind: warping, radial: 1}", "mesh.section"),
        ("mesh.section={kind: warping, degree: 5, rule: abramowitz9}", "mesh.section"),
        ("mesh.section.kind=round", "mesh.section.kind"),
        ("mesh.section.degree=0", "mesh.section.degree"),
    ],
)
def test_what_does_not_go_together_is_refused(example, setting, place):
    with pytest.raises(InputError) as refused:
        read_case(example, [setting])
    assert refused.value.place == place
