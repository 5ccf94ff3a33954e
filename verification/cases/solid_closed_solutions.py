"""The solid against closed solutions: torsion of a straight wire, elastic and after Nadai, and its limit moment

A straight wire of 5 mm between rigid heads. Elastic torsion: the field lies in the elements' space, only their
parabolic outline errs, with the fourth power of the element's size or better. Ideal plastic torsion has Nadai's torque
(2π/3) τ_y R³ (1 − ¼ (θ_y/θ)³). At the limit moment 4/3 σ_y R³ elements that lock do not come to rest: the same ones
with full integration go on rising, by 1.5 % from 8 to 16 times the curvature of first yield.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.solid import SectionGrid, straight_wire
from coilset.model.material import library
from coilset.model.results.figures import STYLE
from coilset.model.solid.heads import Motion
from coilset.model.solid.points import MaterialPoints
from coilset.model.solid.problem import SolidProblem
from coilset.verification.solid_vs_rod.references import nadai_torque

FAST = True
d, R = 5.0, 2.5


def straight(law, grid, length=5.0, layers=2):
    """A straight wire between heads."""
    wire = straight_wire(d, length, layers, MPI.COMM_SELF, grid)
    return SolidProblem(wire, MaterialPoints(law), "direct")


def torques(problem, angles):
    """Torque of the top head at each angle, N mm."""
    out = []
    for angle in angles:
        problem.step(Motion(rotation=(0.0, 0.0, angle)))
        out.append(problem.reactions(np.zeros(3))[1].moment[2])
    return np.array(out)


def bending(problem, length, curvatures):
    """Moment of the bottom head when the top head is turned and moved along arcs, N mm."""
    out = []
    for curvature in curvatures:
        turn, ρ = curvature * length, 1 / curvature
        problem.step(Motion((0.0, -ρ * (1 - np.cos(turn)), ρ * np.sin(turn) - length), (turn, 0.0, 0.0)))
        out.append(-problem.reactions(np.zeros(3))[0].moment[0])
    return np.array(out)


def run(study):
    """Torsion, elastic and plastic, and bending."""
    elastic, ideal = library.load("elastic"), library.load("ideal_plastic")
    exact = elastic.G * np.pi * R**4 / 2 * 1e-6 / 5.0
    errors = [torques(straight(elastic, SectionGrid(n, n)), [1e-6])[0] / exact - 1 for n in (1, 2, 4)]
    for n, coarse, fine in ((2, errors[0], errors[1]), (4, errors[1], errors[2])):
        study.check(f"elastic torsion, order of the error at {n} elements a side", -np.log2(abs(coarse / fine)), -4.0,
                    "theory, at least 4", 0.0, "at_most")  # fmt: skip
    study.check("elastic torque, 4 elements a side, N mm", exact * (1 + errors[2]), exact, "G I_p θ/L", 1e-4)

    yield_shear, ratios = ideal.yield_stress / np.sqrt(3), np.array([1.0, 1.25, 1.5, 2.0, 3.0, 5.0])
    found = torques(straight(ideal, SectionGrid(4, 4)), ratios * yield_shear * 5.0 / (ideal.G * R))
    for ratio, torque in zip(ratios, found, strict=True):
        nadai = nadai_torque(yield_shear, R, ratio)
        study.check(f"torque at θ/θ_y = {ratio:g}, N mm", torque, nadai, "Nadai 1931", 5e-3)

    length, limit = 20.0, 4 / 3 * ideal.yield_stress * R**3
    curvatures = np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    first = ideal.yield_stress / ideal.E / R
    moments = bending(straight(ideal, SectionGrid(2, 1), length, 6), length, curvatures * first)
    study.check("limit moment, N mm", moments[-1], limit, "4/3 σ_y R³", 0.01)
    study.check("rise from 8 to 16 times the curvature of yield, over the limit", (moments[-1] - moments[-2]) / limit,
                0.0, "no locking", 2e-3, "at_most")  # fmt: skip
    study.figure("solid_closed_solutions", _figure(ratios, found, yield_shear, curvatures, moments / limit))


def _figure(ratios, found, yield_shear, curvatures, moments):
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        fine, full = np.linspace(1, 5, 100), nadai_torque(yield_shear, R, np.inf)
        left.plot([0, *fine], [0, *nadai_torque(yield_shear, R, fine) / full], "k-", lw=1, label="Nadai 1931")
        left.plot(ratios, found / full, "C0o", ms=5, label="solid")
        left.set(xlabel="twist over that of first yield", ylabel="torque over the limit", title="Ideal plastic torsion")
        right.plot(curvatures, moments, "C0o-", ms=5, lw=1, label="solid")
        right.axhline(1, color="k", lw=1, label="4/3 σ_y R³")
        right.set(xlabel="curvature over that of first yield", ylabel="moment over the limit", title="Bending")
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
    return figure
