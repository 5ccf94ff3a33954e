"""Straight rod bent and twisted to a helix of ten turns by an end moment, against the closed form

A moment m of fixed direction at the end of a clamped round rod is constant along it: with a = m/EI and c = (1/GJ −
1/EI) m·t

    R(s) = exp(a s) exp(c s e1),    t(s) = exp(a s) e1,

the axis is a helix about m, ten turns for |m| L/EI = 20π (Kirchhoff; A. E. H. Love, § 270). With the rotation of the
tip held, its equilibrium is unstable from one turn on, because the rod can unwind through space: the tangent has two
negative pivots per turn, 20 at the end. Moreover, a moment on rotations refers to the chart of the last equilibrium.
All nodes are therefore driven along the closed form in 40 steps, on a helix widened so that the chords keep their
length; then everything but the rotation of the tip is released, and the moment is the reaction to it. The law is
without spin: γ is 5 % at the surface here and bending strains are 12 %, and the second-order axial stress of the spin
is not an elastic response (case elastic-strain-loop); with it the last step finds no equilibrium.

Tolerance: the rods are straight, φ = 20π/n. The errors found are 0.014 φ² L in the tip and 0.022 φ² in the moment; the
tolerances are 0.02 and 0.03 φ². The order is judged over 200 to 400 rods.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.verification.chain import ALL, ROTATION_X, ROTATION_Y, ROTATION_Z, chain, straight
from coilset.verification.frame import Frame
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS, TURNS, STEPS = 1000.0, 2.0, 10, 40  # mm
OUT_OF_PLANE = 0.3  # rad; the part of the moment that twists is its sine
MESHES = (200, 283, 400)


def closed_form(part: float, s: np.ndarray, law: Law) -> tuple[np.ndarray, Rotation, np.ndarray]:
    """Positions, mm, rotations at places `s` under a part of the moment, and the whole moment, N mm."""
    EI, GJ = law.E * np.pi * RADIUS**4 / 4.0, law.G * np.pi * RADIUS**4 / 2.0
    axis = np.array([np.sin(OUT_OF_PLANE), 0.0, np.cos(OUT_OF_PLANE)])
    moment = 2.0 * np.pi * TURNS * EI / LENGTH * axis
    twist = part * (1.0 / GJ - 1.0 / EI) * moment[0]
    rate = part * np.linalg.norm(moment) / EI
    turn = Rotation.from_rotvec(rate * s[:, None] * axis) * Rotation.from_rotvec(twist * s[:, None] * [1.0, 0.0, 0.0])
    across = np.array([1.0, 0.0, 0.0]) - axis[0] * axis
    x = axis[0] * s[:, None] * axis + np.sin(rate * s)[:, None] / rate * across
    return x + (1.0 - np.cos(rate * s))[:, None] / rate * np.cross(axis, across), turn, moment


def wind(elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions of all nodes, mm, and the end's moment, N mm."""
    law, nodes = library.load("elastic", spin=False), straight(LENGTH, elements)
    frame, s = chain(nodes, RADIUS, law), nodes[:, 0]
    x, turn = nodes, Rotation.identity(elements + 1)
    for k in range(1, STEPS + 1):
        led, turned, _ = closed_form(k / STEPS, s, law)
        led = keep_length(led, LENGTH / elements)
        way = np.hstack([led - x, (turned * turn.inv()).as_rotvec()])
        moves = {
            frame.dof(node, component): way[node, component] for node in range(1, elements + 1) for component in ALL
        }
        let(frame, moves)
        x, turn = led, turned
    hold = {frame.dof(elements, component): 0.0 for component in (ROTATION_X, ROTATION_Y, ROTATION_Z)}
    let(frame, hold)  # the tip does not rotate in this step: its moments are those of the fixed frame
    moment = np.array([frame.force(dof) for dof in hold])
    return nodes + np.array([frame.moved(node) for node in range(elements + 1)]), moment


def keep_length(x: np.ndarray, length: float) -> np.ndarray:
    """The helix widened about the axis through the clamp until its chords have a length, mm."""
    axis = np.array([np.sin(OUT_OF_PLANE), 0.0, np.cos(OUT_OF_PLANE)])
    along = np.outer(x @ axis, axis)
    chord, rise = x[1] - x[0], along[1] - along[0]
    return along + (x - along) * np.sqrt((length**2 - rise @ rise) / ((chord - rise) @ (chord - rise)))


def let(frame: Frame, moves: dict[int, float]) -> None:
    """One step with prescribed displacements."""
    outcome = frame.step(moves=moves)
    if not outcome.converged:
        raise SolveError(f"no equilibrium of the helix: {outcome.reason}")


def run(study: Study) -> None:
    """Tip, moment, order."""
    law, rows, far = library.load("elastic", spin=False), [], []
    for n in MESHES:
        s = straight(LENGTH, n)[:, 0]
        x, moment = wind(n)
        exact, _, theirs = closed_form(1.0, s, law)
        far.append(np.linalg.norm(x[-1] - exact[-1]) / LENGTH)
        off = np.linalg.norm(moment - theirs) / np.linalg.norm(theirs)
        rows.append([n, far[-1], off])
    φ2 = (2.0 * np.pi * TURNS / MESHES[-1]) ** 2
    study.check(f"error of the tip over L, {MESHES[-1]} rods", far[-1], 0.0, "closed form", 0.02 * φ2, "absolute")
    study.check(f"error of the end moment over m, {MESHES[-1]} rods", off, 0.0, "closed form", 0.03 * φ2, "absolute")
    slope = -np.polyfit(np.log(MESHES), np.log(far), 1)[0]
    study.check("order of the tip's error", slope, 2.0, "straight rods", 0.1, "absolute")
    study.table("errors", ["rods", "tip, over L", "moment, over m"], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.0, 3.0), layout="constrained")
        side, end = figure.subplots(1, 2, width_ratios=(3, 1))
        axis = np.array([np.sin(OUT_OF_PLANE), 0.0, np.cos(OUT_OF_PLANE)])
        frame = np.stack([axis, np.cross([0.0, 1.0, 0.0], axis), [0.0, 1.0, 0.0]])
        for places, style, name in ((x, "-", f"coilset, {MESHES[-1]} rods"), (exact[::4], "o", "closed form")):
            along, right, up = frame @ places.T
            side.plot(along, up, style, ms=2.5, lw=1.0, label=name)
            end.plot(right, up, style, ms=2.5, lw=1.0)
        side.set(aspect="equal", xlabel="along the moment in mm", ylabel="across in mm", title="Rod wound to ten turns")
        end.set(aspect="equal", xlabel="across in mm", title="along the moment")
        side.set_ylim(-3.0, 52.0)
        side.legend(fontsize=8, loc="upper left", ncols=2)
    study.figure("rod_to_helix", figure)
