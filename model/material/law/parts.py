"""What the point problem is put together from, as arrays for the kernels; see `coilset.model.material.point.stage`."""

from collections import namedtuple

import numpy as np
from numba import njit

from coilset.model.base.kernel import KERNEL
from coilset.model.material.law.functions import HEATING, N_ROWS, ROW_LENGTH, ROWS_START, table_place

# What the law's kernels take in the place of the parameter array, where the exponential return map does not suffice:
# that array; ⅔Cᵢ and γᵢ of the back stresses that saturate, shape (temperatures, terms, 2), no terms: the one of ζ, or
# none; and the array of creep (`creep.flow`), whose time is 0 where nothing creeps.
Parts = namedtuple("Parts", "plastic terms viscous")
# ζᵢ and γᵢ of a back stress with their slopes in b*, as it saturates with Ḃᵢ = ζᵢ D_pl − γᵢ Bᵢ ṗ.
Saturation = namedtuple("Saturation", "zeta gamma d_zeta d_gamma")


def further_columns(components: int, terms: int) -> int:
    """How many numbers all back stresses but the last add to a point's state."""
    return components * max(terms - 1, 0)


@njit(**KERNEL)
def saturation(law: Parts, term: int, temperature: float) -> Saturation:
    """Of one of several back stresses, interpolated between the temperatures of the table."""
    first = law.terms[0, term]
    if law.plastic[N_ROWS] == 1.0:
        return Saturation(first[0], first[1], 0.0, 0.0)
    o, weight = table_place(law.plastic, temperature)
    low = (o - ROWS_START) // ROW_LENGTH
    a, b = law.terms[low, term], law.terms[low + 1, term]
    slope = law.plastic[HEATING] / (law.plastic[o + ROW_LENGTH] - law.plastic[o])
    return Saturation(
        a[0] + weight * (b[0] - a[0]), a[1] + weight * (b[1] - a[1]), slope * (b[0] - a[0]), slope * (b[1] - a[1])
    )
