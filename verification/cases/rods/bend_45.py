"""Cantilever bent to 45° under a force out of its plane, against shooting of the exact rod's equations

The problem of K.-J. Bathe and S. Bolourchi, Large displacement analysis of three-dimensional beam structures, Int. J.
Num. Meth. Eng. 14 (1979) 961: an eighth of a circle of radius R = 100, clamped, with the dead force P = 300, 450, 600
at the tip, perpendicular to its plane; E = 1e7, ν = 0, a square section of 1 × 1. The wire here is round, with the same
EI; with ν = 0 its torsional stiffness is GJ = EI. The reference is computed for this wire by shooting
(`references/rod_shooting.py`), and meets collocation, with other unknowns, to ten digits
(`tests/verification/test_rod_shooting.py`). The displacements given in the paper for P = 600, (−23.5, −13.4, 53.4), are
of eight elements and three digits and are shown, not judged: the converged y is −13.605. The torsional stiffness does
not explain the difference: with that of the square, 0.141 G, collocation gives (−23.819, −13.732, 53.607).

Tolerance: the error of a polygon of n rods is proportional to φ² = (π/4n)²; the factor 0.1 is 1.4 times the value found
at n = 8. The axial strain P/EA, 6e-5, is added, because the rod's strains are logarithmic and refer to the current
length, while those of the reference refer to the initial length. The order is judged from 8, 16 and 32 elements.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.verification.chain import Z, chain, elastic
from coilset.verification.references.rod_shooting import Stiffness, clamped_rod
from coilset.verification.study import Study

FAST = True
RING, YOUNG, EI = 100.0, 1e7, 1e7 / 12.0
RADIUS = (4.0 * EI / (np.pi * YOUNG)) ** 0.25
FORCES = (150.0, 300.0, 450.0, 600.0)
JUDGED = FORCES[1:]
MESHES = (8, 16, 32, 64)
FINE = 32
PAPER = {"x": -23.5, "y": -13.4, "z": 53.4}  # displacement of the tip at P = 600
COLLOCATED = (-23.5602200, -13.6045150, 53.4747161)  # the same for the round wire


def arc(elements: int) -> np.ndarray:
    """Nodes of the eighth of a circle, shape (elements + 1, 3)."""
    angle = np.linspace(0.0, np.pi / 4.0, elements + 1)
    return RING * np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.0 * angle], axis=1)


def bend(elements: int) -> tuple[dict[float, np.ndarray], list[int]]:
    """All nodes' positions by force, shape (elements + 1, 3), and the iterations of the steps."""
    nodes, found = arc(elements), {}
    counts: list[int] = []
    frame = chain(nodes, RADIUS, elastic(YOUNG, 0.0))
    for force in FORCES:
        outcome = frame.step(forces={frame.dof(elements, Z): force}, predictor_scale=1.0 if counts else None)
        if not outcome.converged:
            raise SolveError(f"P = {force:g}, {elements} elements: {outcome.reason}")
        counts.append(outcome.iterations)
        found[force] = np.array([nodes[k] + frame.moved(k) for k in range(elements + 1)])
    return found, counts


def run(study: Study) -> None:
    """Tips of four meshes against shooting, and shooting against the paper."""
    law = elastic(YOUNG, 0.0)
    stiffness = Stiffness.of_round_wire(RADIUS, law.E, law.G)
    length, curvature = RING * np.pi / 4.0, (0.0, 0.0, 1.0 / RING)
    exact = {force: clamped_rod(stiffness, length, (0.0, 0.0, force), curvature=curvature) for force in JUDGED}
    for (name, printed), value, converged in zip(PAPER.items(), exact[600.0] - arc(1)[-1], COLLOCATED, strict=True):
        quantity = f"shooting: displacement {name} of the tip, P = 600"
        study.check(quantity, value, converged, "collocation", 1e-6)
        study.shown(quantity, value, printed, "Bathe and Bolourchi", "of eight elements, in three digits")
    found = {n: bend(n) for n in MESHES}
    error = {n: {P: float(np.linalg.norm(found[n][0][P][-1] - exact[P])) / RING for P in JUDGED} for n in MESHES}
    for force in JUDGED:
        tolerance = 0.1 * (np.pi / (4.0 * FINE)) ** 2 + force / stiffness.EA
        for name, ours, theirs in zip("xyz", found[FINE][0][force][-1], exact[force], strict=True):
            study.check(
                f"{name}/R of the tip, P = {force:g}, {FINE} rods",
                ours / RING,
                theirs / RING,
                "shooting",
                tolerance,
                "absolute",
            )
    slope = -np.polyfit(np.log(MESHES[:3]), [np.log(error[n][600.0]) for n in MESHES[:3]], 1)[0]
    study.check("order of the tip's error, 8 to 32 rods", slope, 2.0, "straight rods", 0.3, "absolute")
    rows = [[n, *(f"{error[n][P]:.1e}" for P in JUDGED), " + ".join(map(str, found[n][1]))] for n in MESHES]
    study.table(
        "distance of the tip from the reference, over R",
        ["rods", *(f"P = {P:g}" for P in JUDGED), "iterations, four steps"],
        rows,
    )
    draw(study, found[FINE][0], error)


def draw(study: Study, shapes: dict[float, np.ndarray], error: dict[int, dict[float, float]]) -> None:
    """Shapes seen along y, and the error over the mesh."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        for force, x in shapes.items():
            left.plot(x[:, 0], x[:, 2], "-", lw=1.3, label=f"P = {force:g}")
        left.set(aspect="equal", xlabel="x", ylabel="z", title=f"Bend of 45°, {FINE} rods")
        left.legend(fontsize=8)
        for force in JUDGED:
            right.loglog(MESHES, [error[n][force] for n in MESHES], "o-", ms=4, lw=1, label=f"P = {force:g}")
        right.loglog(MESHES, 0.1 * (np.pi / (4.0 * np.array(MESHES))) ** 2, "k:", lw=0.9, label="0.1 (π/4n)²")
        right.set_xticks(MESHES, [str(n) for n in MESHES])
        right.minorticks_off()
        right.set(xlabel="rods", ylabel="error of the tip over R")
        right.grid(lw=0.3)
        right.legend(fontsize=8)
    study.figure("bend_45", figure)
