"""Laws of MFront by the C function of its generic interface, as laws of six stresses.

`mfront --obuild --interface=generic` builds a library with a function NAME_Tridimensional for each small-strain
behaviour. It takes a view of pointers, as the present MFrontGenericInterfaceSupport lays it out, to what follows:

    error message (here none), Δt, K, proposed step, speed of sound, and for the states at the start and at the end:
    gradients, thermodynamic forces, mass density, material properties, internal state variables, stored energy,
    dissipated energy, external state variables

and returns 1 if it found a solution. Gradients are total strains and thermodynamic forces stresses, both in the order
11, 22, 33, 12, 13, 23 with √2 times the tensors' shear components; K[0] = 4 requires the consistent tangent. No time
passes in a step here: behaviours that depend on the rate are not meant.
"""

from collections.abc import Callable, Sequence
from ctypes import c_int, c_void_p
from typing import Any

import numpy as np

from coilset.model.core.runtime.kernels import njit

STATES = 10  # numbers of the state before the internal state variables: four that are reported, and six strains
CONSISTENT = 4.0
SHEAR = np.array([1.0, 1.0, 1.0, 0.5**0.5, 0.5**0.5, 0.5**0.5])  # engineering shear strain to √2 ε, √2 τ to τ


def variables(internal: int) -> list[str]:
    """Names of the state's numbers, as `coilset.api.Law` takes them, for so many internal state variables."""
    strains = [f"eps{pair}" for pair in ("11", "22", "33", "12", "13", "23")]
    return strains + [f"internal_{k}" for k in range(1, internal + 1)]


def behaviour(function: Any, internal: int, external: Sequence[float] = (293.15,)) -> Callable[..., bool]:
    """The law of six stresses, for `condense`, of a behaviour; its parameters are the material properties.

    Args:
        function: NAME_Tridimensional of a library that ctypes has loaded.
        internal: numbers of internal state variables; a symmetric tensor has six.
        external: values of the external state variables; the first is the temperature, K.
    """
    function.restype, function.argtypes = c_int, [c_void_p]
    outside = np.array(external, float)

    @njit(error_model="numpy")
    def law(
        stress: np.ndarray,
        state: np.ndarray,
        strain: np.ndarray,
        parameters: np.ndarray,
        new_stress: np.ndarray,
        new_state: np.ndarray,
        tangent: np.ndarray,
    ) -> bool:
        # one array, which lives as long as the call: K, strains, stresses, internal variables at start and end, ...
        sizes = (36, 6, 6, 6, 6, internal, internal, len(parameters), len(outside), 7)
        begin = np.zeros(len(sizes) + 1, np.int64)
        for k in range(len(sizes)):
            begin[k + 1] = begin[k] + sizes[k]
        work, view = np.zeros(begin[-1]), np.zeros(21, np.int64)
        K, e0, e1, s0, s1, v0, v1, properties, given, rest = begin[:-1]
        work[K] = CONSISTENT
        for i in range(6):
            work[e0 + i] = state[4 + i]
            work[e1 + i] = state[4 + i] + SHEAR[i] * strain[i]
            work[s0 + i] = work[s1 + i] = stress[i] / SHEAR[i]
        for k in range(internal):
            work[v0 + k] = work[v1 + k] = state[STATES + k]
        work[properties:given] = parameters
        work[given:rest] = outside
        work[rest] = 1.0
        at = work.ctypes.data + 8 * np.arange(len(work))
        view[2:5] = at[K], at[rest], at[rest + 1]
        view[5:13] = at[e0], at[s0], at[rest + 2], at[properties], at[v0], at[rest + 3], at[rest + 4], at[given]
        view[13:21] = at[e1], at[s1], at[rest + 2], at[properties], at[v1], at[rest + 5], at[rest + 6], at[given]
        solved = function(view.ctypes) == 1
        new_state[:4] = 0.0
        for i in range(6):
            new_state[4 + i], new_stress[i] = work[e1 + i], SHEAR[i] * work[s1 + i]
            for j in range(6):
                tangent[i, j] = SHEAR[i] * work[K + 6 * i + j] * SHEAR[j]
        for k in range(internal):
            new_state[STATES + k] = work[v1 + k]
        return solved

    return law
