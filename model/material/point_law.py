"""The law of a section point, whichever it is: numba chooses by the type of what is handed down as the law.

A parameter array means the return mapping, a `Creeping` creep beside it. The choice is made when a section's loop is
compiled (njit) for the one or the other: a material that does not creep pays nothing for it and compiles nothing of it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload

from coilset.model.material import creep, rod, solid


def rod_point(law: Any, old: np.ndarray, de11: float, dg12: float, dg13: float, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of the rod's law; arguments as in `rod.return_map`, or a Creeping in the place of the array."""
    raise NotImplementedError("only compiled loops call it")


def solid_point(law: Any, old: np.ndarray, dD: np.ndarray, new: np.ndarray, C: np.ndarray) -> int:
    """One increment of the law for the full stress state, as in `solid.return_map`, or with a Creeping."""
    raise NotImplementedError("only compiled loops call it")


# strict: would compare annotations, which a lambda has not
@overload(rod_point, strict=False, inline="always")
def _rod_point(law: Any, old: Any, de11: Any, dg12: Any, dg13: Any, new: Any, C: Any) -> Callable[..., int]:
    if not isinstance(law, types.BaseNamedTuple):
        return lambda law, old, de11, dg12, dg13, new, C: rod.return_map(law, old, de11, dg12, dg13, new, C)
    return lambda law, old, de11, dg12, dg13, new, C: creep.rod_map(law, old, de11, dg12, dg13, new, C)


@overload(solid_point, strict=False, inline="always")
def _solid_point(law: Any, old: Any, dD: Any, new: Any, C: Any) -> Callable[..., int]:
    if not isinstance(law, types.BaseNamedTuple):
        return lambda law, old, dD, new, C: solid.return_map(law, old, dD, new, C)
    return lambda law, old, dD, new, C: creep.creep_map(law, old, dD, new, C)
