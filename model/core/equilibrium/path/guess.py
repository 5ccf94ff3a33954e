"""Where a step starts: an extrapolation of the last steps on the path.

With two steps it is of second order in their rates, with the rate at the end of the last step the parabola that has it;
at a kink of the path it is the last rate alone. docs/theory/equilibrium.md ("Where a step starts") has the equations.
"""

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.equilibrium.path.step_sizes import Position
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System

BEND = 0.05  # share of a step by the last rate that the change of rates may add to it; with more the path has a kink

FARTHEST = 0.5 * np.pi  # by which rates at its start may turn a section in a step: they are of no use for more


class Guess:
    """Guesses of a step's increments.

    Attributes:
        carried: whether rates are carried on with the sections.
        too_far: increments of a step that was given up for its error only, and its length.
        probed: increments under a load that was only tried from the last equilibrium, and that load.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.carried = False
        self.too_far: tuple[PETSc.Vec, float] | None = None
        self.probed: tuple[PETSc.Vec, Load] | None = None
        self._last = system.state["increments"]
        self._before = system.state["increments_before"]
        self._rates = dict(system.state.items()).get("rates")

    def remember(self, rate: PETSc.Vec | None = None) -> None:
        """The trial state is about to become the last equilibrium: its step, which ends with a `rate`, follows."""
        np.copyto(self._before.trial, self._last.equilibrium)
        if self._rates is not None:
            self._rates.trial[:] = 0.0 if rate is None else rate.getArray(readonly=True)

    def scaled_last(self, factor: float) -> PETSc.Vec:
        """The last step's increments times a factor."""
        guess = self.system.layout.vector(self._last.equilibrium.copy())
        guess.scale(factor)
        return guess

    def of(self, load: Load, position: Position, size: float) -> PETSc.Vec | None:
        """The best guess for a step of a size; None if nothing is known; collective.

        Where the error of a longer step was too large, its increments include contacts that have just closed, and the
        extrapolation does not: that with less force out of balance is taken.
        """
        if self.too_far is None:
            return self.along_path(load, position, size) if position.last else self._as_probed(load)
        guess, length = self.too_far
        shorter = guess.copy()
        shorter.scale(size / length)
        along = self.along_path(load, position, size)
        if along is None:
            return shorter
        return min(shorter, along, key=lambda start: self._out_of_balance(load, start))

    def _as_probed(self, load: Load) -> PETSc.Vec | None:
        """In proportion to what was probed, if the load prescribes an increment as that one did; collective."""
        if self.probed is None or not load.prescribed:
            return None
        guess, probe = self.probed
        differs = float(not np.array_equal(load.held, probe.held))  # on any rank: they take the same start
        if max_of_ranks(load.layout.comm, differs):
            return None
        guess = guess.copy()
        guess.scale(load.multiple_of(probe))
        return guess

    def along_path(self, load: Load, position: Position, size: float) -> PETSc.Vec | None:
        """The guess that goes on with the last steps; None if there is none on this path; collective."""
        last, earlier = position.before, position.earlier
        if not last:
            return None
        if self._rates is not None and max_of_ranks(load.layout.comm, float(self._rates.equilibrium.any())):
            return self._with_rate(self._rates.equilibrium, load, size / last)
        guess = self._rate(self._last.equilibrium, load, 1.0, 0.0, size / last)
        guess.scale(size / last)
        if earlier:
            difference = self._rate(self._before.equilibrium, load, earlier / last, 1.0, size / last)
            difference.scale(-size / earlier)
            difference.axpy(1.0, guess)
            difference.scale((size + last) / (earlier + last))
            kink = difference.norm() - BEND * guess.norm()
            if max_of_ranks(load.layout.comm, kink) <= 0.0:
                guess.axpy(1.0, difference)
        return guess

    def _with_rate(self, rates: np.ndarray, load: Load, ratio: float) -> PETSc.Vec:
        """The parabola with the rate at its last point; `ratio` of the step's size to that of the last one."""
        guess = self._rate(rates, load, 0.0, 0.0, ratio)
        bent = self._rate(self._last.equilibrium, load, 1.0, 0.0, ratio)
        bent.aypx(-1.0, guess)
        bent.scale(ratio)
        kink = bent.norm() - BEND * guess.norm()
        if max_of_ranks(load.layout.comm, kink) <= 0.0:
            guess.axpy(1.0, bent)
        guess.scale(ratio)
        return guess

    def from_rate(self, rates: PETSc.Vec, load: Load) -> PETSc.Vec | None:
        """A step from the last equilibrium by the rates there, which turn with the sections as they do in it.

        None if something turns by more than `FARTHEST`, as in a release in one step; collective.
        """
        layout, values = self.system.layout, rates.getArray(readonly=True)
        assert isinstance(layout, LineLayout)
        if max_of_ranks(layout.comm, layout.greatest_rotation(values)) > FARTHEST:
            return None
        return self._on(values, values, load, 0.0, 0.0, 1.0)

    def _rate(self, increments: np.ndarray, load: Load, of: float, gap: float, to: float) -> PETSc.Vec:
        """A step's increments, those of free unknowns carried on with the last step's rotations, as by `carry`."""
        if not self.carried:
            return self.system.layout.vector(increments.copy())
        return self._on(increments, self._last.equilibrium, load, of, gap, to)

    def _on(
        self, increments: np.ndarray, rotations: np.ndarray, load: Load, of: float, gap: float, to: float
    ) -> PETSc.Vec:
        layout, values = self.system.layout, increments.copy()
        assert isinstance(layout, LineLayout)
        layout.carry(values, rotations, of, gap, to)
        values[load.held] = increments[load.held]
        return layout.vector(values)

    def _out_of_balance(self, load: Load, start: PETSc.Vec) -> float:
        forces = start.duplicate()
        self.system.residual(start, load, 1.0, forces)
        forces.getArray()[load.held] = 0.0
        return max_of_ranks(load.layout.comm, forces.norm())
