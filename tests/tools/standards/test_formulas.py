"""Each row of the sheet against a second source, which is named beside it; a row that has none fails.

The spring is Gutekunst's D-313J-02, whose sheet is printed (federnshop.com; `catalogue`): d 3.6, De 31.6, L0 53.9 mm.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from catalogue import CATALOGUE, G
from derivations import E, closed_helix, half_wave, haringx, helix_compliance, polygon_length, torus_volume

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.tools.sheet.rows import DERIVED, GIVEN, ONE, TWO, sections
from coilset.model.tools.sheet.sheet import Sheet
from coilset.model.tools.standards.cylinder import Cylinder
from coilset.model.tools.wires import wire
from coilset.verification.one_section.slice_references import ring_sector

PRINTED = next(one for one in CATALOGUE if one.name == "D-313J-02")
d, D, n, TURNS, L0, LN = 3.6, 28.0, 5.5, 7.5, 53.9, 30.78
LONG = 45.0  # the other working length, mm
SPEC = {
    "wire_diameter": d,
    "mean_diameter": D,
    "turns": TURNS,
    "free_length": L0,
    "end_coils": {"form": "closed and ground", "tip": 0.5},
}
DENSITY = 7.85e-6
POLAR = 2 * np.pi * np.trapezoid(np.linspace(0, d / 2, 4001) ** 3, np.linspace(0, d / 2, 4001))  # ∫ r² dA, mm⁴
SPRING = Cylinder.of(SpringSpec.model_validate(SPEC).build())


def force(length):
    """Printed rate times travel, N."""
    return PRINTED.R * (L0 - length)


def stress(length):
    """Of the moment F D/2 at the surface of a bar, with the polar moment as an integral, MPa."""
    return force(length) * D / 2 * (d / 2) / POLAR


# Force and couple along the helix, as vectors, for ends that may turn.
RISING = helix_compliance(0.0, False) / helix_compliance(SPRING.pitch_angle, False)
WAY = np.linspace(L0, 27.0, 50)  # lengths on the way to block, mm
# Stress correction: displacements of a ring's sector, solved; Bergsträsser's k is an approximation of it.
K = ring_sector(D / d)[1]
# Printed Rm of EN 10270-1 SH at 2.5 and 4 mm (springcalc), between them linear over lg d.
RM = float(np.interp(np.log(d), np.log([2.5, 4.0]), [1900.0, 1740.0]))
# SpringOne's lines for SH as coiled at this diameter: upper stress over the lower one.
LOWER = np.array([0.0, 832.0, 2000.0]) - np.log10(d) * np.array([0.0, 322.0, 0.0])
UPPER = np.array([506.0, 1118.0, 1118.0]) - np.log10(d) * np.array([175.0, 410.0, 410.0])


@dataclass(frozen=True)
class Source:
    """A value from elsewhere, how close the sheet's must be, relative, and what the sheet must say of it."""

    value: float
    within: float
    said: tuple[str, ...] = (DERIVED, TWO)


SOURCES = {
    "spring index w": Source(7.7778, 1e-5),
    "wire length l": Source(polygon_length(D, TURNS), 1e-6),
    "mass m": Source(1e3 * DENSITY * torus_volume(d, D, TURNS), 1e-9),
    "growth of D to block": Source(closed_helix(d, D, SPRING.pitch, 0.25) - D, 0.02),
    "rate R": Source(PRINTED.R, 5e-5),
    "R of a rising wire": Source(PRINTED.R * RISING, 1e-4),
    # grinding to half the wire's thickness leaves coils that touch on a height of one wire a turn
    "block length Lc": Source(SPRING.solid / d * 3.630, 1e-9),  # d_max = 3.630 mm
    "force at block Fc": Source(force(27.0), 5e-5),
    "travel to buckling": Source(haringx(150.0, D, 0.5, d, n), 1e-8),  # of a spring of 150 mm, this one never does
    "stress τc": Source(stress(27.0), 5e-5),
    "stress correction k": Source(K, 1e-3),
    "corrected stress τkc": Source(K * stress(27.0), 1e-3),
    "minimum tensile strength Rm": Source(RM, 5 / RM),
    "allowed at block": Source(0.56 * RM, 5 / RM, (ONE,)),  # SpringOne alone
    "block of the geometry": Source(TURNS * d, 1e-9),  # ground tips of half the wire
    "minimum sum of gaps Sa": Source(LN - TURNS * d, 1e-3),  # printed least length less coils of 3.6 mm
    "smallest length Ln": Source(LN + TURNS * 0.03, 1e-3),  # the same with d_max
    "natural frequency": Source(half_wave(PRINTED.R, DENSITY * torus_volume(d, D, n)), 1e-4),
    "work to block": Source(1e-3 * np.trapezoid(force(WAY), L0 - WAY), 1e-4),
    "lower stress τk1": Source(K * stress(LONG), 1e-3),
    "range τkh": Source(K * (stress(LN) - stress(LONG)), 1e-3),
    "permissible stress range": Source(
        float(np.interp(K * stress(LONG), LOWER, UPPER)) - K * stress(LONG), 1e-2, (ONE,)
    ),
    "mean diameter ±": Source(PRINTED.De_tolerance, 1e-9),
    "free length ±": Source(PRINTED.L0_tolerance, 0.005 / 1.44),
    f"force at {LN:g} mm ±": Source(25.38, 0.005 / 25.38),  # printed
    # the printed tolerance at Ln and 0.015 F of grade 2, which differs by the difference of the forces
    f"force at {LONG:g} mm ±": Source(25.38 - 0.015 * (PRINTED.Fn - force(LONG)), 5e-4),
    "lean e1": Source(0.05 * L0, 1e-9, (ONE,)),
    "parallelism e2": Source(0.03 * PRINTED.De, 1e-9, (ONE,)),
}
for _length in (LN, LONG):
    SOURCES |= {
        f"force at {_length:g} mm": Source(force(_length), 1e-4),
        f"stress τ, {_length:g} mm": Source(stress(_length), 1e-4),
        f"corrected stress τk, {_length:g} mm": Source(K * stress(_length), 1e-3),
        f"sum of gaps, {_length:g} mm": Source(_length - TURNS * (d + 0.03), 1e-9),
    }


def rows():
    """Rows of the sheet that were not given, by label; those under a working length with that length."""
    known = wire("EN 10270-1 SH")
    made = Sheet(SPRING, known.elastic(d), 1.0, known, (LONG, LN))
    found, length = {}, ""
    for _, part in sections(made):
        for row in part:
            if row.label.startswith("force at ") and not row.label.endswith("±"):
                length = row.label.removeprefix("force at")
            label = f"{row.label.strip()},{length}" if row.label.startswith("  ") else row.label
            if row.sure != GIVEN:
                found[label] = row
    slender = SpringSpec.model_validate(SPEC | {"free_length": 150.0}).build()
    slender = Sheet(Cylinder.of(slender), known.elastic(d), 1.0)
    buckling = next(row for _, part in sections(slender) for row in part if row.label == "travel to buckling")
    return found | {"travel to buckling": buckling}


ROWS = rows()


def test_every_row_has_a_second_source():
    assert set(ROWS) == set(SOURCES)
    assert (G, E) == (81500.0, 206000.0)


@pytest.mark.parametrize("label", SOURCES)
def test_row_is_that_of_its_source(label):
    row, source = ROWS[label], SOURCES[label]
    assert row.value == pytest.approx(source.value, rel=source.within)
    assert row.sure in source.said
