"""The law over arrays of points from Python, without a mesh: one interface to both forms and both integrators."""

import math

import numpy as np
from numba import njit

from coilset.model.errors import SolveError
from coilset.model.material import heun, rod, solid
from coilset.model.material.functions import TEMPERATURE, TOLERANCE, functions

INTEGRATORS = ("return_mapping", "heun")


@njit(error_model="numpy")  # no cache: numba would not find a closure again
def _distance(p, a, b, components):
    """Size of the difference of stress of two history rows against the yield stress, sqrt(Δσ:Δσ/k²)."""
    square = 0.0
    for i in range(components):
        normal = i == 0 if components == 3 else i < 3
        square += (1.0 if normal else 2.0) * (a[i] - b[i]) ** 2
    work = b[2 * components]
    return math.sqrt(square / functions(p, work, p[TEMPERATURE])[0])


def _batch(step, components):
    """Compile the loop over points for one form of the law and one integrator."""

    @njit(error_model="numpy")
    def advance(p, row, increment, h, new, tangent):
        if components == 3:
            return step(p, row, h * increment[0], h * increment[1], h * increment[2], new, tangent)
        return step(p, row, h * increment, new, tangent)

    @njit(error_model="numpy")
    def controlled(p, row, increment, tolerance, new, tangent):
        # Step doubling: the difference of one step and two half ones estimates the error of the first order method.
        one, mid, done, h, steps = row.copy(), row.copy(), 0.0, 1.0, 0
        row = row.copy()
        while done < 1.0:
            rest = 1.0 - done
            h = min(h, rest)
            last = h == rest
            count = advance(p, row, increment, h, one, tangent)
            if count > 0:
                advance(p, row, increment, 0.5 * h, mid, tangent)
                count = advance(p, mid, increment, 0.5 * h, new, tangent)
            else:
                new[:] = one
            error = _distance(p, one, new, components) / tolerance
            steps += 1
            if count < 0 or error > 1.0:
                if h < 1e-9:
                    return -1
                h *= 0.5 if count < 0 else max(0.2, 0.9 / math.sqrt(error))
                continue
            row[:] = new
            done = 1.0 if last else done + h
            h *= min(4.0, 0.9 / math.sqrt(error + 1e-300))
        return steps

    @njit(error_model="numpy")
    def batch(p, state, increments, tolerance, new, tangent, count):
        for i in range(state.shape[0]):
            if tolerance > 0.0:
                count[i] = controlled(p, state[i], increments[i], tolerance, new[i], tangent[i])
            else:
                count[i] = advance(p, state[i], increments[i], 1.0, new[i], tangent[i])

    return batch


_BATCHES = {
    (3, "return_mapping"): _batch(rod.return_map, 3),
    (3, "heun"): _batch(heun.rod_heun, 3),
    (6, "return_mapping"): _batch(solid.return_map, 6),
    (6, "heun"): _batch(heun.solid_heun, 6),
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


def update(law, state, increments, integrator="return_mapping", temperature=None, tolerance=None):
    """Advance points by strain increments; a pure function.

    Args:
        law: a `Law`.
        state: history rows, shape (points, 7 or 8) for the rod (`rod`), (points, 13 or 14) in three dimensions
        (`solid`). increments: shape (points, 3): ε11, γ12, γ13, or (points, 6): ε11, ε22, ε33, γ12, γ13, γ23; without
        thermal strain. integrator: "return_mapping" (backward Euler, consistent tangent) or "heun" (the thesis's,
        tangent of the rates). temperature: of all points, K, where the state holds none; default is the reference
        temperature.

        tolerance: error of stress, relative to the yield stress, allowed in a sub-step. None: the return mapping makes one
            step of each increment, Heun takes the tolerance of the law. With a number the return mapping, too, divides the
            increments where the direction of loading turns; the tangent is then that of the last sub-step.

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
    p, control = law.parameters(temperature), 0.0
    if tolerance is not None:
        if integrator == "heun":
            p[TOLERANCE] = tolerance
        else:
            control = float(tolerance)
    _BATCHES[components, integrator](p, state, increments, control, new, tangent, count)
    failed = np.flatnonzero(count < 0)
    if failed.size:
        raise SolveError(f"{failed.size} of {points} material points did not converge: too large a strain increment")
    return new, tangent, count
