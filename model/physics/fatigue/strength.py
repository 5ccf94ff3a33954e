"""Fatigue strength of a wire, and what it makes of a cycle: safety, and life by a Wöhler line."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from coilset.model.physics.fatigue import criteria
from coilset.model.physics.fatigue.cycle import Cycle


@dataclass(frozen=True)
class Strength:
    """Constants of a wire's surface; None where a criterion is not to be evaluated.

    Attributes:
        torsion: amplitude endured in fully reversed torsion, τ_W, MPa.
        bending: the same in fully reversed bending, σ_W, MPa.
        sensitivity: M of `haigh`.
        findley: k; dang_van: a.
        fatemi_socie: k; yield_stress: σ_y, MPa.
        poisson: ν.
        cycles: number at which the line of fatigue strength becomes level; slope: of the line before it, in lg N over
            lg stress; scatter: ratio of the lives that 90 % and 10 % of the springs do not reach.
        source: of the constants.
    """

    torsion: float
    bending: float | None
    sensitivity: float | None
    findley: float | None
    dang_van: float | None
    fatemi_socie: float | None
    yield_stress: float | None
    poisson: float
    cycles: float
    slope: float | None
    scatter: float | None
    source: str

    def loads(self, cycle: Cycle) -> Iterator[tuple[str, np.ndarray, float]]:
        """Name of each criterion, its amplitudes at the points, MPa, and the amplitude that is endured, MPa."""
        if self.sensitivity is not None:
            yield "Haigh", criteria.haigh(cycle, self.sensitivity), self.torsion
        if self.bending is not None:
            yield "Smith-Watson-Topper", criteria.smith_watson_topper(cycle, self.poisson), self.bending
        if self.findley is not None:
            yield "Findley", criteria.findley(cycle, self.findley), self.torsion
        if self.dang_van is not None:
            yield "Dang Van", criteria.dang_van(cycle, self.dang_van), self.torsion
        if self.fatemi_socie is not None and self.yield_stress is not None:
            load = criteria.fatemi_socie(cycle, self.fatemi_socie, self.yield_stress)
            yield "Fatemi-Socie", load, self.torsion

    def lives(self, safety: float) -> dict[str, float] | None:
        """Cycles that 10, 50 and 90 % of the springs do not survive; None where they endure, or without a slope.

        N = N_D s^k with the safety factor s < 1: Basquin's line through the knee. Lives are log-normal.
        """
        if self.slope is None or safety >= 1.0:
            return None
        middle, apart = self.cycles * safety**self.slope, (self.scatter or 1.0) ** 0.5
        return {"10": middle / apart, "50": middle, "90": middle * apart}


def findley_k(torsion: float, bending: float) -> float:
    """k from the limits of reversed torsion and bending: σ_W/τ_W = 2 √(1 + k²)/(k + √(1 + k²)).

    With q = σ_W/τ_W this is k = (2 − q)/√(q² − (2 − q)²) = (2 − q)/(2 √(q − 1)), for 1 < q ≤ 2.

    Raises:
        ValueError: another ratio, for which there is no k.
    """
    ratio = bending / torsion
    if not 1.0 < ratio <= 2.0:
        raise ValueError(f"bending over torsion is {ratio:.3g}; Findley's criterion is for ratios above 1 up to 2")
    return (2.0 - ratio) / (2.0 * (ratio - 1.0) ** 0.5)


def dang_van_a(torsion: float, bending: float) -> float:
    """a = 3 (τ_W/σ_W − ½), from the limits of reversed torsion and bending."""
    return 3.0 * (torsion / bending - 0.5)
