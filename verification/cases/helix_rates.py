"""Initial rates of clamped springs, D/d 4 to 12 and pitch 5° to 20°, against Castigliano's integral of the curved rod

Nine cylinders of 2.5 turns, 16 rods a turn. The reference integrates the complementary energy of the true centre line
with the six reactions of a clamped head (`springs/curved_rod.py`); it knows no elements. The rate is that at no
travel: forces at 5e-5 and 1e-4 of the free length are extrapolated to zero, so that the characteristic's curvature
counts with its second order only, 1e-8.

Tolerance: 3e-5, of which 0.7 to 2.2e-5 was found. The row of the formula G d⁴/8 D³ n, which knows neither pitch nor
heads, is for reading.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.analysis import Analysis
from coilset.model.case import Case, check
from coilset.model.results.figures import STYLE
from coilset.verification.springs.curved_rod import clamped_rate
from coilset.verification.study import Study

FAST = True
WIRE, TURNS = 5.0, 2.5  # mm
INDICES, ANGLES = (4.0, 8.0, 12.0), (5.0, 12.5, 20.0)  # D/d, degrees
TRAVEL = 5e-5  # of the free length


def rate(index: float, angle: float) -> tuple[float, float, float]:
    """The program's rate, Castigliano's and that of the formula for close coils, N/mm."""
    diameter = index * WIRE
    spring = {"wire_diameter": WIRE, "mean_diameter": diameter, "turns": TURNS,
              "pitch": np.pi * diameter * np.tan(np.radians(angle))}  # fmt: skip
    height = TURNS * spring["pitch"]
    loading = [{"to": {"travel": part * TRAVEL * height}, "steps": 1} for part in (1, 2)]
    case: Case = check({"spring": spring, "material": "elastic", "ends": "clamped", "loading": loading})
    analysis = Analysis(case, MPI.COMM_SELF)
    one, two = (step.force_N / step.travel_mm for step in analysis.run().steps)
    law = analysis.law
    return 2.0 * one - two, clamped_rate(analysis.spring, law.E, law.G), law.G * WIRE**4 / (8.0 * diameter**3 * TURNS)


def run(study: Study) -> None:
    """Nine rates."""
    found = np.array([[rate(index, angle) for angle in ANGLES] for index in INDICES])
    for k, index in enumerate(INDICES):
        for m, angle in enumerate(ANGLES):
            ours, exact, _ = found[k, m]
            study.check(f"rate, D/d = {index:g}, pitch {angle:g}°, N/mm", ours, exact, "Castigliano", 3e-5)
    rows = [
        [angle, *(100 * (found[k, m, 2] / found[k, m, 1] - 1) for k in range(len(INDICES)))]
        for m, angle in enumerate(ANGLES)
    ]
    study.table("G d⁴/(8 D³ n) over Castigliano, %", ["pitch, °", *(f"D/d = {i:g}" for i in INDICES)], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.4, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for k, index in enumerate(INDICES):
            axes.plot(ANGLES, 1e6 * (found[k, :, 0] / found[k, :, 1] - 1.0), "o-", ms=4, lw=1, label=f"D/d = {index:g}")
        axes.set(xlabel="pitch angle in °", ylabel="error of the rate in 10⁻⁶", title="Clamped springs, 16 rods a turn")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("helix_rates", figure)
