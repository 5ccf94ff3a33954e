"""Friction: a dragged rod against μ N, a rolling one against s/r, and the cycle of a spring for three coefficients

A straight rod lies on a seat and is pressed on it with the total force N. Dragged lengthways or sideways and held
against rotation, it resists with μ N. If it is free to rotate about its axis, it rolls by s/r instead, because its
underside sticks, and needs no force; the tolerance is that of a step of 0.02 rad, over which the slip is linear in the
rotations.

An elastic closed and ground spring with its end coils in grooves is compressed by 15 mm and released, twice. Its coils
and end coils slip a little where they come into contact. The loss of a cycle must be positive and the same in the
second cycle as in the first to within 1 %; without friction it must not exceed 1e-5 of the energy of the spring, the
error of its increments.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.contact.base import SEAT_DOFS
from coilset.model.core.contact.seat import Seat
from coilset.model.core.material import library
from coilset.model.core.section.rules import polar
from coilset.model.physics.friction.friction import SeatFriction
from coilset.verification.frame import Frame
from coilset.verification.study import Study
from coilset.verification.wire_points import wire_points

LOAD, NODES, RADIUS, LENGTH = 10.0, 11, 2.0, 100.0  # N at each node, mm
MU, STEPS, TRAVEL = 0.3, 10, 15.0
SPRING = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 7.5,
    "free_length": 75.0,
    "end_coils": {"form": "closed and ground"},
}
COLOURS = {0.0: "0.5", 0.1: "C0", 0.3: "C1"}  # by coefficient


def pressed_rod(free: tuple[int, ...]) -> tuple[Frame, dict[int, float]]:
    """Frame of a rod along x, pressed on the bottom seat; of all nodes the components in `free` may move."""
    nodes = np.stack([np.linspace(0.0, LENGTH, NODES), np.zeros(NODES), np.full(NODES, RADIUS)], axis=1)
    points, seats = wire_points(nodes, RADIUS), np.zeros(2 * SEAT_DOFS)
    seat = Seat("bottom", points, points.radius, nodes, seats, 1e3, 1e-3)
    held = [component for component in range(6) if component not in (2, *free)]
    frame = Frame(
        nodes,
        [(k, k + 1) for k in range(NODES - 1)],
        RADIUS,
        library.load("elastic"),
        polar(2, 6),
        [(node, held) for node in range(NODES)],
        contacts=[seat, SeatFriction(seat, MU, nodes, seats)],
    )
    forces = {frame.dof(node, 2): -LOAD for node in range(NODES)}
    still = {frame.dof(node, component): 0.0 for node in range(NODES) for component in free}
    if not frame.step(moves=still, forces=forces).converged:
        raise RuntimeError("the rod does not come to rest")
    return frame, forces


def drag(component: int, way: float, free: tuple[int, ...]) -> tuple[float, float]:
    """Force needed to move a rod by `way`, N, and its mean rotation about its axis, rad."""
    frame, forces = pressed_rod(free)
    drawn = [frame.dof(node, component) for node in range(NODES)]
    before = frame.layout.gather(frame.system.state["R"].trial).copy()
    if not frame.step(moves=dict.fromkeys(drawn, way), forces=forces).converged:
        raise RuntimeError("no equilibrium of the dragged rod")
    turn = frame.layout.gather(frame.system.state["R"].trial) @ np.swapaxes(before, 1, 2)
    return sum(frame.force(dof) for dof in drawn), float(0.5 * (turn[:, 2, 1] - turn[:, 1, 2]).mean())


def cycles(mu: float) -> np.ndarray:
    """Travel and force of two cycles, mm and N."""
    loading = [{"to": {"travel": travel}, "steps": STEPS} for travel in (TRAVEL, 0.0, TRAVEL, 0.0)]
    data = {
        "spring": SPRING,
        "material": "elastic",
        "contact": {"friction": {"seats": mu, "coils": mu}},
        "seats": {"hold": "groove"},
        "loading": loading,
    }
    steps = Analysis(check(data)).run().steps
    return np.array([(0.0, 0.0), *((step.travel_mm, step.force_N) for step in steps)]).T


def run(study: Study) -> None:
    """Rods, then springs."""
    for name, component in (("along", 0), ("across", 1)):
        force, _ = drag(component, 0.5, (component,))
        study.check(f"force of a rod dragged {name}, N", force, MU * LOAD * NODES, "μ N", 1e-6)
    force, turn = drag(1, 0.04, (1, 3))
    study.check("force of a rolling rod over μ N", force / (MU * LOAD * NODES), 0.0, "it sticks", 1e-6, "absolute")
    study.check("rotation of a rolling rod, rad", turn, -0.04 / RADIUS, "s/r", 1e-3)
    rows, curves = [], {}
    for mu in COLOURS:
        travel, force = curves[mu] = cycles(mu)
        energy = np.trapezoid(force[: STEPS + 1], travel[: STEPS + 1])
        lost = [np.trapezoid(force[k : k + 2 * STEPS + 1], travel[k : k + 2 * STEPS + 1]) for k in (0, 2 * STEPS)]
        rows.append([mu, force.max(), *lost, lost[1] / energy])
        if mu:
            name = f"loss of the second cycle over that of the first, μ = {mu:g}"
            study.check(name, lost[1] / lost[0], 1.0, "first cycle", 0.01)
            study.check(
                f"loss of a cycle with reversed sign, N mm, μ = {mu:g}", -lost[1], 0.0, "second law", kind="at_most"
            )
        else:
            study.check("loss over energy, μ = 0", lost[1] / energy, 0.0, "elasticity", 1e-5, "absolute")
    study.table(
        "spring of 7.5 turns, two cycles to 15 mm",
        ["μ", "maximum force, N", "loss 1, N mm", "loss 2, N mm", "loss 2 over energy"],
        rows,
    )
    draw(study, curves)


def draw(study: Study, curves: dict[float, np.ndarray]) -> None:
    """Characteristics, and their deviation from the one without friction."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.2, 3.9), layout="constrained")
        left, right = figure.subplots(1, 2)
        for mu, colour in COLOURS.items():
            travel, force = curves[mu]
            left.plot(travel, force, "-", color=colour, lw=1.0, label=f"μ = {mu:g}")
            if mu:
                right.plot(travel, force - curves[0.0][1], ".-", color=colour, lw=0.8, ms=3, label=f"μ = {mu:g}")
        left.set(xlabel="travel in mm", ylabel="axial force in N", title="closed and ground, two cycles")
        right.set(xlabel="travel in mm", ylabel="force minus that without friction in N")
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
        most = 100.0 * max(np.abs(force - curves[0.0][1]).max() for _, force in curves.values()) / curves[0.0][1].max()
        figure.suptitle(f"Friction changes the force by {most:.2g} % of its maximum at most")
        study.figure("friction", figure)
