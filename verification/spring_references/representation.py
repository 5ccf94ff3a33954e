"""Which straight rods represent a curved wire best? Rates of clamped springs against the curved rod.

The thesis's rods are inscribed in the centre line. Others: nodes moved outwards until the chords are as long as the
arcs, or until they give way as much (`polygon_nodes`); and sections that lie on the true centre line
(`section_placement`).
"""

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.line import line_mesh
from coilset.meshes.springs.placement import section_placement
from coilset.meshes.springs.shapes import Barrel
from coilset.meshes.springs.spring import Spring, SpringSpec
from coilset.model.core.base.style import STYLE
from coilset.model.core.equilibrium.newton.methods import rod_method
from coilset.model.core.equilibrium.newton.newton import Newton
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.system.heads import Heads, Holding
from coilset.model.core.equilibrium.system.layout import SEATS, LineLayout
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.rod.elements import THESIS
from coilset.model.core.rod.rod import Rod
from coilset.model.core.rotations.triads import chord_triads
from coilset.model.core.section.rules import polar
from coilset.model.tools.figures.png import save
from coilset.verification.spring_references.curved_rod import clamped_rate

TRAVEL = 1e-4  # of the free length, in both directions
ELEMENTS = (8, 16, 32, 64)
REPRESENTATIONS = {
    "points": "inscribed polygon (thesis)",
    "length": "polygon of the wire's length",
    "compliance": "polygon of the same compliance",
    "curved": "sections on the curved axis (default)",
}
SPRINGS = {
    "cylinder, 2.5 turns": SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=2.5, pitch=12.0),
    "barrel, 6 turns": SpringSpec(
        wire_diameter=5.0, mean_diameter=Barrel(shape="barrel", ends=30.0, middle=50.0), turns=6.0, pitch=14.0
    ),
}


def polygon_nodes(spring: Spring, turns: np.ndarray, keep: str = "points", poisson: float = 0.3) -> np.ndarray:
    """Nodes of a polygon of straight rods that represents the wire.

    A chord over the angle φ is shorter than its arc and closer to the axis. Under an axial force F it carries the
    torque F r cos(φ/2) and bending up to F r sin(φ/2), with EI = (1 + ν) GJ for a round wire, so that inscribed rods
    are too stiff by `1 − sin(φ/2)/(φ/2) · (cos²(φ/2) + sin²(φ/2)/(3 (1 + ν)))`: 3.5 % at 16 elements per turn. Moving
    the nodes outwards corrects this.

    Args:
        spring: `Spring`.
        turns: increasing turns of the nodes, shape (n + 1,).
        keep: ``points``, the nodes are on the centre line; ``length``, the chords are as long as their arcs;
            ``compliance``, they are as compliant as the arcs under an axial force.
        poisson: ν, for ``compliance``.

    Returns:
        The nodes, shape (n + 1, 3), mm.
    """
    nodes = spring.centre_line(turns)
    if keep == "points":
        return nodes
    φ = 2 * np.pi * np.diff(turns)
    # between elements of different lengths, the mean of what both require
    half = 0.5 * np.concatenate([φ[:1], 0.5 * (φ[1:] + φ[:-1]), φ[-1:]])
    shortening = np.sin(half) / half
    if keep == "length":
        outwards = 1 / shortening
    elif keep == "compliance":
        outwards = (shortening * (np.cos(half) ** 2 + np.sin(half) ** 2 / (3 * (1 + poisson)))) ** (-1 / 3)
    else:
        raise ValueError(f"keep must be points, length or compliance, not {keep!r}")
    nodes[:, :2] *= outwards[:, None]
    return nodes


def rate(spring: Spring, turns: np.ndarray, representation: str, law: Law) -> float:
    """Initial rate between clamped heads, N/mm.

    Args:
        spring: `Spring`.
        turns: of the nodes, shape (n + 1,).
        representation: a key of `REPRESENTATIONS`.
        law: material law.
    """
    keep = "points" if representation == "curved" else representation
    line = line_mesh(polygon_nodes(spring, turns, keep, poisson=law.E / (2 * law.G) - 1), MPI.COMM_SELF)
    placement = None
    if representation == "curved":
        placement = section_placement(spring, turns, chord_triads(np.diff(line.stations, axis=0)), THESIS.xi)
    radius = 0.5 * spring.wire_diameter(0.5 * (turns[1:] + turns[:-1]))
    rod = Rod(line, radius, law, polar(2, 8), placement)
    system = System(rod, LineLayout(rod), (), np.zeros(SEATS))
    control = Heads(system, spring.free_length, Holding(clamped=True))
    continuation = Continuation(Newton(system, rod_method("newton", 1), 1e-7))
    forces = []
    for travel in (TRAVEL * spring.free_length, -TRAVEL * spring.free_length):
        outcome, force = continuation.probe(control.to_height(spring.free_length - travel), lambda: control.trial_force)
        if not outcome.converged:
            raise RuntimeError(f"no equilibrium at a travel of {travel:g} mm")
        forces.append(force)
    # the central difference leaves no part of the characteristic's curvature
    return (forces[0] - forces[1]) / (2 * TRAVEL * spring.free_length)


def study() -> dict[str, dict[str, np.ndarray]]:
    """Relative errors of the rate: spring → representation → errors at `ELEMENTS` per turn, shape (4,)."""
    law = library.load("ck15")
    errors = {}
    for name, spec in SPRINGS.items():
        spring = spec.build()
        exact = clamped_rate(spring, law.E, law.G)
        errors[name] = {
            key: np.array([rate(spring, spring.stations(n), key, law) / exact - 1 for n in ELEMENTS])
            for key in REPRESENTATIONS
        }
    return errors


def figure(errors: Mapping[str, Mapping[str, np.ndarray]], path: str | Path) -> None:
    """Draw the errors over the elements per turn."""
    with mpl.rc_context(STYLE):
        drawn = Figure(figsize=(9.2, 4.6), layout="constrained")
        for place, (name, by_representation) in enumerate(errors.items()):
            axes = drawn.add_subplot(1, 2, place + 1)
            for key, label in REPRESENTATIONS.items():
                axes.loglog(ELEMENTS, 100 * np.abs(by_representation[key]), "o-", ms=4, lw=1.3, label=label)
            axes.axhline(0.3, color="0.5", lw=0.8, ls="--", label="0.3 %")
            axes.set(title=name, xlabel="elements per turn", ylabel="error of the rate in %", xticks=ELEMENTS)
            axes.set_xticklabels(ELEMENTS)
            axes.minorticks_off()
            axes.grid(lw=0.3)
        drawn.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
        at = ELEMENTS.index(16)
        worst, ours = (100.0 * max(abs(one[key][at]) for one in errors.values()) for key in ("points", "curved"))
        drawn.suptitle(
            f"16 elements per turn: the rate is {ours:.1g} % off with sections on the curved axis, "
            f"{worst:.2g} % with a polygon\n(clamped springs; reference: the curved rod by Castigliano)",
            fontsize=10,
        )
        save(drawn, Path(path))
