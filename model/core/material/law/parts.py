"""The numbers of a law, as arrays for the kernels; see `coilset.model.physics.time.stage`."""

from collections import namedtuple

import numpy as np

from coilset.model.core.material.law.functions import HEATING, N_ROWS, ROW_LENGTH, ROWS_START, table_place
from coilset.model.core.runtime.kernels import INLINE, njit

CREEP_ENTRIES, MOST_TERMS = 9, 8  # of the array of creep; back stresses that saturate
# The numbers of a law: the parameter array; ⅔Cᵢ and γᵢ of the back stresses that saturate, shape (temperatures, terms,
# 2), no terms: the one of ζ, or none; and the array of creep (`creep.flow`), whose time is 0 where nothing creeps.
Parts = namedtuple("Parts", "plastic terms viscous")
# ζᵢ and γᵢ of a back stress with their slopes in b*, as it saturates with Ḃᵢ = ζᵢ D_pl − γᵢ Bᵢ ṗ.
Saturation = namedtuple("Saturation", "zeta gamma d_zeta d_gamma")


def simple(plastic: np.ndarray) -> Parts:
    """The numbers of a law that the parameter array alone describes."""
    return Parts(plastic, np.zeros((1, 0, 2)), np.zeros(CREEP_ENTRIES))


def further_columns(components: int, terms: int) -> int:
    """How many numbers all back stresses but the last add to a point's state."""
    return components * max(terms - 1, 0)


@njit(**INLINE)
def saturation(law: Parts, term: int, temperature: float) -> Saturation:
    """Of one of several back stresses, interpolated between the temperatures of the table."""
    of = law.terms
    if law.plastic[N_ROWS] == 1.0:
        return Saturation(of[0, term, 0], of[0, term, 1], 0.0, 0.0)
    o, weight = table_place(law.plastic, temperature)
    low, width = (o - ROWS_START) // ROW_LENGTH, law.plastic[o + ROW_LENGTH] - law.plastic[o]
    zeta, gamma = of[low, term, 0], of[low, term, 1]
    more_zeta, more_gamma = of[low + 1, term, 0] - zeta, of[low + 1, term, 1] - gamma
    slope = law.plastic[HEATING] / width
    return Saturation(zeta + weight * more_zeta, gamma + weight * more_gamma, slope * more_zeta, slope * more_gamma)
