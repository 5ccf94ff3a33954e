"""What the last steps say about the next one."""

from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.core.body.state import State, Where
from coilset.model.core.equilibrium.path import guess as path_guess
from coilset.model.core.equilibrium.path.guess import Guess
from coilset.model.core.equilibrium.path.step_sizes import Position
from coilset.model.core.equilibrium.system.load import Load

LOAD = SimpleNamespace(held=np.array([], dtype=int), layout=SimpleNamespace(comm=MPI.COMM_SELF))
pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="needs no ranks")


class Line:
    """A body whose unknowns follow a given path; its force out of balance is the distance from a `target`."""

    def __init__(self, path):
        self.path, self.state, self.target = path, State(), None
        for name in ("increments", "increments_before"):
            self.state.add(name, np.zeros_like(path(0.0)), Where.UNKNOWN)
        self.layout = SimpleNamespace(vector=lambda values: PETSc.Vec().createWithArray(values, comm=MPI.COMM_SELF))

    def walk(self, guess, marks):
        """Take steps that end at these marks; the Position after them."""
        before = earlier = 0.0
        for start, end in zip([0.0, *marks], marks, strict=False):
            self.state["increments"].trial[:] = self.path(end) - self.path(start)
            guess.remember()
            self.state.commit()
            before, earlier = end - start, before
        return Position(marks[-1], last=before, before=before, earlier=earlier)

    def residual(self, increments, load, load_factor, forces):
        forces.getArray()[:] = increments.getArray() - self.target


@pytest.fixture(autouse=True)
def _bent_paths(monkeypatch):
    """A fifth of a step is no kink yet."""
    monkeypatch.setattr(path_guess, "BEND", 0.2)


def parabola(t):
    return np.array([3.0 * t, 1.0 + 2.0 * t + 0.05 * t * t, -0.03 * t * t])


def test_a_smooth_path_is_followed_exactly_to_second_order_whatever_the_sizes():
    line = Line(parabola)
    guess = Guess(line)
    position = line.walk(guess, [0.5, 1.7, 2.0])
    found = guess.of(LOAD, position, 0.8).getArray()
    assert found == pytest.approx(parabola(2.8) - parabola(2.0), abs=1e-14)
    assert np.abs(guess.scaled_last(0.8 / 0.3).getArray() - found).max() > 0.02


def test_at_a_kink_the_last_step_alone_counts():
    def kinked(t):
        return np.array([t, max(t - 1.0, 0.0)])

    line = Line(kinked)
    guess = Guess(line)
    position = line.walk(guess, [1.0, 2.0])
    assert guess.of(LOAD, position, 1.0).getArray() == pytest.approx([1.0, 1.0])


def test_the_first_step_of_a_path_has_no_guess_and_the_second_has_one_step_behind_it():
    line = Line(parabola)
    guess = Guess(line)
    assert guess.of(LOAD, Position(), 1.0) is None
    position = line.walk(guess, [1.0])
    assert guess.of(LOAD, position, 2.0).getArray() == pytest.approx(2.0 * (parabola(1.0) - parabola(0.0)))


def test_the_first_step_starts_in_proportion_to_what_was_probed_if_it_goes_to_a_height():
    layout, none = SimpleNamespace(comm=MPI.COMM_SELF), np.empty(0, int)

    def pressed(height):
        return Load(layout, np.array([0, 2]), np.array([0.0, height]), none, np.empty(0))

    line = Line(parabola)
    guess, tried = Guess(line), np.array([0.0, 0.4, -0.02])
    guess.probed = line.layout.vector(tried.copy()), pressed(-0.02)
    for height in (-0.5, 0.3):
        found = guess.of(pressed(height), Position(), 1.0).getArray()
        assert found == pytest.approx(height / -0.02 * tried, rel=1e-14)
    pulled = Load(layout, np.array([0]), np.zeros(1), np.array([2]), np.array([-3.0]))
    assert guess.of(pulled, Position(), 1.0) is None


def test_after_a_step_with_too_great_an_error_the_start_with_less_force_is_taken():
    line = Line(parabola)
    guess = Guess(line)
    position = line.walk(guess, [1.0, 2.0])
    along = parabola(2.5) - parabola(2.0)
    tried = np.array([8.0, 1.0, 2.0])
    for target, expected in ((along, along), (0.25 * tried, 0.25 * tried)):
        line.target = target
        guess.too_far = line.layout.vector(tried.copy()), 2.0
        cut = Position(position.done, cuts=1, before=position.before, earlier=position.earlier)
        assert guess.of(LOAD, cut, 0.5).getArray() == pytest.approx(expected, abs=1e-14)
    first = Position(cuts=1)
    assert guess.of(LOAD, first, 0.5).getArray() == pytest.approx(0.25 * tried)
