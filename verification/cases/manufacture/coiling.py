"""Wire bent to a coil and released, against elastic-plastic bending: springback, moment and residual stress

A straight wire is bent until it springs back to the curvature of a spring with D/d = 8. With ε = κ y, bending moment
and springback have closed forms for a material without hardening and for one with linear hardening,

    M = E_t I κ + (1 − E_t/E) M_ideal(κ),   κ_end = κ − M/(E I).

The sections of a curved wire use the logarithmic strains of its fibres, λ − θ y, instead; moment, springback and axial
force are then integrals over the height (`references/springback`). Sections of 32 × 64 points.

The figure shows the residual stress in the wire of a spring of the made-up law `creeping`: as coiled, after stress
relief at 523 K for 30 min, and after cold presetting of either. At the inside of the coil, coiling leaves a normal
stress of 868 N/mm²; relief removes 29 % of it (the creep rate goes with the sixth power of the remaining stress),
presetting none: it reverses the shear.

Tolerance: 0.1 %. The deviations found are 0.011 % in ideally plastic moments, the error of the section rule at the edge
of the yielded zone, and 0.03 % in the stress with logarithmic strains, the error of 40 increments.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case.case import check
from coilset.model.core.material import library
from coilset.model.core.material.point.points import initial_state
from coilset.model.core.results.records.record import Snapshot
from coilset.model.core.section.rules import polar
from coilset.model.physics.manufacture.coiling import coil
from coilset.verification.references.springback import Bar
from coilset.verification.study import Study

FAST = True
RADIUS, CURVATURE = 2.5, 1.0 / 20.0
HARDENING = {"ideal_plastic": 0.0, "linear_isotropic": 2000.0}  # slope of stress over plastic strain, N/mm²
COILED = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 1.5, "pitch": 18.0, "made_by": "coiling"}
RELIEF = [
    {"heat": {"to": 523.15, "minutes": 20, "keep": "force"}, "steps": 3},
    {"hold": {"minutes": 30, "keep": "force"}, "steps": 6},
    {"heat": {"to": 293.15, "minutes": 20, "keep": "force"}, "steps": 3},
]
PRESET = [{"to": {"travel": 18.0}, "steps": 8}, {"to": {"force": 0.0}, "steps": 4}]


def run(study: Study) -> None:
    """Two materials, two kinds of strain; the figure."""
    rule = polar(32, 64)
    for name, slope in HARDENING.items():
        law = library.load(name)
        bar = Bar(law.yield_stress, law.E, law.E * slope / (law.E + slope), RADIUS)
        for curved, source in ((False, "closed form, ε = κ y"), (True, "integral, logarithmic strain")):
            ours = coil(law.parameters(), rule, RADIUS, CURVATURE, 0.0, initial_state(law, 1), curved)
            found = ours.curvature, ours.moments[0], ours.surface[0, 0]
            exact = bar.curved(CURVATURE) if curved else bar.straight(CURVATURE)
            quantities = "curvature before springback, 1/mm", "moment there, N mm", "residual stress at the inside, MPa"
            for quantity, value, reference in zip(quantities, found, exact, strict=True):
                study.check(f"{name}: {quantity}", value, reference, source, 1e-3)
    study.figure("coiling", figure(states()))


def states() -> dict[str, tuple[Analysis, Snapshot]]:
    """The spring as coiled, relieved, preset, and preset after relief."""
    found: dict[str, tuple[Analysis, Snapshot]] = {}
    programs = {("as coiled", "coiled, preset"): PRESET, ("relieved", "relieved, preset"): RELIEF + PRESET}
    for words, loading in programs.items():
        case = check(
            {
                "spring": COILED,
                "material": "creeping",
                "temperature": 293.15,
                "ends": "clamped",
                "loading": loading,
                "mesh": {"elements_per_turn": 8, "section": {"radial": 8, "angular": 16}},
                "accuracy": "none",
            }
        )
        analysis = Analysis(case, MPI.COMM_SELF)
        shots = analysis.run().snapshots
        before = shots[len(loading) - len(PRESET)]
        found |= {word: (analysis, shot) for word, shot in zip(words, (before, shots[-1]), strict=True)}
    return found


def figure(found: dict[str, tuple[Analysis, Snapshot]]) -> Figure:
    """Normal stress and shear over the height of the section."""
    with mpl.rc_context(STYLE):
        picture = Figure(figsize=(9.6, 4.0), layout="constrained")
        left, right = picture.subplots(1, 2)
        for k, (word, (analysis, shot)) in enumerate(found.items()):
            rows, y, z = shot.point_state[len(shot.point_state) // 2, 0], *analysis.rod.rule.points.T
            rim = shot.surface_state[len(shot.surface_state) // 2, 0]
            near = np.abs(z) < 0.2
            y, rows = np.concatenate([[-1.0, 1.0], y[near]]), np.concatenate([rim[[12, 0]], rows[near]])
            order = np.argsort(y)
            style = {"ls": "--" if "relieved" in word else "-", "color": f"C{k // 2 if k % 2 == 0 else 2 + k // 2}"}
            left.plot(y[order], rows[order, 0], "o", ms=3, label=word, **style)
            right.plot(y[order], rows[order, 2], "o", ms=3, label=word, **style)
        for axes, name in ((left, "normal stress"), (right, "shear stress")):
            axes.axhline(0.0, color="0.7", lw=0.8)
            axes.set(xlabel="y/r, towards the coil's axis", ylabel=f"{name} in MPa", title=f"Residual {name}")
        left.legend()
    return picture
