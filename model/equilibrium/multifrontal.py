"""A partial sparse LU factorisation.

With the eliminated unknowns i and the kept unknowns s it computes the factors of A_ii and

    S = A_ss − A_si A_ii⁻¹ A_is.

PETSc's own LU eliminates all unknowns; S would then cost one solve for every kept unknown. As in PETSc, there is no
pivoting. The pivots of a symmetric matrix have the signs of its eigenvalues (Sylvester), and the numbers of negative
ones of A_ii and of S add up to that of A (Haynsworth).
"""

import numpy as np
from numba import njit

from coilset.model.equilibrium.dense_front import PANEL, ROWS, TILE, eliminate_pivots
from coilset.model.equilibrium.elimination import Plan

NONE = np.empty(0)


class PartialLU:
    """Factors of matrices with one pattern.

    Args:
        plan: Plan.

    Attributes:
        schur: S, shape (kept, kept), in the order of the last places of the plan.
        negative_pivots: of A_ii.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan, self.negative_pivots = plan, 0
        self.schur = np.zeros((plan.kept, plan.kept))
        k, m = np.diff(plan.first)[:-1], np.diff(plan.rest_start)[:-1]
        self._factors = np.empty(int((k * (k + 2 * m)).sum()))
        self._work = np.empty(int(((k + m) ** 2).max(initial=0)))
        self._stack = np.empty(plan.stack)
        self._places = np.empty(len(plan.order))

    def factorise(self, values: np.ndarray, behind: np.ndarray = NONE) -> bool:
        """Eliminate; False if a pivot is zero or NaN.

        Args:
            values: entries of the matrix in the order of the pattern.
            behind: those that follow, if they lie elsewhere.
        """
        p = self.plan
        self.negative_pivots = eliminate(
            p.first,
            p.rest_start,
            p.into,
            p.child_start,
            p.child,
            p.entry_start,
            p.entry,
            p.position,
            values,
            behind,
            self._work,
            self._stack,
            self._factors,
            self.schur,
        )
        return self.negative_pivots >= 0

    def forward(self, right: np.ndarray) -> np.ndarray:
        """b_s − A_si A_ii⁻¹ b_i, the right side of S's equations; the rest of it is kept for `backward`."""
        np.take(right, self.plan.order, out=self._places)
        go_forward(self.plan.first, self.plan.rest_start, self.plan.rest, self._factors, self._places)
        return self._places[len(self._places) - self.plan.kept :].copy()

    def backward(self, kept: np.ndarray, out: np.ndarray) -> None:
        """Write the solution into `out`, given that of the kept unknowns."""
        self._places[len(self._places) - len(kept) :] = kept
        go_backward(self.plan.first, self.plan.rest_start, self.plan.rest, self._factors, self._places)
        out[self.plan.order] = self._places


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def eliminate(
    first: np.ndarray,
    rest_start: np.ndarray,
    into: np.ndarray,
    child_start: np.ndarray,
    child: np.ndarray,
    entry_start: np.ndarray,
    entry: np.ndarray,
    position: np.ndarray,
    values: np.ndarray,
    behind: np.ndarray,
    work: np.ndarray,
    stack: np.ndarray,
    factors: np.ndarray,
    schur: np.ndarray,
) -> int:
    """Factors of all fronts, each k rows of U over m rows of L; number of negative pivots, −1 if one is unusable."""
    fronts, top, written, negative = len(first) - 1, 0, 0, 0
    tiles = np.empty((PANEL + ROWS) * TILE)
    for f in range(fronts):
        k, m = first[f + 1] - first[f], rest_start[f + 1] - rest_start[f]
        w, last = k + m, f == fronts - 1
        F = schur.reshape(schur.size) if last else work[: w * w]
        F[:] = 0.0
        for e in range(entry_start[f], entry_start[f + 1]):
            at = entry[e]
            F[position[e]] = values[at] if at < len(values) else behind[at - len(values)]
        for number in range(child_start[f + 1] - 1, child_start[f] - 1, -1):
            c = child[number]
            size = rest_start[c + 1] - rest_start[c]
            top -= size * size
            rows = into[rest_start[c] : rest_start[c + 1]]
            for i in range(size):
                for j in range(size):
                    F[rows[i] * w + rows[j]] += stack[top + i * size + j]
        if last:
            break
        block = F.reshape((w, w))
        found = eliminate_pivots(block, k, tiles)
        if found < 0:
            return -1
        negative += found
        factors[written : written + k * w] = F[: k * w]
        written += k * w
        for i in range(k, w):
            factors[written : written + k] = block[i, :k]
            written += k
        for i in range(k, w):
            stack[top : top + m] = block[i, k:]
            top += m
    return negative


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def go_forward(first: np.ndarray, rest_start: np.ndarray, rest: np.ndarray, factors: np.ndarray, x: np.ndarray) -> None:
    """L⁻¹ b of the eliminated places, and what it leaves of the others, in place."""
    at = 0
    for f in range(len(first) - 2):
        begin, k, m = first[f], first[f + 1] - first[f], rest_start[f + 1] - rest_start[f]
        w = k + m
        for i in range(1, k):
            total = 0.0
            for j in range(i):
                total += factors[at + i * w + j] * x[begin + j]
            x[begin + i] -= total
        at += k * w
        for i in range(m):
            total = 0.0
            for j in range(k):
                total += factors[at + i * k + j] * x[begin + j]
            x[rest[rest_start[f] + i]] -= total
        at += m * k


@njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def go_backward(
    first: np.ndarray, rest_start: np.ndarray, rest: np.ndarray, factors: np.ndarray, x: np.ndarray
) -> None:
    """U⁻¹ of the eliminated places, where the others are known, in place."""
    at, beyond = len(factors), np.empty(len(x))
    for f in range(len(first) - 3, -1, -1):
        begin, k, m = first[f], first[f + 1] - first[f], rest_start[f + 1] - rest_start[f]
        w = k + m
        at -= k * (w + m)
        for j in range(m):  # side by side, as registers take them
            beyond[j] = x[rest[rest_start[f] + j]]
        for i in range(k - 1, -1, -1):
            row, total = at + i * w, x[begin + i]
            for j in range(m):
                total -= factors[row + k + j] * beyond[j]
            for j in range(i + 1, k):
                total -= factors[row + j] * x[begin + j]
            x[begin + i] = total / factors[row + i]
