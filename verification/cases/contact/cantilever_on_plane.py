"""A cantilever pressed on a plane: force and position of the contact as it lies down, against the linear beam

A beam of length L, clamped at an inclination α at the height h above a frictionless plane, touches it with its tip at h
= α L. As the clamp is lowered, only the tip bears at first: P = 3 EI (α L − h)/L³. Its slope vanishes at h = α L/3;
from then on the beam lies flat from x = c outwards, free of force except for P at c itself, where the curvature is
zero. The part up to c is a cantilever with α c − h = P c³/(3 EI) and α − P c²/(2 EI) = 0, so that

    c = 3 h/α,    P = 2 α EI/c² = 2 α³ EI/(9 h²).

The contact is located where the force of the seat acts. Tolerances: the error of the linear beam is about α² = 1e-4;
the position is found between points 1.25 mm apart, and the contact stiffness lets the beam sink in by less than 1e-3 of
h.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.contact.base import SEAT_DOFS
from coilset.model.core.contact.seat import Seat
from coilset.model.core.material import library
from coilset.model.core.section.rules import polar
from coilset.verification.frame import Frame
from coilset.verification.study import Study
from coilset.verification.wire_points import wire_points

FAST = True
LENGTH, RADIUS, SLOPE, ELEMENTS = 200.0, 1.0, 0.01, 80  # mm, mm, rad
BEDDING, ONSET = 5000.0, 1e-4  # N/mm per mm, mm
STEPS = 24
LOWEST = 0.12  # h/(α L) at the end


def press() -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Heights of the clamp (mm), forces on the plane (N) and their positions (mm from the clamp)."""
    law = library.load("elastic")
    along = np.linspace(LENGTH, 0.0, ELEMENTS + 1)  # from the tip to the clamp
    nodes = np.stack([along * np.cos(SLOPE), 0 * along, (LENGTH - along) * np.sin(SLOPE) + RADIUS], axis=1)
    points = wire_points(nodes, RADIUS)
    seat = Seat("bottom", points, points.radius, nodes, np.zeros(2 * SEAT_DOFS), BEDDING, ONSET)
    held = [(ELEMENTS, range(6)), *((node, (1, 3, 5)) for node in range(ELEMENTS))]
    pairs = [(k, k + 1) for k in range(ELEMENTS)]
    frame = Frame(nodes, pairs, RADIUS, law, polar(4, 12, False), held, contacts=[seat])
    heights = np.sin(SLOPE) * LENGTH * np.linspace(1.0, LOWEST, STEPS + 1)
    rows: list[tuple[float, float]] = []
    for step in np.diff(heights):
        if not frame.step(moves={frame.dof(ELEMENTS, 2): step}, predictor_scale=1.0 if rows else None).converged:
            raise RuntimeError(f"no equilibrium at step {len(rows) + 1}")
        part = frame.system.last.contributions[0]
        x = points.at(frame.layout.gather(frame.rod.x))[part.point, 0]
        rows.append((part.pressure.sum(), part.pressure @ x / part.pressure.sum()))
    forces, places = np.array(rows).T
    return heights[1:], forces, places, law.E * np.pi * RADIUS**4 / 4.0


def closed_form(h: np.ndarray, EI: float) -> tuple[np.ndarray, np.ndarray]:
    """Force and its position for the linear beam, N and mm."""
    tip = h > SLOPE * LENGTH / 3.0
    c = np.where(tip, LENGTH, 3.0 * h / SLOPE)
    return np.where(tip, 3.0 * EI * (SLOPE * LENGTH - h) / LENGTH**3, 2.0 * SLOPE * EI / c**2), c


def run(study: Study) -> None:
    """Forces and positions as the clamp is lowered."""
    h, force, place, EI = press()
    P, c = closed_form(h, EI)
    for k in range(3, STEPS, 4):
        at = f"at h = {h[k]:.3f} mm"
        study.check(f"force {at}, N", force[k], P[k], "linear beam", 0.005)
        study.check(f"place of the contact {at}, mm", place[k], c[k], "linear beam", 0.005)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        fine = np.linspace(h[-1], SLOPE * LENGTH, 300)
        for axes, ours, theirs, what in ((left, force, 0, "force in N"), (right, place, 1, "place of the force in mm")):
            axes.plot(fine, closed_form(fine, EI)[theirs], "-", lw=0.9, label="linear beam")
            axes.plot(h, ours, "o", ms=4, mfc="none", label="coilset")
            axes.axvline(SLOPE * LENGTH / 3.0, color="0.6", lw=0.8, ls="--", label="the tip lies flat")
            axes.set(xlabel="height of the clamp in mm", ylabel=what)
            axes.grid(lw=0.3)
        left.legend(fontsize=8)
        left.set_title("Cantilever pressed on a plane")
        study.figure("cantilever_on_plane", figure)
