"""Two rods of different thickness that cross at 60°, pressed together: force against two beams in series

Rod 1 (length l1, radius r1) lies over rod 2 (l2, r2); both are clamped at both ends and cross at the middle of rod 1
and at a quarter of rod 2. The ends of rod 1 are lowered by δ. A clamped beam loaded at the distances a and b from its
ends has the stiffness k = 3 l³ EI/(a³ b³), with shear 1/k = a³ b³/(3 l³ EI) + a b/(l GA); hence with the penetration p

    F = (δ − p)/(1/k1 + 1/k2).

Where contact begins depends on both radii: the initial gap is 0.025 mm. Tolerances: membrane forces contribute in
proportion to (deflection/radius)², below 1e-3 of the force. The contact acts at one point of each rod, a station of
both, and its stiffness c is that of both points together: F is c p²/(4w) up to p = 2w and c (p − w) beyond, except for
the small tilt of the line connecting the points.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.contact.coils import Coils
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import polar
from coilset.verification.frame import Frame
from coilset.verification.study import Study
from coilset.verification.wire_points import wire_points

FAST = True
LENGTHS, RADII, PLACES, ANGLE = (200.0, 240.0), (2.0, 3.0), (0.5, 0.25), np.pi / 3.0  # mm, mm, of l, rad
ELEMENTS, GAP = 40, 0.025  # of each rod; mm
BEDDING, ONSET = 5000.0, 1e-3  # N/mm per mm, mm
TRAVEL = 0.025 * np.arange(1, 8)  # mm


def contact(wires: list[np.ndarray]) -> Coils:
    """Coils of two wires whose stations follow each other; nothing bears between the end of one and the other."""
    stations, count = np.vstack(wires), len(wires[0])
    turns = np.concatenate([np.linspace(first, first + 0.4, count) for first in (0.0, 1.0)])
    coils = Coils(wire_points(stations, np.repeat(RADII, count), turns), stations, BEDDING, ONSET)
    coils.stiffness[(coils.points.turns > 0.4) & (coils.points.turns < 1.0)] = 0.0
    return coils


def press() -> tuple[np.ndarray, np.ndarray, float, Law]:
    """Forces on the ends of rod 1 and penetrations at TRAVEL, N and mm, stiffness c of the crossing, and the law."""
    law = library.load("elastic")
    directions = ((1.0, 0.0, 0.0), (np.cos(ANGLE), np.sin(ANGLE), 0.0))
    wires = [
        np.outer(length * (np.linspace(0.0, 1.0, ELEMENTS + 1) - place), direction)
        for length, place, direction in zip(LENGTHS, PLACES, directions, strict=True)
    ]
    wires[0] += [0.0, 0.0, sum(RADII) + GAP]
    coils, count = contact(wires), ELEMENTS + 1
    ends = [0, ELEMENTS, count, count + ELEMENTS]
    held = [(node, range(6)) for node in ends]
    pairs = [(first + k, first + k + 1) for first in (0, count) for k in range(ELEMENTS)]
    frame = Frame(np.vstack(wires), pairs, np.repeat(RADII, ELEMENTS), law, polar(4, 12, False), held, contacts=[coils])
    driven = [frame.dof(node, 2) for node in ends[:2]]
    rows: list[tuple[float, float]] = []
    for step in np.diff(np.append(0.0, TRAVEL)):
        if not frame.step(moves=dict.fromkeys(driven, -step)).converged:
            raise RuntimeError(f"no equilibrium at step {len(rows) + 1}")
        rows.append(
            (-sum(frame.force(dof) for dof in driven), frame.system.last.contributions[0].penetration.max(initial=0.0))
        )
    bearing = coils.stiffness[[2 * int(PLACES[0] * ELEMENTS), 2 * (count + int(PLACES[1] * ELEMENTS))]].sum()
    forces, penetrations = np.array(rows).T
    return forces, penetrations, bearing, law


def compliance(law: Law) -> float:
    """1/k1 + 1/k2, mm/N."""
    total = 0.0
    for length, radius, place in zip(LENGTHS, RADII, PLACES, strict=True):
        a, b, area = place * length, (1.0 - place) * length, np.pi * radius**2
        total += (a * b) ** 3 / (3.0 * length**3 * law.E * area * radius**2 / 4.0) + a * b / (length * law.G * area)
    return total


def run(study: Study) -> None:
    """Forces and penetrations as rod 1 goes down."""
    force, depth, c, law = press()
    study.check("force before they touch, N", force[0], 0.0, "gap 0.025 mm", 1e-9, "absolute")
    for travel, F, p in zip(TRAVEL[1:], force[1:], depth[1:], strict=True):
        at = f"at δ = {travel:.3f} mm"
        study.check(f"force {at}, N", F, (travel - GAP - p) / compliance(law), "beams in series", 1e-3)
        bedded = c * p**2 / (4.0 * ONSET) if p < 2.0 * ONSET else c * (p - ONSET)
        study.check(f"force from the penetration {p:.6f} mm {at}, N", F, bedded, "law of the onset", 1e-3)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        left.plot(TRAVEL, force, "o", ms=4, mfc="none", label="coilset")
        travel = np.append(GAP, TRAVEL[1:])
        left.plot(travel, (travel - GAP - np.append(0.0, depth[1:])) / compliance(law), lw=0.9, label="beams in series")
        right.plot(1e3 * depth[1:], force[1:], "o", ms=4, mfc="none", label="coilset")
        p = np.linspace(0.0, depth[-1], 100)
        bedded = np.where(p < 2.0 * ONSET, c * p**2 / (4.0 * ONSET), c * (p - ONSET))
        right.plot(1e3 * p, bedded, lw=0.9, label="bedding with its onset")
        left.set(xlabel="travel of the ends in mm", ylabel="force in N", title="Two rods crossed at 60°")
        right.set(xlabel="penetration in µm", ylabel="force in N")
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
        study.figure("crossed_rods", figure)
