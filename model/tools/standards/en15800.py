"""Tolerances of cold coiled compression springs according to EN 15800 (formerly DIN 2095), in three grades.

The table of the coil diameter was found in three sources (SpringOne; Gutekunst's blog; Industrial Springs for grade 2).
The formulas of force and free length are quoted with two signs: 1/(3 n²) of k_f is added in SpringOne and subtracted in
a spring maker's public program. Gutekunst's printed tolerances confirm the latter: it reproduces those of twelve
springs to the last digit, whereas the sum is up to 3 % above them. The lean e1 and the parallelism e2 rest on SpringOne
alone.
"""

from bisect import bisect_left
from dataclasses import dataclass
from typing import Literal, get_args

from coilset.model.tools.standards import en13906

Grade = Literal[1, 2, 3]
GRADES: dict[int, Grade] = {grade: grade for grade in get_args(Grade)}
FACTORS = {1: 0.63, 2: 1.0, 3: 1.6}  # Q of the grades
# range of validity of the standard, table 1, mm; annex A has more of wire up to 20 mm
WIRES, WIDEST_D, LONGEST, FEWEST_TURNS, INDICES = (0.07, 16.0), 200.0, 630.0, 2.0, (4.0, 20.0)
DIAMETERS = (0.63, 1.0, 1.6, 2.5, 4.0, 6.3, 10.0, 16.0, 25.0, 31.5, 40.0, 50.0, 63.0, 80.0, 100.0, 125.0, 160.0, 200.0)
# tolerance of D in mm, a row for each range of D: grades 1, 2, 3 with w of 4 to 8, 8 to 14, 14 to 20 each
COIL = (
    (0.05, 0.07, 0.10, 0.07, 0.10, 0.15, 0.10, 0.15, 0.20),
    (0.05, 0.07, 0.10, 0.08, 0.10, 0.15, 0.15, 0.20, 0.30),
    (0.07, 0.10, 0.15, 0.10, 0.15, 0.20, 0.20, 0.30, 0.40),
    (0.10, 0.10, 0.15, 0.15, 0.20, 0.25, 0.30, 0.40, 0.50),
    (0.10, 0.15, 0.20, 0.20, 0.25, 0.30, 0.40, 0.50, 0.60),
    (0.15, 0.15, 0.20, 0.25, 0.30, 0.35, 0.50, 0.60, 0.70),
    (0.15, 0.20, 0.25, 0.30, 0.35, 0.40, 0.60, 0.70, 0.80),
    (0.20, 0.25, 0.30, 0.35, 0.45, 0.50, 0.70, 0.90, 1.00),
    (0.25, 0.30, 0.35, 0.40, 0.50, 0.60, 0.80, 1.00, 1.20),
    (0.25, 0.30, 0.35, 0.50, 0.60, 0.70, 1.00, 1.20, 1.50),
    (0.30, 0.40, 0.50, 0.60, 0.80, 0.90, 1.20, 1.50, 1.80),
    (0.40, 0.50, 0.60, 0.80, 1.00, 1.10, 1.50, 2.00, 2.30),
    (0.50, 0.70, 0.80, 1.00, 1.20, 1.40, 1.80, 2.40, 2.80),
    (0.60, 0.80, 0.90, 1.20, 1.50, 1.70, 2.30, 3.00, 3.50),
    (0.70, 1.00, 1.10, 1.40, 1.90, 2.20, 2.80, 3.70, 4.40),
    (0.90, 1.20, 1.40, 1.80, 2.30, 2.70, 3.50, 4.60, 5.40),
    (1.20, 1.50, 1.70, 2.10, 2.90, 3.30, 4.20, 5.70, 6.60),
)
LEAN = {1: 0.03, 2: 0.05, 3: 0.08}  # e1 over L0
PARALLELISM = {1: 0.015, 2: 0.03, 3: 0.06}  # e2 over De


@dataclass(frozen=True)
class Tolerances:
    """Tolerances ± of one grade, mm. e1 is the lean of the standing spring, e2 the parallelism of ground ends."""

    coil_diameter: float
    free_length: float
    lean: float
    parallelism: float


def outside(d: float, D: float, n: float, length: float) -> str | None:
    """The reason why the standard does not cover a spring; None if it does."""
    w = D / d
    if not WIRES[0] <= d <= WIRES[1]:
        return f"d = {d:g} mm is outside of {WIRES[0]:g} to {WIRES[1]:g} mm"
    if not INDICES[0] <= w <= INDICES[1]:
        return f"w = {w:.3g} is outside of {INDICES[0]:g} to {INDICES[1]:g}"
    if not DIAMETERS[0] <= D <= WIDEST_D:
        return f"D = {D:g} mm is outside of {DIAMETERS[0]:g} to {WIDEST_D:g} mm"
    if length > LONGEST:
        return f"L0 = {length:g} mm is above {LONGEST:g} mm"
    if n < FEWEST_TURNS:
        return f"n = {n:g} active turns are fewer than {FEWEST_TURNS:g}"
    return None


def tolerances(grade: Grade, shear_modulus: float, d: float, D: float, n: float, length: float) -> Tolerances:
    """All tolerances of the unloaded spring, A_L0 = a_F k_f Q/R among them.

    Raises:
        ValueError: if the standard does not cover the spring, see `outside`.
    """
    reason = outside(d, D, n, length)
    if reason:
        raise ValueError(reason)
    free = force_spread(d, D, n) * FACTORS[grade] / en13906.rate(shear_modulus, d, D, n)
    return Tolerances(coil_diameter(grade, d, D), free, LEAN[grade] * length, PARALLELISM[grade] * (D + d))


def coil_diameter(grade: Grade, d: float, D: float) -> float:
    """Tolerance of the mean diameter by the table, mm."""
    row, column = COIL[max(bisect_left(DIAMETERS, D) - 1, 0)], bisect_left((8.0, 14.0), D / d)
    return row[3 * (grade - 1) + column]


def force_spread(d: float, D: float, n: float) -> float:
    """a_F k_f, the part of the force tolerance due to the geometry, N; lengths in mm.

    a_F = 65.92 d^3.3/D^1.6 (−0.84 (w/10)³ + 3.781 (w/10)² − 4.244 (w/10) + 2.274), k_f = −1/(3 n²) + 8/(5 n) + 0.803.
    """
    x = D / d / 10
    a = 65.92 * d**3.3 / D**1.6 * (-0.84 * x**3 + 3.781 * x**2 - 4.244 * x + 2.274)
    return a * (-1 / (3 * n**2) + 8 / (5 * n) + 0.803)


def force_tolerance(grade: Grade, d: float, D: float, n: float, force: float) -> float:
    """Tolerance of the force at a given length, A_F = (a_F k_f + 0.015 F) Q, N."""
    return (force_spread(d, D, n) + 0.015 * force) * FACTORS[grade]
