"""An elastic ring pressed between two plates, far beyond flattening, against the elastica

A thin ring of radius R between frictionless plates 2 h apart. A quarter of it, from the plate (slope φ = 0) to the side
(φ = π/2), carries the vertical force V = F/2. If inextensible and without shear, it obeys EI φ″ = V cos φ, hence φ′² =
κ0² + 2 V/EI sin φ with the curvature κ0 at the plate, and

    πR/2 = ∫ dφ/φ′,    h = ∫ sin φ dφ/φ′    from 0 to π/2.

For small loads this is F = (2R − 2h) EI/(R³ (π/4 − 2/π)). κ0 falls to zero at F = 2.786 EI/R², h = 0.718 R; from then
on the ring lies flat on the plate between two forces F/2, with κ0 = 0 beside them. Then both integrals are Beta
functions, and

    F = EI (B(3/4, 1/2)/2)²/h² = 1.4355 EI/h²,    half the flat length a = πR/2 − h B(1/4, 1/2)/B(3/4, 1/2).

Half of a ring of 192 straight rods is computed, held at its sides as symmetry requires. Tolerances: for the force 0.1
%, since the error of a polygon of N rods is about (π/N)² = 3e-4 and axial strain contributes (r/R)² = 1e-4; for the
flat length half the spacing of the contact points, 0.016 R.
"""

from collections.abc import Callable

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import beta

from coilset.model.core.base.style import STYLE
from coilset.model.core.contact.base import LEVEL, SEAT_DOFS
from coilset.model.core.contact.seat import Seat
from coilset.model.core.material import library
from coilset.model.core.section.rules import polar
from coilset.verification.frame import Frame
from coilset.verification.study import Study
from coilset.verification.wire_points import wire_points

FAST = True
RING, RADIUS, ELEMENTS = 100.0, 1.0, 96  # mm, mm, rods of half a ring
BEDDING, ONSET = 5000.0, 1e-4  # N/mm per mm, mm
HEIGHTS = np.array([0.98, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.65, 0.6, 0.55, 0.5, 0.45, 0.4])  # h/R
LENGTH_INTEGRAL, HEIGHT_INTEGRAL = beta(0.25, 0.5) / 2.0, beta(0.75, 0.5) / 2.0
SPLIT = np.pi / 2.0 * HEIGHT_INTEGRAL / LENGTH_INTEGRAL  # h/R at which the ring leaves the plate in its middle


def elastica(height: float) -> tuple[float, float]:
    """F R²/EI and half the flat length over R at a height over R."""
    if height <= SPLIT:
        return (HEIGHT_INTEGRAL / height) ** 2, np.pi / 2.0 - height * LENGTH_INTEGRAL / HEIGHT_INTEGRAL

    def integral(k2: float, v: float, weight: Callable[[float], np.ndarray]) -> float:
        return quad(lambda t: weight(t) / np.sqrt(k2 + 2.0 * v * np.sin(t)), 0.0, np.pi / 2.0)[0]

    def force(k2: float) -> float:  # V of the right length; it is 0 for κ0 = 1
        return brentq(lambda v: integral(k2, v, np.ones_like) - np.pi / 2.0, 0.0, 3.0)

    k2 = brentq(lambda k2: integral(k2, force(k2), np.sin) - height, 1e-9, 1.0)
    return 2.0 * force(k2), 0.0


def press() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """F R²/EI, and half the distance between the outermost forces over R, at HEIGHTS; positions of the last state."""
    law = library.load("elastic")
    angle = np.pi * np.linspace(0.0, 1.0, ELEMENTS + 1)
    nodes = np.stack([RING * np.cos(angle), 0 * angle, RING * (np.sin(angle) - 1.0) - RADIUS], axis=1)
    points = wire_points(nodes, RADIUS)
    seat = Seat("top", points, points.radius, nodes, np.zeros(2 * SEAT_DOFS), BEDDING, ONSET)
    sides = [(node, (1, 2, 3, 4, 5)) for node in (0, ELEMENTS)]
    held = [*sides, (ELEMENTS // 2, (0, 1, 3, 5)), *((node, (1, 3, 5)) for node in range(1, ELEMENTS))]
    pairs = [(k, k + 1) for k in range(ELEMENTS)]
    frame = Frame(nodes, pairs, RADIUS, law, polar(4, 12, False), held, contacts=[seat])
    level = int(frame.layout.seat_dofs[SEAT_DOFS + LEVEL])
    rows: list[tuple[float, float]] = []
    for step in np.diff(np.append(1.0, HEIGHTS)) * RING:
        if not frame.step(moves={level: step}).converged:
            raise RuntimeError(f"no equilibrium at step {len(rows) + 1}")
        part = frame.system.last.contributions[0]
        x = points.at(frame.layout.gather(frame.rod.x))[part.point, 0]
        right = x > 0.0
        middle = (part.pressure * x)[right].sum() / max(part.pressure[right].sum(), 1e-300)
        rows.append((part.pressure.sum(), middle / RING))
    EI = law.E * np.pi * RADIUS**4 / 4.0
    force, flat = np.array(rows).T
    return force * RING**2 / EI, flat, frame.layout.gather(frame.rod.x) + np.array([0.0, 0.0, RING + RADIUS])


def run(study: Study) -> None:
    """Forces, and the flat length."""
    force, flat, x = press()
    reference = np.array([elastica(height) for height in HEIGHTS])
    for height, ours, half, (F, a) in zip(HEIGHTS, force, flat, reference, strict=True):
        study.check(f"F R²/EI at h = {height:.2f} R", ours, F, "elastica", 0.001)
        if a > 0.0:
            study.check(f"half the flat length at h = {height:.2f} R, R", half, a, "elastica", 0.008, "absolute")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.6, 3.6), layout="constrained")
        left, middle, right = figure.subplots(1, 3)
        fine = np.linspace(HEIGHTS[-1], 0.995, 80)
        curve = np.array([elastica(height) for height in fine])
        for axes, ours, k, what in ((left, force, 0, "F R²/EI"), (middle, flat, 1, "half the flat length over R")):
            axes.plot(fine, curve[:, k], "-", lw=0.9, label="elastica")
            axes.plot(HEIGHTS, ours, "o", ms=4, mfc="none", label="coilset")
            axes.axvline(SPLIT, color="0.6", lw=0.8, ls="--", label="flattening, h = 0.718 R")
            axes.set(xlabel="half of the plates' distance over R", ylabel=what)
            axes.grid(lw=0.3)
        left.legend(fontsize=8)
        left.set_title("Ring between two plates")
        for sign in (1.0, -1.0):
            right.plot(x[:, 0], sign * x[:, 2], "C0-", lw=1.2)
            right.axhline(sign * (HEIGHTS[-1] * RING + RADIUS), color="0.4", lw=0.8)
        right.set(aspect="equal", xlabel="x in mm", ylabel="z in mm", title=f"at h = {HEIGHTS[-1]:g} R")
        study.figure("ring_between_plates", figure)
