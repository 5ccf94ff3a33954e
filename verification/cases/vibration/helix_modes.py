"""Natural frequencies of clamped helical springs, against the twelve equations of their wire

Two springs without load: the stout one of the example, d 5 and D 40 with 4 turns of 12 mm, and the slender one that the
literature on vibration uses, d 1, D 10, 7.6 turns at 8.57°, E = 206,000 MPa, ν = 0.3, 7,900 kg/m³ (J. E. Mottershead,
1980; of his measured frequencies only second-hand figures were at hand, so none is judged). The reference is the
transfer matrix of the helix (`vibration/helix.py`), with the whole area in shear, as plane sections have it.

Tolerance: with n rods per turn the straight chords are off by (2 π/n)⁴/1000 at these modes, 2.4e-5 at n = 16. Curved
sections are stiffer than plane ones by up to (d/D)², as a ring in torsion is by Göhner's theory: half of that is
allowed for the frequency.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.line import line_mesh
from coilset.meshes.springs.placement import section_placement
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.style import STYLE
from coilset.model.core.equilibrium.system.layout import SEATS, LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.rod.elements import MIXED
from coilset.model.core.rod.rod import Rod
from coilset.model.core.rotations.triads import chord_triads
from coilset.model.core.section.rules import polar
from coilset.model.physics.vibration.modes import Modes, natural_modes
from coilset.verification.chain import elastic
from coilset.verification.spring_references.vibrating_helix import HelicalRod
from coilset.verification.study import Study

FAST = True
SPRINGS = {"stout": (5.0, 40.0, 4.0, 12.0), "slender": (1.0, 10.0, 7.6, 10.0 * np.pi * np.tan(np.radians(8.5744)))}
YOUNG, NU, DENSITY = 206e3, 0.3, 7.9e-6  # MPa, kg/mm³
MESHES, COUNT = (8, 16, 32), 8


def modes(spring: tuple[float, float, float, float], per_turn: int, kind: str) -> Modes:
    """Modes of a spring (d, D, turns, pitch) of so many rods a turn between clamped ends."""
    d, D, turns, pitch = spring
    coil = SpringSpec(wire_diameter=d, mean_diameter=D, turns=turns, pitch=pitch).build()
    at = np.linspace(0.0, turns, round(per_turn * turns) + 1)
    line = line_mesh(coil.centre_line(at), MPI.COMM_SELF)
    triads = chord_triads(np.diff(line.stations, axis=0))
    placement = section_placement(coil, at, triads, MIXED.xi, kind != "plane")
    radius = np.full(len(at) - 1, 0.5 * d)
    rod = Rod(line, radius, elastic(YOUNG, NU), polar(3, 12), placement, kind=kind, element=MIXED)
    layout = LineLayout(rod)
    system = System(rod, layout, (), np.zeros(SEATS))
    held = [*layout.seat_dofs, *layout.station_dofs[0], *layout.station_dofs[-1]]
    return natural_modes(system, Load.of(layout, {int(dof): 0.0 for dof in held}, {}), DENSITY, COUNT)


def run(study: Study) -> None:
    """Both springs on three meshes."""
    errors = {}
    for name, spring in SPRINGS.items():
        d, D, turns, pitch = spring
        moduli = {"young": YOUNG, "shear": YOUNG / 2.0 / (1.0 + NU), "density": DENSITY}
        helix = HelicalRod.coil(d, D, turns, pitch, **moduli)
        exact = helix.frequencies(COUNT, 0.5, 100.0)
        found = {n: modes(spring, n, "plane").frequencies for n in MESHES}
        errors[name] = {n: np.abs(found[n] / exact - 1.0) for n in MESHES}
        curved = modes(spring, 16, "curved").frequencies
        for k in range(COUNT):
            source = "transfer matrix"
            study.check(f"{name}: mode {k + 1}, Hz, plane sections", found[16][k], exact[k], source, 2.4e-5)
            study.check(f"{name}: mode {k + 1}, Hz, curved sections", curved[k], exact[k], source, 0.5 * (d / D) ** 2)
        rows = [[k + 1, exact[k], *(found[n][k] for n in MESHES), curved[k]] for k in range(COUNT)]
        columns = ["mode", "twelve equations, Hz", *(f"{n} rods a turn" for n in MESHES), "16, curved sections"]
        study.table(f"{name} spring: d {d:g}, D {D:g}, {turns:g} turns", columns, rows)
        slope = np.log2(errors[name][8].max() / errors[name][16].max())
        study.check(f"{name}: order of the greatest error, 8 to 16 rods a turn", slope, 4.0, "chords", 1.0, "absolute")
    study.figure("helix_modes", draw(errors))


def draw(errors: dict[str, dict[int, np.ndarray]]) -> Figure:
    """Errors of all modes over the mesh."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.8), layout="constrained")
        axes = figure.subplots()
        for colour, (name, found) in zip(("C0", "C3"), errors.items(), strict=True):
            for k in range(COUNT):
                label = f"{name} spring, modes 1 to {COUNT}" if not k else None
                axes.loglog(MESHES, [found[n][k] for n in MESHES], "o-", color=colour, ms=3, lw=0.8, label=label)
        axes.loglog(MESHES, (2.0 * np.pi / np.array(MESHES)) ** 4 / 1000.0, "k:", lw=0.9, label="(2π/n)⁴/1000")
        axes.set_xticks(MESHES, [str(n) for n in MESHES])
        axes.minorticks_off()
        axes.set(xlabel="rods per turn n", ylabel="relative error of the frequency")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    return figure
