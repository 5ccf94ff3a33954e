"""A copy of the rod's sections that follows the same strains in finer increments, to estimate the error of the steps.

A step integrates the law along a straight strain path. This causes two errors of second order: the law's own, and that
of the path, which is really curved. After each step the sections therefore follow the step's strains again, from their
own previous state, in two parts. On a smooth path these are halves, which meet on the parabola with the rates e₀′ and
e₁′ of the step's start and end: its middle deviates from the chord by h (e₀′ − e₁′)/8. The steps' tangents give these
rates; where one is missing, as while time passes, the parabola through the strains at the last three equilibria is
taken. Where coils or seats close or open, the path has a kink within the step. Two straight lines with these rates meet
at the part θ of the step that fits its increment best, Δ = θ h e₀′ + (1 − θ) h e₁′, and so do the two parts, where the
longer one of the lines ends; if θ is not within the step, it has no kink. This divides the law's error and the area
between path and chord by 4, so that

    s* − s ≈ 4/3 (s_finer − s)

is the error of the section forces. Errors that plastic flow erases are erased here, too.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.body.state import State, Where
from coilset.model.core.rod.elements import Element
from coilset.model.core.rod.section_states import CLOCKS, in_blocks, of_cells
from coilset.model.core.runtime.kernels import njit
from coilset.model.core.section.sections import Sections

if TYPE_CHECKING:  # a solve loads MPI in another thread meanwhile
    from mpi4py import MPI


class FinerPath:
    """The sections along the finer path.

    Args:
        sections: of the rod.
        state: the rod's State; the finer path's fields are added to it: the increments of `strain` in the step
            and in the first one of all, the sections' arrays with `finer_` before their names, and the error of the
            section forces.
        names: of the sections' arrays that are followed.
        element: Element, whose weights the sections have.
        comm: MPI communicator of the rod.
    """

    def __init__(
        self, sections: Sections, state: State, names: Iterable[str], element: Element, comm: "MPI.Comm"
    ) -> None:
        self._state, self._strain, self._comm = state, state["strain"], comm
        self._weights, shape = np.array(element.weights), self._strain.trial.shape
        self._increment = state.add("strain_increment", np.zeros(shape), Where.ELEMENT)
        self._rate = state.add("strain_rate", np.zeros(shape), Where.ELEMENT)  # times the step's size; 0: not known
        self._first = state.add("first_strain_increment", np.zeros(shape), Where.ELEMENT)
        self._error = state.add("section_force_error", np.zeros(shape), Where.ELEMENT)
        self._fields = {
            name: state.add(f"finer_{name}", state[name].equilibrium.copy(), Where.ELEMENT, in_place=True)
            for name in names
        }
        # the path's end takes the place of its start, which is not needed any more then
        self._end = {name: field.equilibrium for name, field in self._fields.items()}
        self._blocks, self._lost = list(in_blocks(sections)), False
        longest = max((cells.stop - cells.start for cells, _ in self._blocks), default=0)
        self._on_the_way = {name: values[:longest].copy() for name, values in self._end.items()}
        self._start = self._end | {"strain": self._strain.equilibrium}
        if "clock" in state:
            clock, halfway = (state[name] for name in CLOCKS)
            self._start["clock"], self._end["clock"] = clock.equilibrium, clock.trial
            self._on_the_way["clock"] = halfway.trial

    def follow(
        self,
        s: np.ndarray,
        ratio: float,
        kinked: bool = False,
        final: bool = True,
        rate: np.ndarray | None = None,
    ) -> bool:
        """Advance the finer path to the trial strains.

        Args:
            s: trial section forces, shape (cells, sections, 6), N and N mm.
            ratio: size of the step over that of the one before it on the same path, 0 if there is none.
            kinked: whether the path has a kink within the step.
            final: whether the step is committed in any case.
            rate: of the strains at the end of the step, times its size; None if it is not known.

        Returns:
            False if the law found no solution on this rank: the finer path then continues from the end of the step
            itself once that is committed, see `catch_up`, and the error is not changed.
        """
        strain, change = self._strain, self._strain.trial - self._strain.equilibrium
        middle = strain.equilibrium + self._halfway(change, ratio, rate, kinked)
        self._increment.trial[:] = change
        self._rate.trial[:] = 0.0 if rate is None else rate
        if not self._first.equilibrium.any():
            self._first.trial[:] = change
        if not final:
            for name in self._fields:
                self._state.overwrite(f"finer_{name}")
        good = all(self._follow(*block, middle, s) for block in self._blocks)
        self._lost = not good
        if self._lost:
            self._error.trial[:] = self._error.equilibrium
        return good

    def _halfway(self, change: np.ndarray, ratio: float, end: np.ndarray | None, kinked: bool) -> np.ndarray:
        """Strains since the start of the step where its two parts meet; collective.

        Args:
            change: of the strains in the step.
            ratio, end, kinked: as in `follow`.
        """
        start, comm = ratio * self._rate.equilibrium, self._comm
        if end is None or not sum_of_ranks(comm, float(start.any())):
            return 0.5 * change + 0.25 * ratio / (1.0 + ratio) * (ratio * self._increment.equilibrium - change)
        turn = start - end
        size, along = (sum_of_ranks(comm, float(np.vdot(turn, other))) for other in (turn, change - end))
        if not kinked or not 0.0 < along < size:
            return 0.5 * change + 0.125 * turn
        part = along / size
        away = part * (start - change) if part > 0.5 else (1.0 - part) * (change - end)
        return part * change + away

    def catch_up(self) -> None:
        """Continue from the end of a step, which is committed, if the law found no solution in it."""
        if self._lost:
            self.restart()

    def _follow(self, cells: slice, sections: Sections, middle: np.ndarray, s: np.ndarray) -> bool:
        """Advance a block of cells over `middle`, all cells' strains there, and write their errors."""
        strain, size = self._strain, cells.stop - cells.start
        forces = np.empty((size, *strain.trial.shape[1:]))
        D = np.empty((*forces.shape, 6))
        half, reached = of_cells(self._on_the_way, slice(size)), middle[cells]
        start, end = of_cells(self._start, cells), of_cells(self._end, cells)
        good = sections.update(reached, start, half, forces, D, False)
        good = good and sections.update(strain.trial[cells], half | {"strain": reached}, end, forces, D, False)
        if good:
            self._error.trial[cells] = (forces - s[cells]) / 0.75
        return bool(good)

    def restart(self) -> None:
        """Continue from the sections' own last equilibrium; the error so far is not changed."""
        for name, field in self._fields.items():
            field.equilibrium[:] = self._state[name].equilibrium

    def works(self, length: np.ndarray) -> tuple[float, float, float, float]:
        """Works of the error of the section forces, at the end of a step and before its commit.

        Args:
            length: of the rank's own elements, shape (cells,), mm.

        Returns:
            Four works: of the error on the step's deformation; of the share of the error that this step added, on the
            step's deformation and on that of the very first step; of the whole error on the latter. For this rank's
            cells, N mm.
        """
        error = self._error
        return _works(length, self._weights, error.trial, error.equilibrium, self._increment.trial, self._first.trial)


@njit(cache=True)
def _works(
    length: np.ndarray,
    weights: np.ndarray,
    error: np.ndarray,
    before: np.ndarray,
    now: np.ndarray,
    first: np.ndarray,
) -> tuple[float, float, float, float]:
    """Works of the error on the increments `now`, of what is new in it on these and on the `first`, of all on these."""
    own = new_own = left = error_left = 0.0
    for c in range(len(length)):
        for g in range(len(weights)):
            weight = weights[g] * length[c]
            for k in range(6):
                force, new = weight * error[c, g, k], weight * (error[c, g, k] - before[c, g, k])
                own += force * now[c, g, k]
                new_own += new * now[c, g, k]
                left += new * first[c, g, k]
                error_left += force * first[c, g, k]
    return own, new_own, left, error_left
