"""Bar stretched by 1 % and then twisted to 2 %, and a thin tube likewise, against integrals of the law's rates

At constant length the twist removes the axial force: on the yield surface σ = σ0 cos θ, τ = σ0/√3 sin θ, and for an
ideally plastic point θ(γ) has a closed form (`references/section_integrals.py`, after R. Hill). A thin tube is one such
point; in a bar γ grows with r, and force and torque are integrals over the radius. For Ck 15 the rates are integrated
with DOP853 at 40 radii. Without spin, whose second-order stress is a separate question (case elastic-strain-loop).

Tolerance, of stresses over σ0 and of N and T over their fully plastic values, absolute: the law's second order,
1/steps² for σ and N and 0.1/steps² for τ and T (found at 200 steps: 0.7 and 0.05). With n rings 0.3/n² is added for N,
which is carried by the core alone: from 8 × 16 to 24 × 32 points it changes by 2e-3 for Ck 15, T by 3e-4.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import DiskRule, polar
from coilset.verification.chain import ALL, ROTATION_X, X, chain, drive, straight
from coilset.verification.references.section_integrals import plastic_path, tube_shear
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS = 10.0, 2.5  # mm
STRETCH, SHEAR, STEPS = 0.01, 0.02, 200  # γ at the surface; steps of the twist
RULES = ((8, 16), (24, 32))
TUBE = DiskRule(polar(1, 16).points / np.hypot(*polar(1, 16).points[0]), np.full(16, 1.0 / 16.0), "ring of 16 points")


def pull_and_twist(law: Law, rule: DiskRule) -> np.ndarray:
    """Axial force (N) and torque (N mm) at the steps of the twist, shape (STEPS + 1, 2)."""
    frame, rows = chain(straight(LENGTH, 1), RADIUS, law, rule, [(0, ALL), (1, range(1, 6))]), []

    def keep() -> None:
        rows.append(frame.resultants[0, 0, [0, 3]])

    length = LENGTH * np.expm1(STRETCH)  # ε is logarithmic
    drive(frame, 40, {frame.dof(1, X): length})
    keep()
    twist = SHEAR / RADIUS * LENGTH * np.exp(STRETCH)  # φ′ refers to the current length
    drive(frame, STEPS, {frame.dof(1, X): 0.0, frame.dof(1, ROTATION_X): twist}, after=keep)
    return np.array(rows)


def point(law: Law, shears: np.ndarray) -> np.ndarray:
    """σ and τ of a point at increasing shear angles after the stretch, shape (n, 2), MPa."""
    if law.name == "ideal_plastic":
        top = 0.5 * np.pi - 1e-9
        angles = [brentq(lambda a, γ=γ: tube_shear(law.yield_stress, law.E, law.G, a) - γ, 0.0, top) for γ in shears]
        return law.yield_stress * np.stack([np.cos(angles), np.sin(angles) / np.sqrt(3.0)], axis=1)
    limit = law.yield_stress / law.E
    first = np.array([law.yield_stress, 0.0, 0.0, 0.0, 0.0])
    start = plastic_path(law, first, np.array([1.0, 0.0]), np.array([0.0, STRETCH - limit]))[-1]
    return plastic_path(law, start, np.array([0.0, 1.0]), np.append(0.0, shears))[1:, :2]


def exact(law: Law) -> tuple[np.ndarray, np.ndarray]:
    """σ, τ of the tube, MPa; N and T of the bar, N and N mm."""
    ξ, w = np.polynomial.legendre.leggauss(40)
    r, w = 0.5 * RADIUS * (1.0 + ξ), 0.5 * RADIUS * w * 2.0 * np.pi
    states = point(law, np.append(SHEAR * r / RADIUS, SHEAR))
    return states[-1], np.array([w @ (states[:-1, 0] * r), w @ (states[:-1, 1] * r**2)])


def run(study: Study) -> None:
    """Tube and bar of two materials, two rules."""
    area, curves, rows = np.pi * RADIUS**2, {}, []
    for name in ("ideal_plastic", "ck15"):
        law = library.load(name, spin=False)
        (σ, τ), bar = exact(law)
        full = law.yield_stress * np.array([area, 2.0 * np.pi / 3.0 / np.sqrt(3.0) * RADIUS**3])
        tube = pull_and_twist(law, TUBE) / (area, area * RADIUS)
        study.check(
            f"tube, {name}: σ/σ0",
            tube[-1, 0] / law.yield_stress,
            σ / law.yield_stress,
            "rates",
            1.0 / STEPS**2,
            "absolute",
        )
        study.check(
            f"tube, {name}: τ/σ0",
            tube[-1, 1] / law.yield_stress,
            τ / law.yield_stress,
            "rates",
            0.1 / STEPS**2,
            "absolute",
        )
        for rule in RULES:
            curves[name, rule] = found = pull_and_twist(law, polar(*rule)) / full
            if rule == RULES[-1]:
                tolerance = 1.0 / STEPS**2 + 0.3 / rule[0] ** 2
                study.check(
                    f"bar, {name}: N/N0", found[-1, 0], bar[0] / full[0], "integral over r", tolerance, "absolute"
                )
                study.check(
                    f"bar, {name}: T/T0", found[-1, 1], bar[1] / full[1], "integral over r", 0.1 / STEPS**2, "absolute"
                )
            rows.append([name, "{} × {}".format(*rule), *(f"{e:+.1e}" for e in found[-1] - bar / full)])
    study.table(f"bar, {STEPS} steps: error over the fully plastic value", ["material", "points", "N", "T"], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.8), layout="constrained")
        axes = figure.add_subplot()
        shears = 100 * np.linspace(0.0, SHEAR, STEPS + 1)
        for name, colour in (("ideal_plastic", "C0"), ("ck15", "C3")):
            found = curves[name, RULES[-1]]
            axes.plot(shears, found[:, 0], "-", color=colour, lw=1.2, label=f"N/N0, {name}")
            axes.plot(shears, found[:, 1], "--", color=colour, lw=1.2, label=f"T/T0, {name}")
        axes.set(
            xlabel="γ at the surface in %",
            ylabel="over the fully plastic value",
            title="Stretched by 1 %, then twisted",
        )
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("tension_then_torsion", figure)
