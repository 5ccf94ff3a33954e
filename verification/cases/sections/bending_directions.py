"""Ideally plastic bar bent about several axes: moment against the integral, for several section rules

A round wire has no preferred direction, but a rule with equal angles has. A bar is bent to 2, 5 and 20 times the
curvature at yield, about axes from 0° to 30°; the reference is ∫ σ z dA with σ = min(E κ z, σy). The kinks at the edge
of the elastic core cross the rule's rings: the error is proportional to the square of the angle between points, 2π/n,
and depends on where the axis lies between them.

Tolerance: 0.08 (2π/n)² (0.5 % with 24, 0.14 % with 48 angles); the errors found are two thirds to nine tenths of that.
12 angles give plastic bending to within 2 %. The rings of the default rule are rotated relative to each other: 0.2 %,
with twenty angles on each ring.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import polar
from coilset.verification.chain import ALL, ROTATION_X, ROTATION_Y, ROTATION_Z, chain, drive, straight
from coilset.verification.references.section_integrals import bending_moment
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS, STEPS = 1.0, 2.5, 4  # mm
RULES = ((4, 12, False), (8, 24, False), (8, 48, False), (8, 20, True))  # rings, angles, staggered
FACTORS = (2.0, 5.0, 20.0)  # curvature over that at yield
DIRECTIONS = np.arange(0.0, 31.0, 7.5)  # of the axis, degrees


def moment(law: Law, rule: tuple[int, int, bool], curvature: float, direction: float) -> float:
    """Moment about the axis of bending, N mm."""
    frame = chain(straight(LENGTH, 1), RADIUS, law, polar(*rule), [(0, ALL), (1, (ROTATION_X,))])
    axis = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    moves = {
        frame.dof(1, dof): curvature * LENGTH * part for dof, part in zip((ROTATION_Y, ROTATION_Z), axis, strict=True)
    }
    drive(frame, STEPS, moves)
    return float(frame.resultants[0].mean(axis=0)[4:] @ axis)


def run(study: Study) -> None:
    """Errors over the direction."""
    law, errors = library.load("ideal_plastic"), {}
    for factor in FACTORS:
        curvature = factor * law.yield_stress / (law.E * RADIUS)
        exact = bending_moment(law.yield_stress, law.E, RADIUS, curvature)
        for rule in RULES:
            errors[factor, rule] = [moment(law, rule, curvature, at) / exact - 1.0 for at in DIRECTIONS]
            worst = np.abs(errors[factor, rule]).max()
            what = f"maximum error of the moment, {factor:g} κy, {polar(*rule).name}"
            tolerance = 2e-3 if rule[2] else 0.08 * (2.0 * np.pi / rule[1]) ** 2
            study.check(what, worst, 0.0, "∫ σ z dA", tolerance, "absolute")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.0, 3.5), layout="constrained")
        for axes, factor in zip(figure.subplots(1, len(FACTORS), sharey=True), FACTORS, strict=True):
            for rule in RULES:
                label = polar(*rule).name.removeprefix("polar ")
                axes.plot(DIRECTIONS, 100 * np.array(errors[factor, rule]), "o-", ms=3, lw=1, label=label)
            axes.set(xlabel="direction of the axis in °", title=f"κ = {factor:g} κ at yield")
            axes.grid(lw=0.3)
        figure.axes[0].set_ylabel("error of the moment in %")
        figure.axes[0].legend(fontsize=8, title="rings × angles")
    study.figure("bending_directions", figure)
