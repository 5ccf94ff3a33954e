"""Tubes, disk and rectangle in a coil without pitch, far beyond yield and released, against displacements of the ring

A coil without pitch under a force along its axis is a ring's sector in torsion, with two shear stresses and nothing
assumed of its warping (`spring_references/yielding_ring.py`). The wall of a tube must carry the same ∫ τ (R − y)² all
around, so that its inside, nearer to the coil's axis, bears more than its outside and yields first: it warps then, as
the elastic tube does not. `curved` sections keep the elastic warping. Sections that warp, with the program's degree and
points, meet force and set within 0.2 and 1 %, the force of a sharp rectangle at D/d = 4 within 0.5 %, as its kinks run
to the corners, and the residual shear at the inside within 3 %.

The yield stress rises by 300 from 400 MPa (Voce); both have the same geometry, as the coil's yield stresses and travel
are a hundredth: the ring's strains are linear. Twice as many pieces of the splines change the force by 2e-4.
"""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.meshes.sections.shapes import Outline, Oval, Tube, rectangle
from coilset.model.core.base.style import STYLE
from coilset.model.core.case.case import SectionSpec
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.verification.cases.sections.any_wire import unit
from coilset.verification.one_section.outlined_coil import OutlinedCoil
from coilset.verification.spring_references import yielding_ring
from coilset.verification.spring_references.yielding_ring import Ring, Section, Steel
from coilset.verification.study import Study

FAST = True
YIELD, RISE, RATE, G = 400.0, 300.0, 40.0, 80000.0
SMALL = 1e-2
STEPS = 16
# outline, shape as in a case's entry, the ring's section, its pieces
WIRES: dict[str, tuple[Outline, str | None, Section, tuple[int, int]]] = {
    "disk 4": (Oval(4.0, 4.0), None, yielding_ring.tube(4.0, 0.0), (5, 8)),
    "tube 4 × 2.4": (Tube(4.0, 2.4), "tube", yielding_ring.tube(4.0, 2.4), (3, 16)),
    "tube 4 × 3.4": (Tube(4.0, 3.4), "tube", yielding_ring.tube(4.0, 3.4), (3, 16)),
    "rectangle 5 × 4": (rectangle(5.0, 4.0), "rectangle", yielding_ring.rectangle(5.0, 4.0), (10, 5)),
}
QUANTITIES = ("rate of a turn, N/mm", "force at full travel, N", "set of a turn, mm", "residual shear inside, MPa")
WARPING, SHARP = (3e-4, 2e-3, 1e-2, 3e-2), (3e-4, 5e-3, 1e-2, 3e-2)


def run(study: Study) -> None:
    """Rates, forces, sets and residual stresses."""
    rows = []
    for mean, travel in ((40.0, 4.8), (20.0, 1.5)):
        for name, (outline, shape, section, pieces) in WIRES.items():
            reference = ring(mean, section, pieces, travel)
            for kind in ("curved", "warping"):
                found = coil(outline, shape, kind, mean, travel)
                limits = SHARP if shape == "rectangle" else WARPING
                for quantity, ours, theirs, tolerance in zip(QUANTITIES, found, reference, limits, strict=True):
                    label = f"{name}, D = {mean:g} mm, {kind}: {quantity}"
                    if kind == "warping":
                        study.check(label, ours, theirs, "ring sector", tolerance)
                    else:
                        study.shown(label, ours, theirs, "ring sector", "it keeps the elastic warping")
                rows.append([name, mean, kind, *(100.0 * (found / reference - 1.0))])
    columns = ["wire", "D, mm", "section", "rate", "force", "set", "residual shear"]
    study.table("Deviation from the ring sector, %", columns, rows)
    study.figure("yielding_ring", draw(rows))


def draw(rows: Sequence[Sequence[Any]]) -> Figure:
    """Deviations of force and set, a bar for each wire and kind of section."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.0, 3.6), layout="constrained")
        wires = list(dict.fromkeys((name, mean) for name, mean, *_ in rows))
        for axes, column, quantity in zip(figure.subplots(1, 2, sharey=True), (4, 5), ("force", "set"), strict=True):
            for shift, kind, colour in ((-0.2, "curved", "C1"), (0.2, "warping", "C0")):
                values = [row[column] for row in rows if row[2] == kind]
                axes.barh([k + shift for k in range(len(wires))], values, 0.38, color=colour, label=kind)
            axes.set_yticks(range(len(wires)), [f"{name}, D = {mean:g} mm" for name, mean in wires])
            axes.axvline(0.0, color="k", lw=0.6)
            axes.set(title=quantity, xlabel="deviation from the ring sector in %")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def ring(mean: float, section: Section, pieces: tuple[int, int], travel: float) -> np.ndarray:
    """`QUANTITIES` by the reference."""

    def curve(strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        left = RISE * np.exp(-RATE * strain)
        return YIELD + RISE - left, RATE * left

    one = Ring(0.5 * mean, section, Steel(G, curve), pieces)
    return _pressed(one, travel)


def coil(outline: Outline, shape: str | None, kind: str, mean: float, travel: float) -> np.ndarray:
    """`QUANTITIES` by the program's sections, of strains that are SMALL times as large."""
    wire, spec = unit(outline), SectionSpec.model_validate({"kind": kind})
    rule, degree = wire[0].rule(len(spec.build(shape=shape))), spec.polynomials(shape)
    one = OutlinedCoil(law(), kind, rule, wire[1], mean, 2.0 * SMALL * travel, degree)
    return _pressed(one, SMALL * travel) / [1.0, SMALL, SMALL, SMALL]


def _pressed(one: Ring | OutlinedCoil, travel: float) -> np.ndarray:
    forces = []
    for k in range(STEPS):
        one.go_to(travel * (k + 1) / STEPS)
        forces.append(one.force)
    one.go_to(None)
    inside = one.inside if isinstance(one, Ring) else -one.inside_shear()
    return np.array([forces[0] * STEPS / travel, forces[-1], one.travel, inside])


def law() -> Law:
    """Voce's, with yield stresses SMALL times as large and a rate as much greater."""
    data = {
        "name": "softer",
        "description": "Voce's law with small yield strains",
        "source": "made up",
        "units": "N, mm, K",
        "validity": {"plastic_work": 2000.0, "remark": "none"},
        "temperatures": [
            {
                "temperature": 293.15,
                "elasticity": {"G": G, "nu": 0.3},
                "isotropic": {"law": "voce", "yield_stress": SMALL * YIELD, "rise": SMALL * RISE, "rate": RATE / SMALL},
                "kinematic": "none",
                "non_normality": "none",
            }
        ],
    }
    return Law(MaterialFile.model_validate(data))
