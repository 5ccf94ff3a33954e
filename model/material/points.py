"""The law over arrays of points from Python, without a mesh: one interface to both forms and both integrators."""

import numpy as np
from numba import njit

from coilset.model.errors import SolveError
from coilset.model.material import heun, rod, solid

INTEGRATORS = ("return_mapping", "heun")


def _rod_batch(step):
    @njit(error_model="numpy")  # without cache: numba would not find a closure again
    def batch(p, state, increments, new, tangent, count):
        for i in range(state.shape[0]):
            de = increments[i]
            count[i] = step(p, state[i], de[0], de[1], de[2], new[i], tangent[i])

    return batch


def _solid_batch(step):
    @njit(error_model="numpy")
    def batch(p, state, increments, new, tangent, count):
        for i in range(state.shape[0]):
            count[i] = step(p, state[i], increments[i], new[i], tangent[i])

    return batch


_BATCHES = {
    (3, "return_mapping"): _rod_batch(rod.return_map),
    (3, "heun"): _rod_batch(heun.rod_heun),
    (6, "return_mapping"): _solid_batch(solid.return_map),
    (6, "heun"): _solid_batch(heun.solid_heun),
}


def initial_state(law, points, components=3):
    """History rows of unstressed points at the reference temperature.

    Args:
        law: a `Law`.
        points: their number.
        components: 3 for the rod, 6 for the full stress state.

    Returns:
        Shape (points, 7) or (points, 13), one column more (the temperature) with adiabatic heating.
    """
    columns = 2 * components + 1
    state = np.zeros((points, columns + law.is_adiabatic))
    state[:, columns:] = law.reference_temperature
    return state


def update(law, state, increments, integrator="return_mapping", temperature=None):
    """Advance points by strain increments; a pure function.

    Args:
        law: a `Law`.
        state: history rows, shape (points, 7 or 8) for the rod (`rod`), (points, 13 or 14) in three dimensions (`solid`).
        increments: shape (points, 3): ε11, γ12, γ13, or (points, 6): ε11, ε22, ε33, γ12, γ13, γ23; without thermal strain.
        integrator: "return_mapping" (backward Euler, consistent tangent) or "heun" (the thesis's, tangent of the rates).
        temperature: of all points, K, where the state holds none; default is the reference temperature.

    Returns:
        The new state, the tangent (points, 3, 3) or (points, 6, 6) in N/mm², and the number of local iterations or
        sub-steps of each point, 0 where it stayed elastic.

    Raises:
        SolveError: if a point did not converge.
        InputError: if the temperature lies outside the material's table.
        ValueError: if shapes do not fit, or there is no such integrator.
    """
    state, increments = np.ascontiguousarray(state, float), np.ascontiguousarray(increments, float)
    points, components = increments.shape
    if integrator not in INTEGRATORS:
        raise ValueError(f"integrator '{integrator}' is none of {', '.join(INTEGRATORS)}")
    if components not in (3, 6) or state.shape != (points, 2 * components + 1 + law.is_adiabatic):
        raise ValueError(f"state of shape {state.shape} does not fit strain increments of shape {increments.shape}")
    new, tangent = np.empty_like(state), np.empty((points, components, components))
    count = np.empty(points, dtype=np.int64)
    _BATCHES[components, integrator](law.parameters(temperature), state, increments, new, tangent, count)
    failed = np.flatnonzero(count < 0)
    if failed.size:
        raise SolveError(f"{failed.size} of {points} material points did not converge; the strain increment is too large")
    return new, tangent, count
