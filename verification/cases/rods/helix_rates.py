"""Initial rates of clamped springs, D/d 4 to 12 and pitch 5° to 20°, against Castigliano's integral of the curved rod

Nine cylinders of 2.5 turns, 16 rods per turn, with sections that account for the curvature of the wire (`curved`) and
the thesis's (`plane`). The reference integrates the complementary energy of the true centre line with the six reactions
of a clamped head (`springs/curved_rod.py`), for `curved` with its own computation of the stiffnesses of such a section;
it uses no elements. The rate is that at zero travel: it is extrapolated from the forces at 5e-5 and 1e-4 of the free
length, so that the curvature of the characteristic enters to second order only, 1e-8.

Tolerance: 3e-5; the deviations found are 0.7 to 2.3e-5. The table of the formula G d⁴/8 D³ n, which neglects the pitch,
the heads and the curvature of the sections, is for information.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.verification.spring_references.curved_rod import clamped_rate
from coilset.verification.study import Study

FAST = True
WIRE, TURNS = 5.0, 2.5  # mm
INDICES, ANGLES = (4.0, 8.0, 12.0), (5.0, 12.5, 20.0)  # D/d, degrees
TRAVEL = 5e-5  # of the free length
KINDS = {"curved": "-", "plane": ":"}  # and how they are drawn


def rate(index: float, angle: float, kind: str) -> tuple[float, float, float]:
    """The program's rate, Castigliano's and that of the formula for close coils, N/mm."""
    diameter = index * WIRE
    spring = {
        "wire_diameter": WIRE,
        "mean_diameter": diameter,
        "turns": TURNS,
        "pitch": np.pi * diameter * np.tan(np.radians(angle)),
    }
    height = TURNS * spring["pitch"]
    loading = [{"to": {"travel": part * TRAVEL * height}, "steps": 1} for part in (1, 2)]
    case = check(
        {
            "spring": spring,
            "material": "elastic",
            "ends": "clamped",
            "loading": loading,
            "mesh": {"section": {"kind": kind}},
        }
    )
    analysis = Analysis(case, MPI.COMM_SELF)
    one, two = (step.force_N / step.travel_mm for step in analysis.run().steps)
    law, curved = analysis.law, kind == "curved"
    exact = clamped_rate(analysis.spring, law.E, law.G, curved)
    return 2.0 * one - two, exact, law.G * WIRE**4 / (8.0 * diameter**3 * TURNS)


def run(study: Study) -> None:
    """Nine rates of both kinds."""
    found = {kind: np.array([[rate(i, angle, kind) for angle in ANGLES] for i in INDICES]) for kind in KINDS}
    for kind, rates in found.items():
        for k, index in enumerate(INDICES):
            for m, angle in enumerate(ANGLES):
                ours, exact, _ = rates[k, m]
                name = f"rate, {kind}, D/d = {index:g}, pitch {angle:g}°, N/mm"
                study.check(name, ours, exact, f"Castigliano, {kind} sections", 3e-5)
        rows = [[angle, *100.0 * (rates[:, m, 2] / rates[:, m, 1] - 1.0)] for m, angle in enumerate(ANGLES)]
        heads = ["pitch, °", *(f"D/d = {i:g}" for i in INDICES)]
        study.table(f"G d⁴/(8 D³ n) over Castigliano with {kind} sections, %", heads, rows)
    study.figure("helix_rates", draw(found))


def draw(found: dict[str, np.ndarray]) -> Figure:
    """Errors over the pitch."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.8, 3.8), layout="constrained")
        axes = figure.add_subplot()
        for kind, style in KINDS.items():
            for k, index in enumerate(INDICES):
                errors = 1e6 * (found[kind][k, :, 0] / found[kind][k, :, 1] - 1.0)
                axes.plot(ANGLES, errors, f"C{k}o{style}", ms=4, lw=1, label=f"{kind}, D/d = {index:g}")
        axes.set(
            xlabel="pitch angle in °", ylabel="error of the rate in 10⁻⁶", title="Clamped springs, 16 rods per turn"
        )
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    return figure
