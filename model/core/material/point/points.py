"""The law over arrays of points from Python, without a mesh: one interface to both forms."""

import numpy as np

from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.material.law.functions import CHANGE
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point.local import TOO_HOT
from coilset.model.core.material.point.loops import follow


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

    Returns:
        The new state, the tangent (points, 3, 3) or (points, 6, 6) in N/mm², and the number of local iterations of
        each point, 0 where it stayed elastic.

    Raises:
        SolveError: if a point did not converge.
        InputError: if the temperature lies outside the material's table, or plastic work heats a point out of it.
        ValueError: if shapes do not match, or a changing temperature is given for a material that heats itself.
    """
    state, increments = np.ascontiguousarray(state, float), np.ascontiguousarray(increments, float)
    points, components = increments.shape
    if components not in (3, 6) or state.shape != (points, law.columns(components)):
        raise ValueError(f"state of shape {state.shape} does not fit strain increments of shape {increments.shape}")
    start, end = temperature if isinstance(temperature, tuple) else (temperature, temperature)
    point_law = law.point_law(end)
    if start is not None and end is not None and start != end:
        if law.is_adiabatic:
            raise ValueError("adiabatic heating finds the temperature itself")
        point_law = law.parts(law.parameters(end))
        point_law.plastic[CHANGE] = end - start
        increments = increments - law.thermal_strain(start, end) * (
            np.arange(components) < (1 if components == 3 else 3)
        )
    new, tangent, count = follow(point_law, state, increments)
    refuse(law, count)
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
