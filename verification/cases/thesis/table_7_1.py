"""Rolling beam after Table 7.1: three rods, an end moment, two gap elements that close, close and open

A cantilever of three rods of length l is bent by a moment M0 at its end, in ten equal steps. Under nodes 2 and 3 lies a
rigid base; c = 22 EI/l³, which the thesis's forces and penetrations imply. Node 2 closes in the third step, node 3 in
the fifth, and node 2 opens in the ninth, as in Table 7.1. The thesis's drawing is lost, and no structure that was tried
gives all of its rows: clamping and gaps (0.055 l and 0.30 l, times the scale below) are ours, so only the order of
events and the iterations are compared with the thesis.

The single iterations of the thesis between the events show that its beam responds linearly to ε = 1e-7. A beam that
rotates by a rad and more, as its moments imply, cannot do so; ours carries 1e-6 of them, with gaps scaled alike, so
that the axial forces, which grow with the squares of the rotations, are below ε.

NR, too, is compared with the thesis's BFGS, because the thesis gives no counts for NR. BFGS searches for the zero of
the out-of-balance work along each correction with up to ten trials; with one trial, coilset's default, it needs 6, 11
and 3 iterations at the events. MNR has no line search and keeps its matrix over the step.

Forces: the linear beam with shear on two one-sided springs. With f_ij = x_i² (3x_j − x_i)/(6EI) + x_i/(GA), x_i ≤ x_j,
S_j = c max(0, w_j − g_j) and w_i = M x_i²/(2EI) − Σ f_ij S_j; each of the four sets of closed gaps is tried. The
tolerance is that of the onset, 1e-6 of a gap, in the small difference that is a penetration.
"""

from collections.abc import Mapping
from itertools import product
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import polar
from coilset.verification import figures
from coilset.verification.frame import KEEP, Frame
from coilset.verification.stops import Stops
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS, SCALE = 1000.0, 100.0, 1e-6  # mm, mm
GAPS = np.array([0.055, 0.30])  # of l · SCALE, under nodes 2 and 3
C = 22.0  # EI/l³
STEPS = 0.04 * np.arange(1, 11)  # M0 l/(EI · SCALE)
# iterations of MNR (None: diverged) and BFGS
PRINTED: list[tuple[int | None, int]] = [
    (1, 1),
    (1, 1),
    (16, 3),
    (1, 1),
    (39, 7),
    (1, 1),
    (1, 1),
    (1, 1),
    (None, 3),
    (None, 1),
]
EVENTS: list[tuple[tuple[int, ...], str]] = [
    ((), "open"),
    ((), ""),
    ((0,), "node 2 closes"),
    ((0,), ""),
    ((0, 1), "node 3 closes"),
    ((0, 1), ""),
    ((0, 1), ""),
    ((0, 1), ""),
    ((1,), "node 2 opens"),
    ((1,), ""),
]
METHODS: list[tuple[str, str, dict[str, Any]]] = [
    ("NR", "newton", {}),
    ("BFGS", "bfgs", {"snes_linesearch_max_it": 10}),
    ("MNR", "modified-newton", KEEP | {"snes_linesearch_type": "basic"}),
]

Bent = tuple[np.ndarray, np.ndarray, list[int | None]]  # of `bend`


def beam(method: str, options: Mapping[str, Any], law: Law) -> Frame:
    """The frame: node 0 is clamped; the plane is z = 0 through the undeformed beam, and it bends downwards."""
    nodes = LENGTH * np.array([[k, 0.0, 0.0] for k in range(4)])
    stiffness = C * rigidity(law) / LENGTH**3
    stops = Stops([1, 2], [0.0, 0.0, 1.0], -GAPS * SCALE * LENGTH, stiffness, 1e-6 * GAPS[0] * SCALE * LENGTH)
    plane = [(node, (1, 3, 5)) for node in (1, 2, 3)]
    pairs, rule = [(0, 1), (1, 2), (2, 3)], polar(4, 12, False)
    return Frame(nodes, pairs, RADIUS, law, rule, [(0, range(6)), *plane], method, options, [stops])


def rigidity(law: Law) -> float:
    """EI, N mm²."""
    return law.E * np.pi * RADIUS**4 / 4.0


def linear_beam(moment: float, shear: float) -> tuple[np.ndarray, np.ndarray]:
    """Forces on the base in EI/l² · SCALE and deflections in l · SCALE at nodes 2 and 3, downwards.

    Args:
        moment: M0 l/EI over SCALE.
        shear: EI/(GA l²).
    """
    x = np.array([1.0, 2.0])
    low, high = np.minimum(x[:, None], x), np.maximum(x[:, None], x)
    f, w0 = low**2 * (3.0 * high - low) / 6.0 + shear * low, 0.5 * moment * x**2
    for choice in product((False, True), repeat=2):
        closed, S = np.array(choice), np.zeros(2)
        if closed.any():
            A = f[np.ix_(closed, closed)] + np.eye(closed.sum()) / C
            S[closed] = np.linalg.solve(A, (w0 - GAPS)[closed])
        w = w0 - f @ S
        if np.all(S >= 0.0) and np.all(w[~closed] <= GAPS[~closed]):
            return S, w
    raise ValueError(f"no set of closed gaps fits the moment {moment}")


def bend(method: str, options: Mapping[str, Any], law: Law) -> Bent:
    """Forces on the base and deflections, both as in `linear_beam`, shape (10, 2), and iterations of each step."""
    frame = beam(method, options, law)
    unit = rigidity(law) / LENGTH**2 * SCALE
    forces, moved = np.full((10, 2), np.nan), np.full((10, 2), np.nan)
    counts: list[int | None] = [None] * 10
    for row, moment in enumerate(STEPS):
        outcome = frame.step(forces={frame.dof(3, 4): moment * unit * LENGTH})
        if not outcome.converged:
            break
        counts[row] = outcome.iterations
        forces[row] = frame.system.last.contributions[0].pressure / unit
        moved[row] = [-frame.moved(node)[2] / (LENGTH * SCALE) for node in (1, 2)]
    return forces, moved, counts


def run(study: Study) -> None:
    """Events, forces and iterations, row by row."""
    law = library.load("elastic", spin=True)
    found = {name: bend(method, options, law) for name, method, options in METHODS}
    forces, moved, _ = found["NR"]
    shear = law.E / law.G * (RADIUS / LENGTH) ** 2 / 4.0
    reference = [linear_beam(moment, shear) for moment in STEPS]
    rows = []
    for row, (moment, (S, _w), (closed, event)) in enumerate(zip(STEPS, reference, EVENTS, strict=True)):
        place = f"at M0 l/EI = {moment:.2f}"
        for k in range(2):
            study.check(
                f"node {k + 2} closed {place}", forces[row, k] > 0.0, k in closed, "Table 7.1's events", 0.0, "absolute"
            )
            name = f"S{k + 1} l/M0 {place}"
            study.check(name, forces[row, k] / moment, S[k] / moment, "linear beam", 1e-5, "absolute")
        for name in ("NR", "BFGS"):
            study.check(
                f"{name} iterations {place}",
                found[name][2][row] or np.inf,
                PRINTED[row][1],
                "Table 7.1, BFGS",
                kind="at_most",
            )
        counts = [shown(found[name][2][row]) for name in ("NR", "BFGS", "MNR")]
        rows.append(
            [
                f"{moment:.2f}",
                *(GAPS - moved[row]),
                *(forces[row] / moment),
                *counts,
                *(shown(n) for n in reversed(PRINTED[row])),
                event,
            ]
        )
    columns = ["M0 l/EI", "l1/l", "l2/l", "S1 l/M0", "S2 l/M0", "NR", "BFGS", "MNR", "BFGS, thesis", "MNR, thesis", ""]
    study.table("rolling beam; moments, distances and forces by 1e-6", columns, rows)
    draw(study, found, reference)


def shown(count: int | None) -> str:
    """A number of iterations, or that there was no convergence."""
    return "div." if count is None else str(count)


def draw(study: Study, found: dict[str, Bent], reference: list[tuple[np.ndarray, np.ndarray]]) -> None:
    """Distances and forces over the moment, and iterations."""
    forces, moved, _ = found["NR"]
    S, w = (np.array(part) for part in zip(*reference, strict=True))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 3.8), layout="constrained")
        gaps, pressures, counts = figure.subplots(1, 3)
        for k, colour in enumerate(("C0", "C3")):
            gaps.plot(STEPS, GAPS[k] - moved[:, k], "o", color=colour, ms=4, mfc="none", label=f"node {k + 2}, coilset")
            gaps.plot(STEPS, GAPS[k] - w[:, k], "-", color=colour, lw=0.8, label=f"node {k + 2}, linear beam")
            pressures.plot(STEPS, forces[:, k] / STEPS, "o", color=colour, ms=4, mfc="none", label=f"S{k + 1}, coilset")
            pressures.plot(STEPS, S[:, k] / STEPS, "-", color=colour, lw=0.8, label=f"S{k + 1}, linear beam")
        for axes, what in ((gaps, "distance from the base over l · 1e-6"), (pressures, "force on the base, S l/M0")):
            axes.axhline(0.0, color="0.6", lw=0.6)
            axes.set(xlabel="M0 l/EI, by 1e-6", ylabel=what)
            axes.grid(lw=0.3)
            axes.legend(fontsize=7)
        gaps.set_title("Rolling beam after 7.1.2")
        columns = [("BFGS", "C3", found["BFGS"][2], [row[1] for row in PRINTED])]
        counts.plot(found["NR"][2], "x", color="C0", ms=6, label="NR, coilset")
        figures.iterations(counts, [f"{moment:.2f}" for moment in STEPS], columns, "iterations")
        counts.set_xlabel("M0 l/EI, by 1e-6")
    study.figure("table_7_1", figure)
