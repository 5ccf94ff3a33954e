"""The law over arrays of points from Python, without a mesh: one interface to both forms."""

import math
from typing import Any

import numpy as np

from coilset.model.base.errors import InputError, SolveError
from coilset.model.base.kernel import KERNEL
from coilset.model.material.law.functions import CHANGE
from coilset.model.material.law.law import Law
from coilset.model.material.law.parts import Parts
from coilset.model.material.point.choice import advance_points, solid_point
from coilset.model.material.point.local import FAILED, TOO_HOT
from coilset.model.runtime.kernels import njit

SMALLEST_SUBSTEP = 1e-9


@njit(**KERNEL)
def _solid(
    law: Any, state: np.ndarray, increments: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> None:
    for i in range(state.shape[0]):
        count[i] = solid_point(law, state[i], increments[i], new[i], tangent[i])


def initial_state(law: Law, points: int, components: int = 3, temperature: float | None = None) -> np.ndarray:
    """Point states of unstressed points.

    Args:
        law: a `Law`.
        points: their number.
        components: 3 for the rod, 6 for the full stress state.
        temperature: K, where the rows hold one (adiabatic heating); default is the reference temperature.

    Returns:
        Shape (points, 7) or (points, 13), one column more (the temperature) with adiabatic heating, one set of columns
        more for each back stress after the first.
    """
    state = np.zeros((points, law.columns(components)))
    if law.is_adiabatic:
        state[:, 2 * components + 1] = law.reference_temperature if temperature is None else law.known(temperature)
    return state


def update(
    law: Law,
    state: np.ndarray,
    increments: np.ndarray,
    temperature: float | tuple[float, float] | None = None,
    tolerance: float | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Advance points by strain increments, without time; a pure function.

    The exponential return map (`point.local`) integrates k², ζ and κ; a changing temperature and all else that the
    material has, the point problem (`point.stage`).

    Args:
        law: a `Law`.
        state: the points' states, see `initial_state`.
        increments: ε11, γ12, γ13, shape (points, 3), or ε11, ε22, ε33, γ12, γ13, γ23, shape (points, 6).
        temperature: of all points, K, where the state holds none; default is the reference temperature. A pair is the
            temperature at the start and at the end: thermal strain is then part of `increments`.
        tolerance: error of stress, relative to the yield stress, allowed in a sub-step. None: one step of each
            increment. With a number the increments are divided where the direction of loading changes; the tangent is
            then that of the last sub-step.

    Returns:
        The new state, the tangent (points, 3, 3) or (points, 6, 6) in N/mm², and the number of local iterations or
        sub-steps of each point, 0 where it stayed elastic.

    Raises:
        SolveError: if a point did not converge.
        InputError: if the temperature lies outside the material's table, or plastic work heats a point out of it.
        ValueError: if shapes do not match, or a changing temperature is given for a material that heats itself or
            together with `tolerance`.
    """
    state, increments = np.ascontiguousarray(state, float), np.ascontiguousarray(increments, float)
    points, components = increments.shape
    if components not in (3, 6) or state.shape != (points, law.columns(components)):
        raise ValueError(f"state of shape {state.shape} does not fit strain increments of shape {increments.shape}")
    start, end = temperature if isinstance(temperature, tuple) else (temperature, temperature)
    point_law = law.point_law(end)
    if start is not None and end is not None and start != end:
        if law.is_adiabatic or tolerance is not None:
            raise ValueError("temperature changes neither with adiabatic heating nor with a tolerance")
        point_law = law.parts(law.parameters(end))
        point_law.plastic[CHANGE] = end - start
        increments = increments - law.thermal_strain(start, end) * (np.arange(components) < _normals(components))
    if tolerance is not None:
        return _divided(point_law, law, state, increments, tolerance)
    new, tangent, count = _advance(point_law, state, increments)
    refuse(law, count)
    return new, tangent, count


def _normals(components: int) -> int:
    return 1 if components == 3 else 3


def _advance(
    point_law: np.ndarray | Parts, state: np.ndarray, increments: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    points, components = increments.shape
    new, count = np.empty_like(state), np.empty(points, dtype=np.int64)
    if components == 3:
        rows = np.empty((9, points))
        advance_points(point_law, state, increments.T.copy(), new, rows, True, count)
        return new, rows.T.reshape(points, 3, 3), count
    tangent = np.empty((points, components, components))
    _solid(point_law, state, increments, new, tangent, count)
    return new, tangent, count


def refuse(law: Law, count: np.ndarray) -> None:
    """Raise the error of points that found no solution, by their counts."""
    if (count == TOO_HOT).any():
        low, high = law.temperature_range
        many = f"{(count == TOO_HOT).sum()} of {count.size} points" if count.size > 1 else "the point"
        problem = f"plastic work heats {many} out of the table of {low:g} to {high:g} K; give constants beyond it"
        raise InputError(problem, "temperatures", law.file)
    if (count < 0).any():
        raise SolveError(f"{(count < 0).sum()} of {count.size} points did not converge; use smaller increments")


def _divided(
    point_law: np.ndarray | Parts, law: Law, state: np.ndarray, increments: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sub-steps by step doubling: comparing one step with two half steps gives the error of the second-order method."""
    points, components = increments.shape
    weight = np.where(np.arange(components) < _normals(components), 1.0, 2.0)
    row, tangent = state.copy(), np.empty((points, components, components))
    done, size, count = np.zeros(points), np.ones(points), np.zeros(points, dtype=np.int64)
    while (open_ := np.flatnonzero(done < 1.0)).size:
        h = np.minimum(size[open_], 1.0 - done[open_])
        part = 0.5 * h[:, None] * increments[open_]
        one, _, plain = _advance(point_law, row[open_], 2.0 * part)
        half, _, first = _advance(point_law, row[open_], part)
        two, C, second = _advance(point_law, half, part)
        worst = np.minimum(np.minimum(plain, first), second)
        lost = worst < 0
        refuse(law, np.where(size[open_] < SMALLEST_SUBSTEP, np.where(lost, worst, FAILED), 0))
        difference = ((one - two)[:, :components] ** 2 * weight).sum(axis=1)
        error = np.sqrt(difference / law.k_squared(two[:, 2 * components])) / tolerance
        error = np.where(lost, math.inf, error)
        good = error <= 1.0
        accepted = open_[good]
        row[accepted], tangent[accepted] = two[good], C[good]
        count[accepted] += second[good] > 0
        done[accepted] = np.where(h[good] >= 1.0 - done[accepted], 1.0, done[accepted] + h[good])
        size[open_] = h * np.clip(0.9 / np.cbrt(np.maximum(error, 1e-6)), 0.2, 4.0)
    return row, tangent, count
