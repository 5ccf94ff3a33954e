"""Load that a stout preset turn loses at constant height: the rod and the slice against the solid

One turn between clamped heads, wire 5 mm, D/d = 4 and 8, of a wire with three back stresses (the library's `chaboche`)
that creeps, too (synthetic: N = 6, p = 0.3). It is pressed nine tenths of the way to block, which is far beyond yield,
let back to half of that travel and held there for 1,000 h: presetting, Bauschinger's effect and relaxation in one. The
same law, with three stresses in the rod's curved section and with six in its warping one, the slice and the solid; each
takes the same steps, equal ones of log(1 + 10⁵ t/1,000 h) in the hold.

The slice is a coil without ends, so its loss is compared with that of the solid times the ratio of two rods: the
uniform rod, a coil without ends too, to the clamped turn. Tolerance: 0.5 % of the loss 1 − F/F₀.
"""

from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
import yaml
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.sections.mesh import section_mesh
from coilset.meshes.sections.shapes import round_wire
from coilset.meshes.solids.solid import SectionGrid, coil_section
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case.case import check
from coilset.model.core.material import library
from coilset.model.core.section.rules import polar
from coilset.model.physics.slice.analysis import ACROSS, INSIDE
from coilset.model.physics.slice.problem import SliceProblem
from coilset.model.physics.slice.slice import Coil, Slice
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.program import AxialProgram
from coilset.model.physics.uniform_coil.rod import hold, press
from coilset.verification.solid_study.pressing import WIRE, PressedSection
from coilset.verification.study import Study

FAST = False
INDICES = (4.0, 8.0)
DOWN, BACK = 12, 4  # steps
RADIAL, ANGULAR = 12, 24  # points of a rod's section
HELD = 0.5  # travel at which it is held, over the greatest
HOURS = 1000.0 / 1e5 * np.expm1(np.linspace(0.0, 1.0, 11)[1:] * np.log1p(1e5))
CREEP = {"form": "norton_bailey", "strain": 2e-4, "stress": 300.0, "exponent": 6.0, "time_exponent": 0.3}


@dataclass(frozen=True)
class Held:
    """Forces from the start of the hold on, N."""

    forces: np.ndarray

    @property
    def loss(self) -> np.ndarray:
        """1 − F/F₀ at HOURS."""
        return 1.0 - self.forces[1:] / self.forces[0]


def material(study: Study) -> str:
    """Path of the material's file."""
    data = yaml.safe_load((library.FOLDER / "chaboche.yaml").read_text(encoding="utf-8"))
    path = study.folder / "creeping_chaboche.yaml"
    path.write_text(yaml.safe_dump(data | {"name": "creeping_chaboche", "creep": CREEP}), encoding="utf-8")
    return str(path)


def travels(case: PressedSection) -> np.ndarray:
    """Of the steps before the hold, mm, of a turn."""
    down, back = np.arange(1, DOWN + 1) / DOWN, 1.0 - (1.0 - HELD) * np.arange(1, BACK + 1) / BACK
    return case.travel * np.concatenate([down, back])


def rod(case: PressedSection, file: str, kind: str) -> Held:
    """A turn between clamped heads."""
    marks = np.log1p(HOURS / HOURS[-1] * 1e6) / np.log1p(1e6)  # a hold's steps are parts of log(1 + 1e6 t)
    loading: list[dict[str, Any]] = [
        {"to": {"travel": case.travel}, "steps": DOWN},
        {"to": {"travel": HELD * case.travel}, "steps": BACK},
        {"hold": {"hours": float(HOURS[-1])}, "steps": [float(mark) for mark in marks]},
    ]
    spring = {"wire_diameter": WIRE, "mean_diameter": case.mean_diameter, "turns": 1.0, "pitch": case.pitch}
    mesh = {"elements_per_turn": 24, "section": {"kind": kind, "radial": RADIAL, "angular": ANGULAR}}
    entries = {"spring": spring, "material": file, "ends": "clamped", "mesh": mesh, "loading": loading}
    model = check(entries)
    steps = Analysis(model, MPI.COMM_SELF).run().steps
    return Held(np.array([step.force_N for step in steps])[-len(HOURS) - 1 :])


def uniform_rod(case: PressedSection, file: str) -> Held:
    """A coil without ends, by the rod's kinematics."""
    law, rule = library.load(file), polar(RADIAL, ANGULAR, staggered=False)
    coil = np.array([WIRE, case.mean_diameter, case.pitch, 1.0])
    forces, state = press(coil, law, travels(case), rule=rule)
    relaxed, _ = hold(state, law, HOURS, rule)
    return Held(np.concatenate([forces[0, -1:], relaxed[0]]))


def slice_of(case: PressedSection, file: str) -> Held:
    """A coil without ends."""
    coil = Coil(0.5 * case.mean_diameter, case.pitch)
    body = Slice(section_mesh(round_wire(WIRE), ACROSS, 2, inside=INSIDE), coil, library.load(file))
    problem = SliceProblem(body)
    for travel in travels(case):
        problem.go_to_rise(coil.rise - travel / (2.0 * np.pi))
    forces = [problem.force]
    for hours in np.diff(HOURS, prepend=0.0):
        problem.go_to_rise(body.rise, hours=float(hours))
        forces.append(problem.force)
    return Held(np.array(forces))


def solid(case: PressedSection, file: str) -> Held:
    """A turn between clamped heads."""
    grid = SectionGrid(case.grid, case.grid)
    wire = coil_section(WIRE, case.mean_diameter, case.pitch, 360.0, case.layers, MPI.COMM_SELF, grid)
    program = AxialProgram(SolidProblem(wire, MaterialPoints(library.load(file))))
    for travel in travels(case):
        program.go(float(travel))
    for hours in np.diff(HOURS, prepend=0.0):
        program.go(program.stations[-1].travel, float(hours))
    return Held(np.array([station.force for station in program.stations[-len(HOURS) - 1 :]]))


def run(study: Study) -> None:
    """Losses over time."""
    file, found = material(study), {}
    for index in INDICES:
        case = PressedSection(index)
        found[index] = {
            "solid": solid(case, file).loss,
            "slice": slice_of(case, file).loss,
            "rod, curved": rod(case, file, "curved").loss,
            "rod, warping": rod(case, file, "warping").loss,
        }
        ends = found[index]["rod, curved"][-1] / uniform_rod(case, file).loss[-1]
        for name, losses in found[index].items():
            exact = found[index]["solid"][-1] / (ends if name == "slice" else 1.0)
            if name != "solid":
                study.check(f"D/d = {index:g}, {name}: loss after 1,000 h", losses[-1], exact, "solid", 5e-3)
        study.note(f"D/d = {index:g}: the ends change the loss by {100 * (ends - 1):.2f} %")
    rows = [[index, name, *(100 * losses[[2, 5, 9]])] for index in INDICES for name, losses in found[index].items()]
    study.table("loss in %", ["D/d", "model", *(f"{HOURS[i]:.3g} h" for i in (2, 5, 9))], rows)
    study.figure("stout_relaxation", figure(found))


def figure(found: dict[float, dict[str, np.ndarray]]) -> Figure:
    """Losses over time."""
    with mpl.rc_context(STYLE):
        picture = Figure(figsize=(9.6, 3.8), layout="constrained")
        for axes, (index, losses) in zip(picture.subplots(1, len(found), sharey=True), found.items(), strict=True):
            for style, (name, values) in zip(("k-", "o", "s", "^"), losses.items(), strict=True):
                axes.semilogx(HOURS, 100 * values, style, ms=5, mfc="none", label=name)
            axes.set(xlabel="time in h", title=f"preset turn, D/d = {index:g}")
            axes.grid(lw=0.3)
            axes.legend()
        picture.axes[0].set(ylabel="loss of force in %")
    return picture
