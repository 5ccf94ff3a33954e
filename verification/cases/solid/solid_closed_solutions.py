"""The solid against closed solutions: torsion of a straight wire, elastic and after Nadai, and its limit moment

A straight wire of 5 mm between rigid heads. Elastic torsion: the field lies in the space of the elements; only their
parabolic outline causes an error, which falls with the fourth power of the element size or faster. Ideally plastic
torsion has Nadai's torque (2π/3) τ_y R³ (1 − ¼ (θ_y/θ)³); the tolerance, 0.1 %, is twice what was found. The bending
moment tends to 4/3 σ_y R³ as in beam theory; elements that lock do not reach a limit: the same elements with full
integration carry 1.5 % too much at 16 times the curvature of first yield. The yield stress is a tenth of the library's
there, so that strains stay small.
"""

from collections.abc import Iterable

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.solids.solid import SectionGrid, straight_wire
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.verification.solid_study.references import nadai_torque, plastic_bending_moment
from coilset.verification.study import Study

FAST = True
d, R = 5.0, 2.5


def straight(law: Law, grid: SectionGrid, length: float = 5.0, layers: int = 2) -> SolidProblem:
    """A straight wire between heads."""
    wire = straight_wire(d, length, layers, MPI.COMM_SELF, grid)
    return SolidProblem(wire, MaterialPoints(law), "direct")


def torques(problem: SolidProblem, angles: Iterable[float]) -> np.ndarray:
    """Torque of the top head at each angle, N mm."""
    out = []
    for angle in angles:
        problem.step(Motion(rotation=(0.0, 0.0, angle)))
        out.append(problem.reactions(np.zeros(3))[1].moment[2])
    return np.array(out)


def bending(problem: SolidProblem, length: float, curvatures: Iterable[float]) -> np.ndarray:
    """Moment of the bottom head when the top head is turned and moved along arcs, N mm."""
    out = []
    for curvature in curvatures:
        turn, ρ = curvature * length, 1 / curvature
        problem.step(Motion((0.0, -ρ * (1 - np.cos(turn)), ρ * np.sin(turn) - length), (turn, 0.0, 0.0)))
        out.append(-problem.reactions(np.zeros(3))[0].moment[0])
    return np.array(out)


def run(study: Study) -> None:
    """Torsion, elastic and plastic, and bending."""
    elastic, ideal = library.load("elastic"), library.load("ideal_plastic")
    exact = elastic.G * np.pi * R**4 / 2 * 1e-6 / 5.0
    errors = [torques(straight(elastic, SectionGrid(n, n)), [1e-6])[0] / exact - 1 for n in (1, 2, 4)]
    for n, coarse, fine in ((2, errors[0], errors[1]), (4, errors[1], errors[2])):
        study.check(
            f"elastic torsion, order of the error at {n} elements per side",
            -np.log2(abs(coarse / fine)),
            -4.0,
            "theory, at least 4",
            0.0,
            "at_most",
        )
    study.check("elastic torque, 4 elements per side, N mm", exact * (1 + errors[2]), exact, "G I_p θ/L", 1e-4)

    yield_shear, ratios = ideal.yield_stress / np.sqrt(3), np.array([1.0, 1.25, 1.5, 2.0, 3.0, 5.0])
    found = torques(straight(ideal, SectionGrid(4, 4)), ratios * yield_shear * 5.0 / (ideal.G * R))
    for ratio, torque in zip(ratios, found, strict=True):
        nadai = nadai_torque(yield_shear, R, ratio)
        study.check(f"torque at θ/θ_y = {ratio:g}, N mm", torque, nadai, "Nadai 1931", 1e-3)

    length, soft = 40.0, _softer(ideal, 10)
    ratios_bent = np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    moments = bending(
        straight(soft, SectionGrid(2, 1), length, 12), length, ratios_bent * soft.yield_stress / soft.E / R
    )
    for ratio, moment in zip(ratios_bent[3:], moments[3:], strict=True):
        beam = plastic_bending_moment(soft.yield_stress, R, ratio)
        study.check(
            f"bending moment at {ratio:g} times the curvature of yield, N mm", moment, beam, "beam theory", 4e-3
        )
    moments /= 4 / 3 * soft.yield_stress * R**3
    study.figure("solid_closed_solutions", _figure(ratios, found, yield_shear, ratios_bent, moments))


def _softer(law: Law, times: float) -> Law:
    """The law with its yield stress divided."""
    data = law.data.model_dump()
    for constants in data["temperatures"]:
        constants["isotropic"]["k0_squared"] /= times**2
    return Law(MaterialFile.model_validate(data))


def _figure(
    ratios: np.ndarray, found: np.ndarray, yield_shear: float, curvatures: np.ndarray, moments: np.ndarray
) -> Figure:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        fine, full = np.linspace(1, 5, 100), nadai_torque(yield_shear, R, np.inf)
        left.plot([0, *fine], [0, *nadai_torque(yield_shear, R, fine) / full], "k-", lw=1, label="Nadai 1931")
        left.plot(ratios, found / full, "C0o", ms=5, label="solid")
        left.set(xlabel="twist over that of first yield", ylabel="torque over the limit", title="Ideal plastic torsion")
        right.plot(curvatures, moments, "C0o", ms=5, label="solid")
        fine = np.linspace(1, curvatures[-1], 200)
        beam = [plastic_bending_moment(1.0, 1.0, ratio) / (4 / 3) for ratio in fine]
        right.plot([0, *fine], [0, *beam], "k-", lw=1, label="beam theory")
        right.set(xlabel="curvature over that of first yield", ylabel="moment over the limit", title="Bending")
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
    return figure
