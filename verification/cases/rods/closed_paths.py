"""Closed paths of an elastic spring and of a bend: the work that is lost, of the program's element and the thesis's

The head of an elastic spring (wire 3, D 30, 4 turns of pitch 9, clamped) is pressed by 12 mm, turned by 25°, drawn back
and turned back. The tip of a quarter circle (R 100, wire 4, ν = 0.3) is carried around a closed curve in space, on
which bending strains reach a per cent. An elastic rod must give back all of the work: what is lost on the way is
compared with the energy that the pressed spring, or the bend at the curve's first point, stores, ∫ ½ s · e dx. The path
of the spring is integrated by Simpson's rule, that of the bend, which is periodic, by the trapezoidal one. Each is done
with two numbers of steps.

The mixed element works on the variation of the strains that its sections see, over the stress-free length, so that its
internal forces are the gradient of an energy on every mesh. The thesis's element takes the virtual strains of small
rotations, over the current length. What it loses is an error of discretisation, which falls with the length of the
elements; it is shown.

Tolerance: 1e-6 of the stored energy, on every mesh. Found: 9e-11 for the spring, and 2e-8 for the bend, whose
iterations end at 1e-7 of its forces. The work of the press must be the energy that it stores, to the same.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI
from scipy.integrate import simpson

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.results.records.record import Step
from coilset.model.core.rod.elements import MIXED, THESIS, Element
from coilset.model.core.rod.rod import Rod
from coilset.verification.chain import X, Y, Z, chain, elastic
from coilset.verification.study import Study

FAST = False
SPRING = {"wire_diameter": 3.0, "mean_diameter": 30.0, "turns": 4.0, "pitch": 9.0}
TRAVEL, TURN = 12.0, 25.0  # mm, degrees
PER_TURN, SPRING_STEPS = (8, 16, 32), (8, 16)  # of each of the four parts
RING, RADIUS, SIZE = 100.0, 2.0, 35.0  # mm, of the bend and of its path
RODS, BEND_STEPS = (4, 8, 16), (24, 48)  # of the closed curve
TOLERANCE = 1e-6


def stored(rod: Rod) -> float:
    """Energy of an elastic rod, N mm."""
    c = rod.coefficients
    return float(0.5 * np.einsum("c,g,cgk,cgk", c.l0, rod.element.weights, c.s, c.e))


def spring_path(element: Element, per_turn: int, steps: int) -> tuple[float, float, float]:
    """Work around the path, the energy stored in the pressed spring, and the work by which it was pressed, N mm."""
    to = [{"travel": t, "top": {"turn": turn}} for t, turn in ((TRAVEL, 0.0), (TRAVEL, TURN), (0.0, TURN), (0.0, 0.0))]
    case = check(
        {
            "spring": SPRING,
            "material": "elastic",
            "ends": "clamped",
            "accuracy": "none",
            "mesh": {"elements_per_turn": per_turn, "element": element.name, "section": {"radial": 3, "angular": 8}},
            "loading": [{"to": target, "steps": steps} for target in to],
        }
    )
    analysis, rows, energies = Analysis(case, MPI.COMM_SELF), [(0.0, 0.0, 0.0, 0.0)], [0.0]

    def keep(step: Step) -> None:
        rows.append((step.travel_mm, step.force_N, np.deg2rad(step.turn_deg), step.torque_Nmm))
        energies.append(stored(analysis.rod))

    analysis.run(keep)
    way, force, turn, torque = np.array(rows).T
    parts = [slice(k * steps, (k + 1) * steps + 1) for k in range(4)]
    works = [simpson(force[part], x=way[part]) + simpson(torque[part], x=turn[part]) for part in parts]
    return float(sum(works)), energies[steps], float(works[0])


def bend_path(element: Element, rods: int, steps: int) -> tuple[float, float]:
    """Work around the closed curve, and the energy stored at its first point, N mm."""
    angle, t = np.linspace(0.0, np.pi / 2.0, rods + 1), np.linspace(0.0, 2.0 * np.pi, steps + 1)
    nodes = RING * np.stack([np.sin(angle), 1.0 - np.cos(angle), 0.0 * angle], axis=1)
    frame = chain(nodes, RADIUS, elastic(2e5, 0.3), element=element)
    curve = SIZE * np.stack([0.5 * np.cos(t) - 0.6, 0.5 * np.sin(t), 0.8 + 0.6 * np.sin(t + 0.7)], axis=1)
    tangent = SIZE * np.stack([-0.5 * np.sin(t), 0.5 * np.cos(t), 0.6 * np.cos(t + 0.7)], axis=1)
    dofs = [frame.dof(rods, component) for component in (X, Y, Z)]

    def go(move: np.ndarray) -> None:
        outcome = frame.step(moves=dict(zip(dofs, move, strict=True)))
        if not outcome.converged:
            raise SolveError(f"{element.name}, {rods} rods: {outcome.reason}")

    for _ in range(8):
        go(curve[0] / 8)
    energy, forces = stored(frame.rod), []
    for move in np.diff(curve, axis=0):
        go(move)
        forces.append([frame.force(dof) for dof in dofs])
    return float((np.array(forces) * tangent[1:]).sum() * (t[1] - t[0])), energy


def run(study: Study) -> None:
    """Both paths, elements, and all meshes."""
    paths = {"spring": (spring_path, PER_TURN, SPRING_STEPS), "bend": (bend_path, RODS, BEND_STEPS)}
    rows, lost = [], {}
    for name, (path, meshes, counts) in paths.items():
        for element in (MIXED, THESIS):
            for mesh in meshes:
                found = [path(element, mesh, steps) for steps in counts]
                shares = [work / energy for work, energy, *_ in found]
                rows.append([name, element.name, mesh, found[-1][1], *(f"{share:+.1e}" for share in shares)])
                lost[name, element.name, mesh] = abs(shares[-1])
                said = f"work around a closed path over the stored energy, {name}, {element.name}, {mesh}"
                if element is MIXED:
                    study.check(said, shares[-1], 0.0, "an elastic rod", TOLERANCE, "absolute")
                    for work in found[-1][2:]:
                        said = f"energy of the pressed spring, {mesh}, N mm"
                        study.check(said, found[-1][1], work, "work of its head", TOLERANCE)
                else:
                    study.shown(said, shares[-1], 0.0, "an elastic rod", "small rotations, as in the thesis")
    columns = ["path", "element", "elements a turn, or rods", "stored, N mm", "lost", "lost in twice as many steps"]
    study.table("work around a closed path over the stored energy", columns, rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 3.8), layout="constrained")
        axes = figure.add_subplot()
        for name, (_, meshes, _) in paths.items():
            for element, style in ((MIXED, "o-"), (THESIS, "s--")):
                shares = [lost[name, element.name, mesh] for mesh in meshes]
                axes.loglog(meshes, shares, style, ms=4, lw=0.9, label=f"{name}, {element.name}")
        axes.axhline(TOLERANCE, color="k", lw=0.6)
        axes.set(xlabel="elements a turn, or rods of the bend", ylabel="work lost over energy stored")
        axes.set_title("Closed paths of an elastic rod")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("closed_paths", figure)
