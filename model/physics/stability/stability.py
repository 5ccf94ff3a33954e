"""Is an equilibrium stable? The sign of the tangent and its weakest mode; `branch_switching` leaves what is unstable.

A state of equilibrium is stable where the symmetric part of the tangent of the free unknowns is positive definite. By
Sylvester's law it has as many negative eigenvalues as its factors L U have negative pivots. Newton's own factors
show the signs of the pivots at the last iterate for nothing; where one of them is negative, and with methods that keep
a matrix, the symmetric part is factorised at the state itself.

With friction the tangent K is not symmetric, and its symmetric part is of no use: a sliding contact, whose traction
grows by μ c with the penetration and not with the slip, makes it indefinite by itself. A path loses its stability, as
the solution of M ẋ = −K x does, where a real eigenvalue of K passes zero; those nearest to zero are counted then.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from coilset.model.core.equilibrium.newton.iteration import Iteration
from coilset.model.core.equilibrium.system.factors import lu, negative_pivots
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.results.records.record import Result, Setup
from coilset.model.physics.stability.buckling import State, buckling, is_skipped

BLOCK = 4  # vectors of the inverse iteration: a double eigenvalue and its neighbours
ITERATIONS = 12
FURTHER = 4.0  # factor of a shift that leaves negative eigenvalues
APART = 0.5  # of a mode's greatest displacement: coils whose displacements differ by more move against each other


@dataclass(frozen=True)
class Weakest:
    """The weakest mode of a state.

    Attributes:
        negative: number of negative eigenvalues of the symmetric part of the tangent; with friction those real ones of
            the tangent that are among the `BLOCK` nearest to zero.
        value: least of the eigenvalues nearest to zero, N/mm, with rotations counted in coil radii.
        mode: increments whose maximum displacement is 1 mm.
    """

    negative: int
    value: float
    mode: PETSc.Vec


class Stability:
    """Judges the states that an iteration finds.

    Args:
        iteration: Iteration of a rod.
    """

    def __init__(self, iteration: Iteration) -> None:
        self.iteration, self.system, self.layout = iteration, iteration.system, iteration.system.layout

    def negative_pivots(self, load: Load) -> int:
        """Number of negative eigenvalues at the last evaluation; collective."""
        if self.iteration.negative_pivots() == 0:
            return 0
        if not self.system.is_symmetric:
            return self.weakest(load).negative
        with self._factorised(load) as found:
            return 0 if found is None else _negative(found[1])

    def weakest(self, load: Load) -> Weakest:
        """The weakest mode at the last evaluation; collective.

        Inverse iteration finds the eigenvalues nearest to zero. Where more of them are negative than it has found, as
        of a coil on the edge of another, it goes on with a matrix that is shifted until all of its are positive: the
        lowest ones are then the nearest.

        Where the law has found no stress, or the factors end at a pivot of zero, nothing is found: no negative one, and
        neither value nor mode is a number.
        """
        with self._factorised(load) as factorised:
            if factorised is None:
                nothing = self.layout.vector()
                nothing.set(math.nan)
                return Weakest(0, math.nan, nothing)
            matrix, factors = factorised
            scale = self.layout.vector(self.weights(load))
            values, block = self._nearest(matrix, factors, scale)
            found = int(np.count_nonzero(values < 0.0))
            negative = _negative(factors) if self.system.is_symmetric else found
            if negative > found:
                self._shift(matrix, factors, scale, float(np.abs(values).max()))
                values, block = self._nearest(matrix, factors, scale)
        mode = block[int(values.argmin())]
        mode.scale(1.0 / self.greatest_displacement(mode))
        return Weakest(negative, float(values.min()), mode)

    def weakest_now(self, setup: Setup, result: Result) -> Weakest | None:
        """The weakest mode at the last equilibrium, for a spring slender enough to buckle, until it buckles, else None;
        collective.

        Args:
            setup, result: records of the run so far.
        """
        if not setup.slender or buckling(result.steps, setup.spring.mean_diameter) is not None:
            return None
        return self.weakest(self.iteration.load)

    def in_words(self, turns: np.ndarray) -> str:
        """Where and how the wire gives way most easily at the last evaluation, empty if nothing is found; collective.

        Args:
            turns: of the stations, shape (n,).
        """
        mode = self.displacements(self.weakest(self.iteration.load).mode)
        return mode_in_words(mode, turns) if np.isfinite(mode).all() else ""

    def _nearest(self, matrix: PETSc.Mat, factors: PETSc.PC, scale: PETSc.Vec) -> tuple[np.ndarray, list[PETSc.Vec]]:
        """Eigenvalues of the tangent that are nearest to zero, or to the shift of the factors, and their modes."""
        block, right = self._start_block(), scale.duplicate()
        values = np.zeros(len(block))
        for _iteration in range(ITERATIONS):
            for vector in block:
                right.pointwiseMult(scale, vector)
                factors.apply(right, vector)
            before = block
            values, block = _rayleigh_ritz(matrix, scale, before, self.system.is_symmetric)
            _destroy(*before)
        _destroy(right)
        return values, block

    @staticmethod
    def overshoots(setup: Setup, result: Result, travel: float, force: float, offset: float) -> str | None:
        """Why a step shall be shorter: the spring buckles in it; None if not.

        Args:
            setup, result: records of the run so far.
            travel, force, offset: of the trial state, mm and N.
        """
        if is_skipped(result.steps, State(travel, force, offset), setup.spring.mean_diameter):
            return "the spring buckles in this step, and shorter ones show where"
        return None

    # ---- matrix ----------------------------------------------------------------------------------------------------

    @contextmanager
    def _factorised(self, load: Load) -> Iterator[tuple[PETSc.Mat, PETSc.PC] | None]:
        """The tangent at the last evaluation, without friction its symmetric part, and its factors; collective.

        None where there are no factors. Both are as large as the solver's own, and are freed at the end.
        """
        if not self.system.last.has_stress:
            yield None
            return
        tangent, symmetric = self.iteration.matrix, self.system.is_symmetric
        with self.system.body.judged():
            self.system.last_tangent(load, tangent, at_step_start=True)
        matrix = tangent.mat.copy()
        if symmetric:
            transposed = tangent.mat.copy()
            transposed.transpose()
            matrix.axpy(1.0, transposed)
            matrix.scale(0.5)
            _destroy(transposed)
        rows = (load.held + self.layout.start).astype(PETSc.IntType)
        matrix.zeroRowsColumns(rows, diag=self.system.body.constraint_weight)
        matrix.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
        factors = lu(matrix, tangent.ordering)
        factors.setUp()
        try:
            yield None if factors.getFailedReason() else (matrix, factors)
        finally:
            _destroy(factors, matrix)

    def _shift(self, matrix: PETSc.Mat, factors: PETSc.PC, scale: PETSc.Vec, shift: float) -> None:
        """Shift the matrix of the factors until all of its eigenvalues are positive."""
        while _negative(factors) and np.isfinite(shift):
            shift *= FURTHER
            shifted, diagonal = matrix.copy(), shift * scale
            shifted.setDiagonal(diagonal, addv=PETSc.InsertMode.ADD_VALUES)
            factors.setOperators(shifted)
            factors.setUp()
            _destroy(shifted, diagonal)  # the factors keep a reference of their own

    def weights(self, load: Load) -> np.ndarray:
        """Of this rank's free unknowns in a mode's norm, see Layout; 0 of the others."""
        return np.where(load.is_held, 0.0, self.layout.weights)

    def _start_block(self) -> list[PETSc.Vec]:
        """Vectors to begin with, the same on any number of ranks."""
        assert isinstance(self.layout, LineLayout)
        rng = np.random.default_rng(1)
        natural = [rng.normal(size=self.layout.size) for _vector in range(BLOCK)]
        return [self.layout.vector(self.layout.from_order(values).copy()) for values in natural]

    def displacements(self, mode: PETSc.Vec) -> np.ndarray:
        """Of the stations, shape (n, 3), mm; collective."""
        assert isinstance(self.layout, LineLayout)
        n = len(self.layout.station_dofs)
        return self.layout.to_order(mode.getArray(readonly=True))[: 6 * n].reshape(n, 6)[:, :3]

    def greatest_displacement(self, mode: PETSc.Vec) -> float:
        """Of the stations, mm; collective."""
        return float(np.linalg.norm(self.displacements(mode), axis=1).max())


def mode_in_words(mode: np.ndarray, turns: np.ndarray) -> str:
    """Where and how the wire gives way in a mode.

    Args:
        mode: displacements of the stations, shape (n, 3), mm.
        turns: of the stations, shape (n,).
    """
    at = int(np.linalg.norm(mode, axis=1).argmax())
    u, turn = mode[at], turns[at]
    way = "sideways" if np.hypot(u[0], u[1]) > abs(u[2]) else "up and down"
    beside = np.array([other for other in (turn - 1.0, turn + 1.0) if turns[0] <= other <= turns[-1]])
    apart = [float(np.linalg.norm(u - [np.interp(other, turns, v) for v in mode.T])) for other in beside]
    if not apart or max(apart) < APART * np.linalg.norm(u):
        return f"the spring as a whole gives way {way}, most at turn {turn:.2f}"
    pair = sorted((turn, beside[int(np.argmax(apart))]))
    return f"the coils at turns {pair[0]:.2f} and {pair[1]:.2f} give way against each other, {way}"


def _negative(factors: PETSc.PC) -> int:
    """Number of negative pivots of the factors of `lu`."""
    number = negative_pivots(factors)
    assert number is not None  # they are PETSc's own
    return number


def _destroy(*objects: PETSc.Object) -> None:
    """Free PETSc's objects now: on several ranks it keeps those that Python drops; collective."""
    for each in objects:
        each.destroy()


def _rayleigh_ritz(
    matrix: PETSc.Mat, scale: PETSc.Vec, block: list[PETSc.Vec], symmetric: bool
) -> tuple[np.ndarray, list[PETSc.Vec]]:
    """Eigenvalues of K v = λ M v in the span of a block, and its vectors, M = diag(scale); infinite, complex ones."""
    size = len(block)
    K, M = np.empty((size, size)), np.empty((size, size))
    image, weighted = scale.duplicate(), scale.duplicate()
    for j, right in enumerate(block):
        matrix.mult(right, image)
        weighted.pointwiseMult(scale, right)
        for i, left in enumerate(block):
            K[i, j], M[i, j] = left.dot(image), left.dot(weighted)
    _destroy(image, weighted)
    lengths = np.sqrt(np.diag(M))
    K, M = K / np.outer(lengths, lengths), M / np.outer(lengths, lengths)
    roots, axes = np.linalg.eigh(0.5 * (M + M.T))
    kept = roots > 1e-12 * roots.max()
    basis = axes[:, kept] / np.sqrt(roots[kept])
    reduced = basis.T @ K @ basis
    if symmetric:
        values, vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))
    else:
        roots, complex_vectors = np.linalg.eig(reduced)
        values, vectors = np.where(np.isreal(roots), roots.real, np.inf), complex_vectors.real
    combined = []
    for column in (basis @ vectors).T:
        vector = block[0].duplicate()
        for weight, part in zip(column / lengths, block, strict=True):
            vector.axpy(float(weight), part)
        combined.append(vector)
    return values, combined
