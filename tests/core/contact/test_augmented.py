"""Augmented Lagrange: penetration as small as is asked for, whatever the bedding; part of the state."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import check
from coilset.model.core.contact.coils import Coils
from coilset.model.core.results.files.checkpoint import Checkpoint

SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
TO_BLOCK_AND_BACK = [{"to": "block", "steps": 12}, {"to": {"force": 0.0}, "steps": 3}]


def analyse(**contact):
    data = {"spring": SPRING, "material": "ck15", "contact": contact, "loading": TO_BLOCK_AND_BACK, "accuracy": "none"}
    return Analysis(check(data), MPI.COMM_SELF)


def test_penetration_is_as_small_as_asked_for_whatever_the_bedding():
    """Soft beddings of 3000 and 1000 N/mm² come to one state.

    Without augmentation coils and seats sink in by 0.01 mm and more, and the sets differ by more than 0.3 %. With 5e-4
    mm at either seat and between the coils, 2e-4 of the set of 13 mm, they differ by 3e-4, in 12 to 48 steps.
    """
    found = {}
    for bedding in (3000.0, 1000.0):
        for penetration in (None, 5e-4):
            analysis = analyse(bedding=bedding, penetration=penetration)
            found[bedding, penetration] = summarise(analysis.setup, analysis.run())
            deepest = max(step.penetration_mm for step in analysis.result.steps)
            assert deepest <= 5e-4 if penetration else deepest > 0.01
    soft, hard = found[1000.0, None], found[3000.0, None]
    assert abs(soft["set_mm"] / hard["set_mm"] - 1.0) > 3e-3
    soft, hard = found[1000.0, 5e-4], found[3000.0, 5e-4]
    assert soft["set_mm"] == pytest.approx(hard["set_mm"], rel=4e-4)
    assert soft["force_max_N"] == pytest.approx(hard["force_max_N"], rel=1e-3)


def test_as_many_augmentations_as_are_allowed_are_made(monkeypatch):
    """A step whose last one brings the penetration down has arrived; with one less allowed it is given up."""
    analysis, made = analyse(bedding=300.0, penetration=1e-6), []
    augment = analysis.system.augment
    monkeypatch.setattr(analysis.system, "augment", lambda: (made.append(1), augment()))
    load = analysis.control.to_height(analysis.control.height - 10.0)
    assert analysis.newton.solve(load).converged
    needed = len(made)
    assert needed > 1
    for allowed in (needed, needed - 1):
        monkeypatch.setattr(analysis.newton, "control", replace(analysis.newton.control, augmentations=allowed))
        outcome = analysis.newton.solve(load)
        assert outcome.converged == (allowed == needed)
    told = f"mm is left after {needed - 1} augmentations, so the spring is probably solid"
    assert outcome.reason.endswith(told)


def test_stiffness_is_the_derivative_of_the_forces_of_offset_points(points, helix, dense):
    """Coils 0.1 mm apart, pressed as if up to 0.3 mm nearer: two thirds of the points bear though none has sunk in."""
    coils, x = Coils(points(), helix(12.0), 1e3, 0.005), helix(5.12, seed=1, noise=0.002)
    coils.memory["multiplier_offset"] = np.random.default_rng(3).uniform(0.0, 0.3, coils.overlap.shape)
    _, K, part = dense(coils, x, np.zeros(12))
    assert part.closed > 40
    assert part.penetration.max() < 0.0
    direction, h = np.random.default_rng(2).normal(size=x.shape), 1e-6
    one, other = (dense(coils, x + s * h * direction, np.zeros(12))[0] for s in (1, -1))
    n = x.size
    np.testing.assert_allclose(
        K[:, :n] @ direction.ravel(), (one - other) / (2 * h), rtol=0, atol=1e-6 * np.abs(K).max()
    )


def test_offsets_are_part_of_the_state(tmp_path):
    """A run resumed at its third step ends as the undisturbed one does, bit by bit; a failed step leaves no trace."""
    whole = analyse(bedding=5250.0, penetration=1e-3)
    whole.run()

    class Stop(Exception):
        pass

    def stop(step):
        if step.number == 6:
            raise Stop

    first = analyse(bedding=5250.0, penetration=1e-3)
    with pytest.raises(Stop):
        first.run(stop, Checkpoint(tmp_path, first.case).save)
    seat = next(contact for contact in first.system.contacts if contact.end == "top")
    committed = seat.memory.committed("multiplier_offset").copy()
    assert committed.max() > 0.0
    first.system.augment()
    assert np.any(seat.memory["multiplier_offset"] != committed)
    first.system.restore()
    np.testing.assert_array_equal(seat.memory["multiplier_offset"], committed)

    second = analyse(bedding=5250.0, penetration=1e-3)
    second.resume(Checkpoint(tmp_path, second.case).load(second.comm))
    second.run()
    assert [step.force_N for step in second.result.steps] == [step.force_N for step in whole.result.steps]
    np.testing.assert_array_equal(second.result.snapshots[-1].x, whole.result.snapshots[-1].x)
