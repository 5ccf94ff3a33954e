"""What is permitted of springs, as open sources have it; each limit names them, and how sure it is.

Sources:

- SpringOne (M. Caruso, open source): EN13906.pas, EN10270.pas. EN 13906-1, -3 and the range of both.
- Mekanika (open source, engines of EN 13906-2 and -3): 0.45 Rm in the coils of extension springs, 0.70 Rm of bending in
  their hooks and in torsion springs.
- AABAG (aabag.de, pages on permissible stresses): 0.45 Rm in the coils of extension springs, 0.75 Rm of bending in
  torsion springs, 20 % less against the winding direction.
- Shigley's table 10-7 (amesweb.info): 0.45 to 0.50 Rm of the corrected stress in the coils of extension springs,
  0.75 Rm of bending in their hooks.
- ODOP (thegrumpys/odop, mat_ips.json and eqnset.js of Extension): initial tension.
- helicoil (open source, EN 13906-1:2013 of hot coiled springs): block stress of ground bars of EN 10089.
"""

from dataclasses import dataclass
from math import exp

import numpy as np

TWO, ONE, COMPUTED, GIVEN = "two sources", "one source", "computed", "given"
COLD_INDEX, HOT_INDEX = (4.0, 20.0), (3.0, 12.0)
COIL_PULLED, BENT = 0.45, 0.70  # of Rm
# psi in MPa; of the uncorrected stress times exp(0.105 w)
READY, ON_REQUEST = 45000.0 * 6.894757e-3, 58000.0 * 6.894757e-3
INDEX_DECAY = 0.105
HOT_BLOCK = (
    (7.5, 10.0, 12.5, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.6),
    (955.0, 925.0, 896.9, 874.4, 840.2, 813.1, 794.6, 761.3, 735.8, 716.5),
)  # d, mm, and τc, MPa


@dataclass(frozen=True)
class Permitted:
    """A limit of a stress.

    Attributes:
        stress: MPa.
        source, sure: see Check.
    """

    stress: float
    source: str
    sure: str


def hot_block_stress(d: float) -> Permitted | None:
    """Uncorrected shear stress at block of a hot coiled bar of EN 10089, d in mm; None outside of the table."""
    diameters, stresses = HOT_BLOCK
    if not diameters[0] <= d <= diameters[-1]:
        return None
    return Permitted(float(np.interp(d, diameters, stresses)), "EN 13906-1, hot coiled EN 10089", ONE)


def pulled_coil_stress(strength: float) -> Permitted:
    """Uncorrected shear stress of an extension spring's coils, for a strength Rm in MPa (AABAG, Mekanika)."""
    return Permitted(COIL_PULLED * strength, f"{COIL_PULLED:g} Rm, EN 13906-2", TWO)


def hook_bending_stress(strength: float) -> Permitted:
    """Stress along the wire of hooks, curvature included: Mekanika has 0.70 Rm, Shigley 0.75."""
    return Permitted(BENT * strength, f"{BENT:g} Rm, bending of hooks", TWO)


def turned_bending_stress(strength: float) -> Permitted:
    """Bending stress of torsion springs (SpringOne, Mekanika): uncorrected under steady load in the winding direction,
    else corrected."""
    return Permitted(BENT * strength, f"{BENT:g} Rm, EN 13906-3", TWO)


def initial_tension(index: float) -> tuple[float, float]:
    """Uncorrected stress of the initial tension that is readily coiled, and that on request, MPa, for w = D/d (ODOP).

    Shigley's upper end of the preferred range, 231 exp(−0.105 w) + 6.9 (4 − (w − 3)/6.5) MPa, is 5 to 12 % below
    the first for w of 4 to 12.
    """
    return READY * exp(-INDEX_DECAY * index), ON_REQUEST * exp(-INDEX_DECAY * index)
