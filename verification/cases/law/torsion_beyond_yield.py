"""Round bar twisted far beyond yield and released: torque and springback against the integral over the radius

A bar of radius 2.5 is twisted to γ = 2 % at its surface. Ideally plastic, A. Nadai's torque 2π/3 τy (R³ − c³/4) with
the elastic core's radius c is closed; for linear isotropic hardening and for Ck 15 it is 2π ∫ τ(ϑr) r² dr, with τ(γ) by
a high-order integration of the law's rates (`references/section_integrals.py`). When released, a bar that does not
yield again turns back by T/GJ; none of the three yields again. Without spin, which would add axial stress to pure
shear.

Tolerance: n rings are Gauss's points in r², and τ has a kink at the core's edge: 0.06/n²; up to 0.053/n² was found from
4 to 32 rings. The integration of the law in 80 steps adds a small part of it. The error of the springback is that of
the torque times T/GJ over the residual angle.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import polar
from coilset.verification.chain import ALL, ROTATION_X, ROTATION_Y, ROTATION_Z, Y, Z, chain, drive, straight
from coilset.verification.references.section_integrals import nadai_torque, shear_curve, torque
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS, SHEAR, STEPS = 10.0, 2.5, 0.02, 80  # mm, mm, γ at the surface
RINGS, FINE = (4, 8, 16, 32), 16
MATERIALS = ("ideal_plastic", "linear_isotropic", "ck15")

Twisted = tuple[np.ndarray, float, np.ndarray]  # of `twist`


def twist(law: Law, rings: int) -> Twisted:
    """Torques at the steps, N mm, the residual twist per length after release, 1/mm, and τ over r at the end."""
    held = [(0, ALL), (1, (Y, Z, ROTATION_Y, ROTATION_Z))]
    frame, torques = chain(straight(LENGTH, 1), RADIUS, law, polar(rings, 12), held), [0.0]
    end = frame.dof(1, ROTATION_X)
    drive(frame, STEPS, {end: SHEAR / RADIUS * LENGTH}, after=lambda: torques.append(frame.force(end)))
    stress = np.hypot(*frame.rod.point_state[0, 0, ::12, 1:3].T)
    drive(frame, 2, forces={end: 0.0})
    return np.array(torques), frame.rotation(1)[0] / LENGTH, stress


def reference(law: Law, ϑ: float) -> float:
    """Torque at the twist ϑ per length, N mm."""
    if law.name == "ideal_plastic":
        return nadai_torque(float(np.sqrt(0.5 * law.functions(0.0)[0])), law.G, RADIUS, ϑ)
    return torque(law, RADIUS, ϑ)


def run(study: Study) -> None:
    """Torque and springback of three materials over the rings."""
    ϑ, found, rows = SHEAR / RADIUS, {}, []
    for name in MATERIALS:
        law = library.load(name, spin=False)
        exact = reference(law, ϑ)
        runs = {rings: twist(law, rings) for rings in RINGS}
        found[name] = law, runs[FINE]
        tolerance = 0.06 / FINE**2
        source = "Nadai" if name == "ideal_plastic" else "integral over r"
        study.check(f"torque, {name}, N mm", runs[FINE][0][-1], exact, source, tolerance)
        back = exact / (0.5 * np.pi * law.G * RADIUS**4)
        study.check(f"residual twist, {name}, 1/mm", runs[FINE][1], ϑ - back, "T/GJ", tolerance * back / (ϑ - back))
        rows.append([name, *(f"{runs[rings][0][-1] / exact - 1:+.1e}" for rings in RINGS)])
    study.table(f"error of the torque, {STEPS} steps", ["material", *(f"{rings} rings" for rings in RINGS)], rows)
    draw(study, found)


def draw(study: Study, found: dict[str, tuple[Law, Twisted]]) -> None:
    """Torque over the twist, and τ over the radius."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.7), layout="constrained")
        left, right = figure.subplots(1, 2)
        shears, radii = np.linspace(0.0, SHEAR, STEPS + 1), np.linspace(0.0, RADIUS, 200)
        for (name, (law, (torques, _, stress))), colour in zip(found.items(), ("C0", "C1", "C3"), strict=True):
            left.plot(100 * shears, torques / 1000, color=colour, lw=1.2, label=f"{name}, coilset")
            some = shears[4::8]
            exact = [reference(law, shear / RADIUS) / 1000 for shear in some]
            left.plot(100 * some, exact, "o", color=colour, ms=3.5, mfc="none")
            if name == "ideal_plastic":
                curve = np.minimum(law.G * SHEAR * radii / RADIUS, np.sqrt(0.5 * law.functions(0.0)[0]))
            else:
                curve = shear_curve(law, SHEAR * radii / RADIUS)
            right.plot(radii, curve, "-", color=colour, lw=0.9)
            points = RADIUS * np.hypot(*polar(FINE, 12).points[::12].T)
            right.plot(points, stress, "o", color=colour, ms=3.5, mfc="none", label=f"{name}, coilset")
        left.set(
            xlabel="γ at the surface in %",
            ylabel="torque in N m",
            title="Torsion beyond yield; circles: integral over r",
        )
        right.set(
            xlabel="radius in mm", ylabel="τ in MPa", title=f"γ = {100 * SHEAR:g} % at the surface; lines: reference"
        )
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
    study.figure("torsion_beyond_yield", figure)
