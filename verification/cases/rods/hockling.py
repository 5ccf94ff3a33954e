"""Torque at which a straight clamped rod leaves its axis (hockling), without and under tension, against Greenhill

A straight wire is clamped at both ends; one end is free to move along the axis and is rotated about it. Under tension
of 0, ¼, ½ and ¾ of 4π² EI/L² it is twisted until the lowest eigenvalue of the symmetric part of the tangent vanishes; T
is read off the sections there. Without tension T L/EI = 2 · 4.493409, under tension it follows from a transcendental
equation (`references/stability.py`). One per cent below that torque no pivot of the tangent is negative; one per cent
above it two are, because the rod may deflect to any side.

Tolerance: 0.05 (TL/EI)²/n², for 80 rods; the factor is 1.1 to 1.4 times what was found, and the error falls by a factor
of 6 from 40 to 80 rods. r/L = 3e-3, so shear contributes (r/2L)² (T L/EI)² E/G, up to 1e-3 of this.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy import sparse
from scipy.optimize import brentq

from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.verification.chain import ALL, ROTATION_X, ROTATION_Y, ROTATION_Z, X, Y, Z, chain, straight
from coilset.verification.references.stability import twisted_rod
from coilset.verification.stability import lowest_eigenvalue, negative_pivots, tangent
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS = 100.0, 0.3  # mm
TENSIONS = (0.0, 0.25, 0.5, 0.75)  # over 4π² EI/L²
MESHES = (20, 40, 80)


class TwistedRod:
    """A straight rod under a tension; `twist` brings it to another torque T L/EI."""

    def __init__(self, tension: float, elements: int) -> None:
        law = library.load("elastic")
        self.EI, self.GJ = law.E * np.pi * RADIUS**4 / 4.0, law.G * np.pi * RADIUS**4 / 2.0
        self.frame = chain(
            straight(LENGTH, elements), RADIUS, law, held=[(0, ALL), (elements, (Y, Z, ROTATION_Y, ROTATION_Z))]
        )
        self.turn, self.torque = self.frame.dof(elements, ROTATION_X), 0.0
        self.pull = {self.frame.dof(elements, X): tension * 4.0 * np.pi**2 * self.EI / LENGTH**2}
        self.twist(0.0)

    def twist(self, torque: float) -> sparse.csc_array:
        """Go to a torque T L/EI; the tangent there, of the free unknowns."""
        moves = {self.turn: (torque - self.torque) * self.EI / self.GJ}
        outcome = self.frame.step(moves=moves, forces=self.pull)
        if not outcome.converged:
            raise SolveError(f"T L/EI = {torque:g}: {outcome.reason}")
        self.torque = torque
        return tangent(self.frame.system, self.frame.load)

    def critical(self, near: float) -> tuple[float, float]:
        """T L/EI in the sections where the lowest eigenvalue vanishes, sought within 4 % of `near`."""
        found = brentq(lambda torque: lowest_eigenvalue(self.twist(torque)), 0.96 * near, 1.04 * near, xtol=1e-7)
        self.twist(found)
        return found, self.frame.resultants[0, 0, 3] * LENGTH / self.EI


def run(study: Study) -> None:
    """Critical torques, and the signs of the pivots on either side of them."""
    rows: list[list[object]] = []
    found: dict[int, list[float]] = {n: [] for n in MESHES}
    for tension in TENSIONS:
        exact = twisted_rod(tension)
        for n in MESHES:
            rod = TwistedRod(tension, n)
            driven, torque = rod.critical(exact)
            found[n].append(torque)
        at = f"P = {tension:g} · 4π² EI/L²"
        study.check(f"T L/EI, {at}, {n} rods", torque, exact, "Greenhill", 0.05 * (exact / n) ** 2)
        for factor, count in ((0.99, 0), (1.01, 2)):
            pivots = negative_pivots(rod.twist(factor * driven))
            study.check(
                f"negative pivots at {factor:g} of the critical torque, {at}",
                pivots,
                count,
                "stability",
                0.0,
                "absolute",
            )
        rows.append([tension, exact, *(f"{found[m][-1] / exact - 1:+.1e}" for m in MESHES)])
    columns = ["P over 4π² EI/L²", "T L/EI, Greenhill", *(f"error, {n} rods" for n in MESHES)]
    study.table("critical torque", columns, rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.4, 3.6), layout="constrained")
        axes = figure.add_subplot()
        fine = np.linspace(0.0, 0.8, 60)
        axes.plot(fine, [twisted_rod(tension) for tension in fine], "-", lw=0.9, label="Greenhill")
        for n, marker in zip(MESHES, "+xo", strict=True):
            axes.plot(TENSIONS, found[n], marker, ms=5, mfc="none", label=f"coilset, {n} rods")
        axes.set(xlabel="tension over 4π² EI/L²", ylabel="critical torque T L/EI", title="Hockling of a clamped rod")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("hockling", figure)
