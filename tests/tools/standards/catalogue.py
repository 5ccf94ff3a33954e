"""Gutekunst's printed data of twelve compression springs of EN 10270-1, grade 2 (federnshop.com)."""

from dataclasses import dataclass
from typing import Literal

G = 81500.0  # MPa, of EN 10270-1


@dataclass(frozen=True)
class Printed:
    """A spring as its maker prints it: lengths in mm, R in N/mm, Fn in N."""

    name: str
    d: float
    De: float
    De_tolerance: float
    L0: float
    L0_tolerance: float
    Ln: float
    R: float
    Fn: float
    n: float
    ends: Literal["closed", "closed and ground"]

    @property
    def D(self) -> float:
        """Mean diameter."""
        return self.De - self.d


CATALOGUE = [
    Printed("D-024", 0.25, 2.25, 0.10, 7.8, 0.33, 3.42, 0.585, 2.565, 8.5, "closed"),
    Printed("D-027", 0.30, 2.20, 0.10, 13.0, 0.38, 5.40, 0.962, 7.314, 12.5, "closed"),
    Printed("D-039", 0.32, 2.82, 0.10, 6.5, 0.27, 3.22, 1.243, 4.081, 5.5, "closed"),
    Printed("D-054", 0.40, 3.60, 0.15, 8.3, 0.32, 4.03, 1.447, 6.177, 5.5, "closed"),
    Printed("D-077", 0.50, 4.50, 0.15, 10.0, 0.38, 4.29, 1.809, 10.330, 5.5, "closed and ground"),
    Printed("D-082", 0.50, 3.70, 0.15, 7.9, 0.28, 4.19, 3.533, 13.093, 5.5, "closed and ground"),
    Printed("D-088", 0.50, 3.00, 0.10, 8.7, 0.32, 5.83, 4.794, 13.738, 8.5, "closed and ground"),
    Printed("D-102", 0.63, 5.63, 0.20, 12.5, 0.44, 5.40, 2.334, 16.576, 5.5, "closed and ground"),
    Printed("D-107", 0.63, 4.63, 0.15, 9.6, 0.33, 5.28, 4.559, 19.691, 5.5, "closed and ground"),
    Printed("D-134", 0.80, 5.80, 0.20, 12.0, 0.38, 6.70, 6.070, 32.182, 5.5, "closed and ground"),
    Printed("D-139", 0.80, 4.80, 0.15, 9.7, 0.31, 6.61, 11.855, 36.690, 5.5, "closed and ground"),
    Printed("D-313J-02", 3.60, 31.60, 0.40, 53.9, 1.44, 30.78, 14.172, 327.711, 5.5, "closed and ground"),
]
