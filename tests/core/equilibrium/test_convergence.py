"""When an iteration is given up: stagnation can be found before the iterations end, and growth without bound."""

from types import SimpleNamespace

import pytest

from coilset.model.core.equilibrium.newton.convergence import EquilibriumTest, Imbalance, Reason, reason_in_words
from coilset.model.core.equilibrium.newton.iteration import CRAWL, CRAWLS, Iteration
from coilset.model.core.equilibrium.newton.methods import METHODS
from coilset.model.core.equilibrium.settings import NewtonControl

DIVERGENCE = 1e4


def lost(norms, stagnation):
    """Iteration and reason of giving up, for the norms of the residual from the start on; None if it goes on."""
    test = EquilibriumTest(1e-9, stagnation)
    test.begin(norms[0])
    for iteration, norm in enumerate(norms[1:], start=1):
        reason = test.is_lost(iteration, norm, DIVERGENCE)
        if reason is not None:
            return iteration, reason
    return None


@pytest.mark.parametrize("falling", [0, 5])
def test_stagnation_is_found_before_newtons_iterations_end(falling):
    """The default: after five falling residuals, too, one that then swings ends before PETSc's count of iterations."""
    norms = [0.5**k for k in range(falling + 1)]
    norms += [norms[-1] * (2.0 if k % 2 else 1.5) for k in range(METHODS["newton"]["snes_max_it"] - falling)]
    iteration, reason = lost(norms, NewtonControl().stagnation)
    assert iteration == falling + NewtonControl().stagnation < METHODS["newton"]["snes_max_it"]
    assert reason == Reason.DIVERGED_LOCAL_MIN
    assert "stagnates" in reason_in_words(reason)


def test_a_new_least_residual_is_waited_for_anew():
    assert lost([1.0, 2.0, 2.0, 0.9, 2.0, 2.0, 0.8, 2.0, 2.0], 3) is None
    assert lost([1.0, 2.0, 2.0, 0.9, 2.0, 2.0, 2.0], 3) == (6, Reason.DIVERGED_LOCAL_MIN)
    assert lost([1.0, 1.0, 1.0, 1.0], 3) == (3, Reason.DIVERGED_LOCAL_MIN)  # the same once more is not less


@pytest.mark.parametrize(
    ("norms", "met_at"),
    [
        ([1e-1, 1e-3, 1e-5, 1e-10], 3),  # falls on: ε of the change, 1 N, decides
        ([1e-1, 1e-3, 4e-6, 3e-6], 3),  # no longer halves, below 1e-7 of 100 N
        ([1e-1, 1e-3, 4e-5, 3e-5, 2.9e-5], None),  # above
        ([3e-6, 1e-6, 4e-7, 1e-7], None),  # halves
    ],
)
def test_forces_that_no_longer_halve_are_in_equilibrium_near_that(norms, met_at):
    """A step that changes 100 N by 1 N: where the law has kinks, forces jump by more than ε of that."""
    test = EquilibriumTest(1e-9, 24)
    test.begin(norms[0])
    met = [test.is_met(Imbalance(norm, 1.0, 100.0, 0.0), 1e-9, 0.0) for norm in norms]
    assert met == [index == met_at for index in range(len(norms))]
    test.begin(norms[0])  # the next solve begins anew
    assert not test.is_met(Imbalance(3e-6, 1.0, 100.0, 0.0), 1e-9, 0.0)


def test_the_end_of_an_iteration_may_be_near_enough():
    """Forces that jump by less than 1e-5 of 100 N, with the prescribed increments met."""
    test = EquilibriumTest(1e-9, 24)
    assert test.is_near(Imbalance(0.9e-3, 1.0, 100.0, 0.0))
    assert not test.is_near(Imbalance(1.1e-3, 1.0, 100.0, 0.0))
    assert not test.is_near(Imbalance(0.9e-3, 1.0, 100.0, 1e-8))


def test_growth_without_bound_ends_at_once():
    assert lost([1.0, 0.99 * DIVERGENCE, 0.5], 20) is None
    assert lost([1.0, 1.01 * DIVERGENCE], 20) == (1, Reason.DIVERGED_DTOL)


def test_corrections_of_which_nothing_is_left_are_given_up():
    """Eight in a row; one that is made to a hundredth, or by PETSc's own search, begins the count anew."""

    def crawls(lengths):
        iteration = SimpleNamespace(_step_length=None, _crawled=0)
        found = []
        for iteration._step_length in lengths:
            found.append(Iteration._crawls(iteration))
        return found

    short = 0.1 * CRAWL
    assert crawls([short] * CRAWLS) == [False] * (CRAWLS - 1) + [True]
    assert not any(crawls([*[short] * (CRAWLS - 1), CRAWL] * 3))
    assert not any(crawls([*[short] * (CRAWLS - 1), None] * 3))
