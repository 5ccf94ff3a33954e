"""What the finer path says about the error of section forces, against the law over the true path in 400 increments."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.meshes.springs.placement import straight
from coilset.model.core.body.state import State, Where
from coilset.model.core.material import library
from coilset.model.core.rod import section_states
from coilset.model.core.rod.elements import THESIS
from coilset.model.core.runtime import threads
from coilset.model.core.runtime.threads import Threads
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import polar
from coilset.model.physics.accuracy.finer_path import FinerPath
from coilset.model.physics.warping.warping import KNOWN

TWIST, BENDING = 3, 4  # of the section strains


def strains(time):
    """Twist to yielding, and bending that sets in smoothly: a path that bends."""
    e = np.zeros((1, 2, 6))
    e[..., TWIST], e[..., BENDING] = 2e-3 * time, 1.5e-3 * time**2
    return e


class Path:
    """Sections of elements with these radii, brought along a path of strains."""

    def __init__(self, radii=(2.5,), kind="plane", ground=(), number=1):
        law, place = library.load("ck15", spin=False), straight(len(radii))
        for cell in ground:
            place.flat[cell] = (0.2, 1.0, 0.0)
        self.sections = make_sections(
            kind, law, law.parameters(), polar(), np.array(radii), place, degree=2, threads=Threads(number)
        )
        self.state = State()
        self.strain = self.state.add("strain", np.zeros((len(radii), 2, 6)), Where.ELEMENT)
        self.points = {
            name: self.state.add(name, rows, Where.ELEMENT) for name, rows in self.sections.initial_state().items()
        }
        self.s, self.D = np.zeros((len(radii), 2, 6)), np.zeros((len(radii), 2, 6, 6))

    def to(self, strain):
        """On trial."""
        self.strain.trial[:] = strain
        start = {name: field.equilibrium for name, field in self.points.items()} | {"strain": self.strain.equilibrium}
        assert self.sections.update(strain, start, {name: f.trial for name, f in self.points.items()}, self.s, self.D)


def follower(path):
    """The finer path of all arrays of the path's sections on which forces depend."""
    names = [name for name in path.points if name != KNOWN]
    return FinerPath(path.sections, path.state, names, THESIS, MPI.COMM_SELF)


@pytest.mark.parametrize("steps", [4, 8])
def test_error_of_section_forces_is_known(steps):
    """Error of 1.1 % with four steps, 0.29 % with eight: estimated within 0.7 and 0.1 % of itself."""
    path = Path()
    finer = follower(path)
    for k in range(1, steps + 1):
        path.to(strains(k / steps))
        assert finer.follow(path.s, 1.0 if k > 1 else 0.0)
        path.state.commit()
    fine = Path()
    for time in np.linspace(0.0, 1.0, 401)[1:]:
        fine.to(strains(time))
        fine.state.commit()
    true, estimated = fine.s - path.s, path.state["section_force_error"].equilibrium
    for column in (TWIST, BENDING):
        assert abs(true[0, 0, column] / fine.s[0, 0, column]) == pytest.approx(0.16 / steps**2, rel=0.2)
        assert estimated[0, 0, column] == pytest.approx(true[0, 0, column], rel=0.01)


@pytest.mark.parametrize("part", [0.15, 0.5, 0.85])
def test_a_kink_within_a_step_is_found_where_it_is(part):
    """Flow in torsion, which ends after a part of the last step: the two parts meet at the kink, 4/3 of the error."""
    before, behind = np.zeros((2, 1, 2, 6))
    before[..., TWIST], behind[..., TWIST], behind[..., BENDING] = 4e-4, -1e-4, 1e-4
    start = 5.0 * before
    path = Path()
    finer = follower(path)
    path.to(start)
    assert finer.follow(path.s, 0.0, rate=before)
    path.state.commit()
    path.to(start + part * before + (1.0 - part) * behind)
    assert finer.follow(path.s, 1.0, kinked=True, rate=behind)
    forces, known = path.s.copy(), path.state["section_force_error"].trial
    fine = Path()
    turns = [*np.linspace(0.0, 1.0, 101)[1:, None, None, None] * start]
    turns += [start + share * part * before for share in np.linspace(0.0, 1.0, 101)[1:]]
    turns += [start + part * before + share * (1.0 - part) * behind for share in np.linspace(0.0, 1.0, 101)[1:]]
    for strain in turns:
        fine.to(strain)
        fine.state.commit()
    true = (fine.s - forces)[0, 0, TWIST]
    assert abs(true) > 0.01 * fine.s[0, 0, TWIST]
    assert known[0, 0, TWIST] / true == pytest.approx(4.0 / 3.0, rel=0.1)


@pytest.mark.parametrize("part", [-0.2, 1.2])
def test_lines_that_meet_beyond_a_step_show_no_kink_within_it(part):
    """The path does not go on along the first line to the end of the step, nor along the second one from its start."""
    before, behind, errors = np.zeros((1, 2, 6)), np.zeros((1, 2, 6)), []
    before[..., TWIST], behind[..., TWIST], behind[..., BENDING] = 4e-4, 3e-4, 1e-4
    for kinked in (False, True):
        path = Path()
        finer = follower(path)
        path.to(5.0 * before)
        finer.follow(path.s, 0.0, rate=before)
        path.state.commit()
        path.to(5.0 * before + part * before + (1.0 - part) * behind)
        finer.follow(path.s, 1.0, kinked=kinked, rate=behind)
        errors.append(path.state["section_force_error"].trial.copy())
    assert errors[0].any()
    assert np.array_equal(*errors)


def test_what_stays_elastic_has_no_error():
    path = Path()
    finer = follower(path)
    for k in (1, 2):
        path.to(0.05 * strains(0.5 * k))
        finer.follow(path.s, 1.0 if k > 1 else 0.0)
        path.state.commit()
    assert np.abs(path.state["section_force_error"].equilibrium).max() < 1e-12 * np.abs(path.s).max()
    assert finer.works(np.array([1.0])) == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-8)


@pytest.mark.parametrize("kind", ["plane", "warping"])
def test_many_elements_are_followed_block_by_block_and_side_by_side(monkeypatch, kind):
    """Also where grinding has cut the last sections, which no block begins with."""
    monkeypatch.setattr(threads, "LEAST", 1)
    radii, errors = np.linspace(2.0, 3.0, 5), []
    for block, number in ((2, 1), (64, 1), (64, 2), (2, 2)):
        monkeypatch.setattr(section_states, "BLOCK", block)
        path = Path(radii, kind, ground=(3, 4), number=number)
        finer = follower(path)
        for k in (1, 2):
            path.to(strains(0.5 * k))
            assert finer.follow(path.s, k - 1.0)
            path.state.commit()
        errors.append(path.state["section_force_error"].equilibrium)
    assert np.abs(errors[0]).max() > 1.0
    assert all(np.array_equal(errors[0], others) for others in errors[1:])


def test_step_that_is_given_up_leaves_no_trace():
    """The finer path lies where its start was: a step after one that was given up ends as if it were the first."""
    found = []
    for given_up in (False, True):
        path = Path()
        finer = follower(path)
        if given_up:
            path.to(strains(1.0))
            assert finer.follow(path.s, 0.0, final=False)
            assert path.state["finer_point_state"].equilibrium.any()
            path.state.restore()
            assert not path.state["finer_point_state"].equilibrium.any()
        for k in (1, 2):
            path.to(strains(0.5 * k))
            assert finer.follow(path.s, k - 1.0, final=False)
            path.state.commit()
            path.state.restore()  # of a later step: what is committed stays
        found.append(path.state.copy())
    assert np.abs(found[0]["finer_point_state"]).max() > 1.0
    assert all(np.array_equal(found[0][name], found[1][name]) for name in found[0])
