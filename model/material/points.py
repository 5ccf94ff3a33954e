"""The law over arrays of points from Python, without a mesh: one interface to both forms and both integrators."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit

from coilset.model.base.errors import InputError, SolveError
from coilset.model.base.kernel import KERNEL
from coilset.model.material.law.functions import CHANGE, TOLERANCE
from coilset.model.material.law.law import Law
from coilset.model.material.law.terms import BackStresses
from coilset.model.material.point.back_stresses import back_stress_map
from coilset.model.material.point.heun import rod_heun, solid_heun
from coilset.model.material.point.local import FAILED, TOO_HOT
from coilset.model.material.point.rod_points import return_map_points
from coilset.model.material.point.solid import return_map as solid_return_map

INTEGRATORS = ("return_mapping", "heun")
SMALLEST_SUBSTEP = 1e-9


# One loop each, since numba keeps only functions on disk whose callees are known by name.
@njit(**KERNEL)
def _rod_return_map(
    p: np.ndarray, state: np.ndarray, increments: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> None:
    by_rows = np.empty((9, state.shape[0]))
    return_map_points(p, state, increments.T.copy(), new, by_rows, True, count)
    for i in range(state.shape[0]):
        for k in range(9):
            tangent[i, k // 3, k % 3] = by_rows[k, i]


@njit(**KERNEL)
def _rod_heun(
    p: np.ndarray, state: np.ndarray, increments: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> None:
    for i in range(state.shape[0]):
        de = increments[i]
        count[i] = rod_heun(p, state[i], de[0], de[1], de[2], new[i], tangent[i])


@njit(**KERNEL)
def _solid_return_map(
    p: np.ndarray, state: np.ndarray, increments: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> None:
    for i in range(state.shape[0]):
        count[i] = solid_return_map(p, state[i], increments[i], new[i], tangent[i])


@njit(**KERNEL)
def _solid_heun(
    p: np.ndarray, state: np.ndarray, increments: np.ndarray, new: np.ndarray, tangent: np.ndarray, count: np.ndarray
) -> None:
    for i in range(state.shape[0]):
        count[i] = solid_heun(p, state[i], increments[i], new[i], tangent[i])


@njit(**KERNEL)
def _back_stresses(
    law: BackStresses,
    state: np.ndarray,
    increments: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
) -> None:
    for i in range(state.shape[0]):
        count[i] = back_stress_map(law, state[i], increments[i], new[i], tangent[i])


LOOPS = {
    (3, "return_mapping"): _rod_return_map,
    (3, "heun"): _rod_heun,
    (6, "return_mapping"): _solid_return_map,
    (6, "heun"): _solid_heun,
}


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
        state[:, -1] = law.reference_temperature if temperature is None else law.known(temperature)
    return state


def update(
    law: Law,
    state: np.ndarray,
    increments: np.ndarray,
    integrator: str = "return_mapping",
    temperature: float | tuple[float, float] | None = None,
    tolerance: float | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Advance points by strain increments; a pure function.

    Args:
        law: a `Law`.
        state: the points' states, shape (points, 7 or 8) as in `rod`, or (points, 13 or 14) as in `solid`.
        increments: ε11, γ12, γ13, shape (points, 3), or ε11, ε22, ε33, γ12, γ13, γ23, shape (points, 6).
        integrator: "return_mapping" (second order, consistent tangent) or "heun" (the thesis's, the rates' tangent).
        temperature: of all points, K, where the state holds none; default is the reference temperature. A pair is the
            temperature at the start and at the end: thermal strain is then part of `increments`.
        tolerance: error of stress, relative to the yield stress, allowed in a sub-step. None: the return mapping makes
            one step of each increment, Heun takes the law's tolerance. With a number the return mapping, too, divides
            the increments where the direction of loading changes; the tangent is then that of the last sub-step.

    Returns:
        The new state, the tangent (points, 3, 3) or (points, 6, 6) in N/mm², and the number of local iterations or
        sub-steps of each point, 0 where it stayed elastic.

    Raises:
        SolveError: if a point did not converge.
        InputError: if the temperature lies outside the material's table, or plastic work heats a point out of it.
        ValueError: if shapes do not match, the integrator is unknown, or a changing temperature is given for a material
            that heats itself or together with `tolerance` for the return mapping.
    """
    state, increments = np.ascontiguousarray(state, float), np.ascontiguousarray(increments, float)
    points, components = increments.shape
    if integrator not in INTEGRATORS:
        raise ValueError(f"integrator '{integrator}' is none of {', '.join(INTEGRATORS)}")
    if components not in (3, 6) or state.shape != (points, law.columns(components)):
        raise ValueError(f"state of shape {state.shape} does not fit strain increments of shape {increments.shape}")
    if law.n_terms:
        return _update_back_stresses(law, state, increments, integrator, temperature, tolerance)
    loop = LOOPS[components, integrator]
    divided = tolerance is not None and integrator == "return_mapping"
    p = law.parameters(temperature[1] if isinstance(temperature, tuple) else temperature)
    if isinstance(temperature, tuple) and temperature[0] != temperature[1]:
        start, end = temperature
        if law.is_adiabatic or divided:
            raise ValueError(
                "temperature changes neither with adiabatic heating nor with the return mapping's tolerance"
            )
        p[CHANGE] = end - start
        increments = increments - law.thermal_strain(start, end) * (np.arange(components) < _normals(components))
    if divided:
        return _divided(loop, p, law, state, increments, tolerance)
    if tolerance is not None:
        p[TOLERANCE] = tolerance
    new, tangent, count = _advance(loop, p, state, increments)
    _refuse(law, count)
    return new, tangent, count


def _update_back_stresses(
    law: Law,
    state: np.ndarray,
    increments: np.ndarray,
    integrator: str,
    temperature: float | tuple[float, float] | None,
    tolerance: float | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`update` with several back stresses, which have less to choose from."""
    start, end = temperature if isinstance(temperature, tuple) else (temperature, temperature)
    if start != end:
        raise InputError("several back stresses are for one temperature at a time", "kinematic", law.file)
    if integrator == "heun" or tolerance is not None:
        raise InputError("several back stresses have the return mapping alone, in one step", "kinematic", law.file)
    new, tangent, count = _advance(_back_stresses, law.point_law(end), state, increments)
    _refuse(law, count)
    return new, tangent, count


def _normals(components: int) -> int:
    return 1 if components == 3 else 3


def _advance(
    loop: Callable[..., Any], p: np.ndarray | BackStresses, state: np.ndarray, increments: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    points, components = increments.shape
    new, tangent = np.empty_like(state), np.empty((points, components, components))
    count = np.empty(points, dtype=np.int64)
    loop(p, state, increments, new, tangent, count)
    return new, tangent, count


def _refuse(law: Law, count: np.ndarray) -> None:
    if (count == TOO_HOT).any():
        low, high = law.temperature_range
        many = f"{(count == TOO_HOT).sum()} of {count.size} points" if count.size > 1 else "the point"
        problem = f"plastic work heats {many} out of the table of {low:g} to {high:g} K; give constants beyond it"
        raise InputError(problem, "temperatures", law.file)
    if (count < 0).any():
        raise SolveError(f"{(count < 0).sum()} of {count.size} points did not converge; use smaller increments")


def _divided(
    loop: Callable[..., Any],
    p: np.ndarray,
    law: Law,
    state: np.ndarray,
    increments: np.ndarray,
    tolerance: float | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sub-steps by step doubling: comparing one step with two half steps gives the error of the second-order method."""
    points, components = increments.shape
    weight = np.where(np.arange(components) < _normals(components), 1.0, 2.0)
    row, tangent = state.copy(), np.empty((points, components, components))
    done, size, count = np.zeros(points), np.ones(points), np.zeros(points, dtype=np.int64)
    while (open_ := np.flatnonzero(done < 1.0)).size:
        h = np.minimum(size[open_], 1.0 - done[open_])
        part = 0.5 * h[:, None] * increments[open_]
        one, _, plain = _advance(loop, p, row[open_], 2.0 * part)
        half, _, first = _advance(loop, p, row[open_], part)
        two, C, second = _advance(loop, p, half, part)
        worst = np.minimum(np.minimum(plain, first), second)
        lost = worst < 0
        _refuse(law, np.where(size[open_] < SMALLEST_SUBSTEP, np.where(lost, worst, FAILED), 0))
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
