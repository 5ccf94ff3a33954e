"""The elastic slice against the exact torsion of a ring's sector, and ovals and rectangles against Saint-Venant

A ring whose turns are pulled apart along its axis (pitch → 0) is Göhner's problem: its rate and the shear stress at the
inside and at the outside of a round wire come from polynomials of degree 16 in the displacements; Göhner's equation for
the stress function, solved elsewhere in the project, gives the same factors to 1e-8. A coil of D = 200 times the
section's size is nearly straight wire (terms of (d/D)², 2e-5): its rate is G J / R³ per radian with the torsion
constants of the ellipse (closed form) and the rectangle (series). The tolerances are 0.05 and 0.1 %; the
refinement in the figure shows that they are reached by convergence.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.meshes.sections.shapes import Oval, rectangle, round_wire
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.physics.slice.analysis import ACROSS
from coilset.verification.one_section.slice_references import (
    ring_sector,
    torsion_constant_ellipse,
    torsion_constant_rectangle,
)
from coilset.verification.one_section.slice_runs import WIRE, elastic
from coilset.verification.solid_study.references import goehner_exact
from coilset.verification.study import Study

FAST = True
ENDS = np.array([[-0.5 * WIRE, 0.0], [0.5 * WIRE, 0.0]])
MESHES = ((2, 4.5), (2, ACROSS), (2, 9.0), (2, 14.0), (3, 3.5), (3, 5.5), (3, 9.0))
JUDGED = (2, ACROSS)
SLENDER = 200.0

Errors = tuple[int, float, float, float]  # unknowns; of the rate and of the factors inside and outside


def run(study: Study) -> None:
    """Round wire over the spring index and the mesh, then other sections."""
    law, found = library.load("elastic"), {}
    for index in (4.0, 8.0):
        rate, inside, outside = ring_sector(index)
        for name, ours, theirs in zip(
            ("inside", "outside"), map(abs, (inside, outside)), goehner_exact(index), strict=True
        ):
            study.check(
                f"D/d = {index:g}, factor {name}: reference by displacements",
                ours,
                theirs,
                "Göhner's equation, solved",
                1e-8,
            )
        for degree, across in MESHES:
            found[index, degree, across] = _round(law, index, degree, across, (rate, inside, outside))
        unknowns, *errors = found[index, *JUDGED]
        for name, error, exact in zip(
            ("rate over G d⁴/(8 D³)", "shear factor inside", "shear factor outside"),
            errors,
            (rate, inside, -outside),
            strict=True,
        ):
            study.check(
                f"D/d = {index:g}, {name} ({unknowns} unknowns)",
                exact * (1 + error),
                exact,
                "torsion of a ring's sector, solved",
                5e-4,
            )
    rows = [
        [index, degree, *(values[0], *(100 * e for e in values[1:]))] for (index, degree, _), values in found.items()
    ]
    study.table("error in %", ["D/d", "degree", "unknowns", "rate", "factor inside", "factor outside"], rows)
    for name, outline, J in (
        ("oval 6 × 4", Oval(6.0, 4.0), torsion_constant_ellipse(6.0, 4.0)),
        ("oval 4 × 6", Oval(4.0, 6.0), torsion_constant_ellipse(4.0, 6.0)),
        ("square 4", rectangle(4.0, 4.0), torsion_constant_rectangle(4.0, 4.0)),
        ("rectangle 6 × 3", rectangle(6.0, 3.0), torsion_constant_rectangle(6.0, 3.0)),
        ("rectangle 3 × 6", rectangle(3.0, 6.0), torsion_constant_rectangle(3.0, 6.0)),
    ):
        D = SLENDER * 5.0
        found_here = elastic(outline, D, law, 10.0, 2, np.zeros((1, 2)))
        J_ours = found_here.rate * 2 * np.pi * (0.5 * D) ** 3 / law.G
        study.check(f"torsion constant, {name} ({found_here.unknowns} unknowns), mm⁴", J_ours, J, "Saint-Venant", 1e-3)
    study.figure("slice_elastic", _figure(found))


def _round(law: Law, index: float, degree: int, across: float, exact: tuple[float, float, float]) -> Errors:
    """Unknowns, and relative errors of the rate and of the factors inside and outside."""
    D = index * WIRE
    ours = elastic(round_wire(WIRE), D, law, across, degree, ENDS)
    rate = ours.rate / (law.G * WIRE**4 / (8 * D**3))
    inside, outside = ours.shear * np.pi * WIRE**3 / (8 * D)
    return ours.unknowns, rate / exact[0] - 1, inside / exact[1] - 1, outside / -exact[2] - 1


def _figure(found: dict[tuple[float, int, float], Errors]) -> Figure:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 3.8), layout="constrained")
        for axes, index in zip(figure.subplots(1, 2, sharey=True), (4.0, 8.0), strict=True):
            for degree, style in ((2, "o-"), (3, "s--")):
                values = np.array([found[index, d, a] for d, a in MESHES if d == degree])
                for k, name in enumerate(("rate", "factor inside", "factor outside")):
                    axes.loglog(
                        values[:, 0],
                        100 * np.abs(values[:, 1 + k]),
                        f"C{k}{style}",
                        ms=4,
                        lw=1,
                        label=f"{name}, degree {degree}",
                    )
            axes.axhline(0.05, color="0.5", lw=0.8, ls=":")
            axes.set(xlabel="unknowns", title=f"D/d = {index:g}")
            axes.set_xticks([500, 1000, 2000], ["500", "1000", "2000"])
            axes.minorticks_off()
            axes.grid(lw=0.3)
        figure.axes[0].set(ylabel="error in %")
        figure.legend(*figure.axes[1].get_legend_handles_labels(), loc="outside right center", fontsize=8)
        figure.suptitle("Elastic slice against the torsion of a ring's sector (dotted: 0.05 %)")
    return figure
