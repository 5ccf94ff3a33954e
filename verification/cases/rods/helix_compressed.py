"""Elastic helix compressed to 80 % of its height against the uniform rod's two nonlinear equations

Two turns of wire 5, D 40 and pitch 12 and 30. Both ends are driven as the uniform helix prescribes (radius, rise,
inclination; `references/uniform_helix.py`), so that the ends do not disturb any part of the spring: every node must
then lie on the helix, and the ends must carry the axial force F and the torque M about the axis that the equations
give.

Tolerance: the sections lie on the true centre line, but the rods are straight; with φ the angle of a rod and h/R the
slope, the error found in F is 0.033 φ² (h/R)² from 8 to 32 rods per turn; the tolerance is 0.045 φ² (h/R)². A tenth of
the strain F/GA, 1.5e-4 and 3.6e-4, is added, because the rod's strains are logarithmic and refer to the current length.
The torque about the axis is a small difference, Mt sin ϑ + M3 cos ϑ, of moments that the program takes about the chord
and the reference about the section normal, which shear has tilted by F/GA; relative to Mt, that amount is added.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.meshes.springs.placement import section_placement
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.rod.elements import THESIS
from coilset.model.core.rotations.triads import chord_triads
from coilset.verification.chain import ROTATION_X, ROTATION_Y, ROTATION_Z, X, Y, Z, chain, drive
from coilset.verification.references.rod_shooting import Stiffness
from coilset.verification.references.uniform_helix import Helix, deformed
from coilset.verification.study import Study

FAST = True
WIRE, DIAMETER, TURNS, PITCHES = 5.0, 40.0, 2, (12.0, 30.0)  # mm
LEFT = 0.8  # of the height
MESHES = (8, 16, 32, 64)  # rods per turn
JUDGED = (16, 64)
STEPS = 4


def press(pitch: float, helix: Helix, mesh: int) -> tuple[float, float, np.ndarray]:
    """Force, torque about the axis and the nodes' radii, N, N mm, mm."""
    spring = SpringSpec(wire_diameter=WIRE, mean_diameter=DIAMETER, turns=TURNS, pitch=pitch).build()
    turns = np.linspace(0.0, TURNS, TURNS * mesh + 1)
    nodes, last = spring.centre_line(turns), TURNS * mesh
    placement = section_placement(spring, turns, chord_triads(np.diff(nodes, axis=0)), THESIS.xi)
    frame = chain(nodes, 0.5 * WIRE, library.load("elastic"), held=(), placement=placement)
    rise = pitch / (2.0 * np.pi)
    tilt = helix.inclination - np.arctan2(rise, 0.5 * DIAMETER)
    moves: dict[int, float] = {}
    for node, sinks in ((0, 0.0), (last, TURNS * 2.0 * np.pi * (helix.rise - rise))):
        way = {X: helix.radius - 0.5 * DIAMETER, Y: 0.0, Z: sinks, ROTATION_X: tilt, ROTATION_Y: 0.0, ROTATION_Z: 0.0}
        moves |= {frame.dof(node, component): value for component, value in way.items()}
    drive(frame, STEPS, moves)
    drive(frame, 1, dict.fromkeys(moves, 0.0))  # at rest: moments on rotations refer to the chart, which starts anew
    force, torque = frame.force(frame.dof(last, Z)), frame.force(frame.dof(last, ROTATION_Z))
    x = nodes + np.array([frame.moved(k) for k in range(last + 1)])
    torque += x[-1, 0] * frame.force(frame.dof(last, Y)) - x[-1, 1] * frame.force(frame.dof(last, X))
    return force, torque, np.hypot(x[:, 0], x[:, 1])


def run(study: Study) -> None:
    """Force, torque and radius of both springs over the mesh."""
    law, errors, rows = library.load("elastic"), {}, []
    stiffness = Stiffness.of_round_wire(0.5 * WIRE, law.E, law.G)
    for pitch in PITCHES:
        rise, R = pitch / (2.0 * np.pi), 0.5 * DIAMETER
        helix = deformed(stiffness, R, rise, LEFT * rise)
        for mesh in MESHES:
            force, torque, radii = press(pitch, helix, mesh)
            off = np.abs(radii - helix.radius).max() / R
            errors[pitch, mesh] = abs(force / helix.force - 1.0)
            rows.append([pitch, mesh, -force, errors[pitch, mesh], torque / helix.torque - 1.0, off])
            if mesh in JUDGED:
                at = f"pitch {pitch:g}, {mesh} rods per turn"
                strain = abs(helix.force) / stiffness.GA
                tolerance = 0.045 * (2 * np.pi / mesh * rise / R) ** 2 + 0.1 * strain
                study.check(f"axial force, N, {at}", -force, -helix.force, "uniform helix", tolerance)
                Mt = abs(helix.resultants[3])
                study.check(
                    f"torque over Mt, {at}",
                    torque / Mt,
                    helix.torque / Mt,
                    "uniform helix",
                    tolerance + strain,
                    "absolute",
                )
                study.check(f"radius of the nodes, off by R, {at}", off, 0.0, "uniform helix", tolerance, "absolute")
    columns = ["pitch", "rods per turn", "force, N", "its error", "error of the torque", "radius, off by R"]
    study.table(f"pressed to {100 * LEFT:g} % of the height", columns, rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for pitch, colour in zip(PITCHES, ("C0", "C3"), strict=True):
            slope = pitch / (np.pi * DIAMETER)
            axes.loglog(
                MESHES, [errors[pitch, n] for n in MESHES], "o-", color=colour, ms=4, lw=1, label=f"pitch {pitch:g}"
            )
            axes.loglog(MESHES, 0.045 * (2 * np.pi / np.array(MESHES) * slope) ** 2, ":", color=colour, lw=0.9)
        axes.set_xticks(MESHES, [str(n) for n in MESHES])
        axes.minorticks_off()
        axes.set(xlabel="rods per turn", ylabel="error of the force", title="Helix at 80 % of its height; dotted: h²")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("helix_compressed", figure)
