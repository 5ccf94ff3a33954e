"""Contacts on ranks: what each rank evaluates from nearby stations is what all stations together give it."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.core.contact.base import TrialPositions

pytestmark = pytest.mark.mpi
COMM = MPI.COMM_WORLD
SHAPE = [
    "spring.turns=30",
    "spring.pitch=6",
    "mesh.section.radial=2",
    "mesh.section.angular=6",
    "loading=[{to: {travel: 1}}]",
]
KINDS = {
    "flat": ["seats.bottom.shape=stepped", "seats.bottom.turns=0.8", "contact.friction={seats: 0.1, coils: 0.1}"],
    "moving": ["seats={hold: groove, top: {tilt: free}, bottom: {shape: conical, angle: 5}}"],
}
PRESSED = 0.8, 0.004  # height over the free one: coils overlap by up to 0.2 mm; the wire is bent by some hundredths


@pytest.fixture(scope="module", params=[(kind, per_turn) for kind in KINDS for per_turn in (10, 90)], ids=str)
def pressed(request, example):
    """An analysis with its trial state squeezed, bent and turned, and the same state on every rank."""
    kind, per_turn = request.param
    analysis = Analysis(read_case(example, [*SHAPE, *KINDS[kind], f"mesh.elements_per_turn={per_turn}"]), COMM)
    system, x0 = analysis.system, analysis.rod.line.stations
    n, rng = len(x0), np.random.default_rng(2)
    along = np.linspace(0.0, 1.0, n)[:, None]
    waves = np.sin(2 * np.pi * along * np.arange(3, 9)) @ rng.normal(scale=PRESSED[1], size=(6, 6))
    x, rotations = x0 * [1.0, 1.0, PRESSED[0]] + waves[:, :3], waves[:, 3:]
    seats = system.seats + rng.normal(scale=1e-3, size=12)
    seats[8] = x[-1, 2] + seats[8] - x0[-1, 2] - 0.02
    seats[2] += x[0, 2] - x0[0, 2] + 0.02
    for contact in analysis.system.contacts:
        if contact.multiplier_offset is not None:
            contact.multiplier_offset[...] = np.abs(rng.normal(scale=2e-3, size=contact.multiplier_offset.shape))
    return analysis, x, seats, rotations


def nearby(analysis, x, seats, rotations):
    """The state with what a rank evaluates of it."""
    node = analysis.rod.line.node
    return analysis.system.touching.trial(x[node], seats, rotations[node])


def rows(analysis, part):
    """Forces and stiffness on this rank's unknowns, dense."""
    layout = analysis.layout
    dofs = layout.contact_dofs[part.dofs]
    forces, stiffness = np.zeros(layout.size), np.zeros(layout.size)
    direction = np.random.default_rng(7).normal(size=layout.size)
    np.add.at(forces, dofs, part.forces)
    np.add.at(stiffness, dofs, np.einsum("mij,mj->mi", part.stiffness, direction[dofs]))
    return forces[layout.start : layout.stop], stiffness[layout.start : layout.stop]


def test_each_rank_finds_what_acts_on_its_unknowns(pressed):
    """Forces and stiffness of all kinds, and the number of elements, each counted on one rank."""
    analysis, *state = pressed
    layout, trial, whole = analysis.layout, nearby(*pressed), TrialPositions(*state)
    for contact in analysis.system.contacts:
        expected, found = contact.evaluate(whole), contact.evaluate(trial)
        for own, all_of_them in zip(rows(analysis, found), rows(analysis, expected), strict=True):
            size = COMM.allreduce(np.abs(all_of_them).max(initial=0.0), op=MPI.MAX)
            assert size > 0.0
            np.testing.assert_allclose(own, all_of_them, rtol=0, atol=1e-13 * size, err_msg=contact.name)
        acting = found.only(layout.acts_here(found.dofs))
        counted = acting.only(layout.begins_here(acting.dofs))
        assert COMM.allreduce(len(counted.pressure)) == len(expected.pressure)
        assert COMM.allreduce(counted.closed) == expected.closed


@pytest.mark.skipif(COMM.size == 1, reason="one rank takes all")
def test_a_rank_evaluates_only_what_is_near(pressed):
    """Beside its own coils some of the next parts; the last rank also the end coil on the other seat."""
    analysis, x, *_ = pressed
    if analysis.case.seats.top.moves:
        pytest.skip("on a cone the last rank takes more than the end coil")
    part = nearby(*pressed).part
    share = (part.elements[:, 1] - part.elements[:, 0]).sum() / len(x)
    assert 1.0 / COMM.size < share < 1.0 / COMM.size + 0.4 < 1.0


def test_what_ranks_know_at_their_own_stations_all_know_after_it_is_shared(pressed):
    """As for the tractions of friction, which the next step needs wherever coils have moved to."""
    analysis, *state = pressed
    for contact in analysis.system.contacts:
        if "friction" in contact.name:
            contact.evaluate(TrialPositions(*state))
            expected = contact.memory["traction"].copy()
            contact.evaluate(nearby(*pressed))
            analysis.system.touching.share(contact.memory, ["traction", "x"])
            np.testing.assert_allclose(contact.memory["traction"], expected, rtol=0, atol=1e-13 * expected.max())
            np.testing.assert_array_equal(contact.memory["x"], state[0])
