"""The same coil section as solid and as rod: compressed nearly to block, released, and examined at mid-section."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from coilset.meshes.solids.solid import SectionGrid, coil_section
from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import Case
from coilset.model.core.material import library
from coilset.model.core.results.records.record import Snapshot
from coilset.model.core.results.surface import component
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.program import AxialProgram, Station
from coilset.model.physics.solid.sampling import SectionSample, disk_grid

WIRE = 5.0  # mm
ROD_ELEMENTS = 33  # an odd number, so that an element lies in the middle
FINE = {"radial": 8, "angular": 24}
PLANE = {"kind": "plane", **FINE}


@dataclass(frozen=True)
class PressedSection:
    """One turn between clamped heads.

    The thesis's material with our example's wire; D/d = 8 and pitch 12 mm is the example's spring. The pitch of the
    other indices makes the wire's nominal shear strain at block, d (p − d) / (π D²), the same.

    Attributes:
        index: D/d.
        grid: elements along a side of the section's core, and rings.
        layers: elements along the wire.
        steps: down; a third as many back.
        material: of the library.
        gap: between the coils, over that at which the shear strain is the same.
    """

    index: float = 8.0
    grid: int = 2
    layers: int = 24
    steps: int = 12
    material: str = "ck15"
    gap: float = 1.0

    @property
    def mean_diameter(self) -> float:
        """D, mm."""
        return self.index * WIRE

    @property
    def pitch(self) -> float:
        """Rise in the turn, mm."""
        return WIRE + 7.0 * self.gap * (self.index / 8.0) ** 2

    @property
    def pitch_angle(self) -> float:
        """Of the centre line, degrees."""
        return float(np.degrees(np.arctan(self.pitch / (np.pi * self.mean_diameter))))

    @property
    def travel(self) -> float:
        """Nine tenths of the way to block, where the two ends of the turn do not touch yet, mm."""
        return 0.9 * (self.pitch - WIRE)

    @property
    def name(self) -> str:
        """For the store."""
        gap = "" if self.gap == 1.0 else f"-gap{self.gap:g}"
        return f"pressed-{self.material}-C{self.index:g}-{self.grid}x{self.layers}-{self.steps}{gap}"


def run_solid(
    case: PressedSection,
    comm: MPI.Comm,
    solver: str = "auto",
    report: Callable[[str], object] = lambda line: None,
    on_full: Callable[[SolidProblem], object] | None = None,
    on_end: Callable[[SolidProblem], object] | None = None,
) -> dict[str, Any]:
    """Press and release the solid.

    Args:
        case: PressedSection.
        comm: MPI communicator.
        solver: see `coilset.model.core.equilibrium.newton.methods`.
        report: called with a line after every station.
        on_full, on_end: called with the SolidProblem at full travel and after release, for pictures.

    Returns:
        Dict of plain data: travel, force and torque of all stations, set, and places and stresses at mid-section at
        full travel (`full`) and after release (`end`).
    """
    began = time.perf_counter()
    grid = SectionGrid(case.grid, case.grid)
    wire = coil_section(WIRE, case.mean_diameter, case.pitch, 360.0, case.layers, comm, grid)
    problem = SolidProblem(wire, MaterialPoints(library.load(case.material)), solver)
    sample = SectionSample(problem.solid, 0.5 * wire.length, *disk_grid(0.5 * WIRE))

    def say(s: Station) -> None:
        report(f"  travel {s.travel:8.4f} mm   force {s.force:10.4f} N   {s.iterations} iterations")

    program = AxialProgram(problem, say)
    program.press(case.travel, case.steps)
    full = _looked_at(sample)
    if on_full:
        on_full(problem)
    program.release(max(case.steps // 3, 2))
    if on_end:
        on_end(problem)
    stations = program.stations
    return {
        "unknowns": problem.unknowns,
        "solver": problem.solver,
        "seconds": time.perf_counter() - began,
        "travel": [float(s.travel) for s in stations],
        "force": [float(s.force) for s in stations],
        "torque": [float(s.torque) for s in stations],
        "set": float(stations[-1].travel),
        "iterations": sum(s.iterations for s in stations),
        "linear_iterations": sum(s.linear_iterations for s in stations),
        "full": full,
        "end": _looked_at(sample),
    }


def _looked_at(sample: SectionSample) -> dict[str, Any]:
    stress = sample.stress()
    return {"y": sample.y.tolist(), "z": sample.z.tolist(), "stress": stress.tolist()}


def run_rod(case: PressedSection, section: Mapping[str, object] = PLANE) -> dict[str, Any]:
    """Press and release the rod, on this rank alone.

    Args:
        case: PressedSection.
        section: entries of the case's `mesh.section`; the thesis's section on a fine rule, if not given.

    Returns:
        The same as `run_solid`, with the middle element's points, in the section and on the rim.
    """
    began = time.perf_counter()
    loading = [
        {"to": {"travel": case.travel}, "steps": case.steps},
        {"to": {"force": 0}, "steps": max(case.steps // 3, 2)},
    ]
    spring = {"wire_diameter": WIRE, "mean_diameter": case.mean_diameter, "turns": 1.0, "pitch": case.pitch}
    mesh = {"elements_per_turn": ROD_ELEMENTS, "section": section}
    held = {"ends": "clamped", "release": "held"}  # the solid's heads hold the turn after its release, too
    entries = {"spring": spring, "material": case.material, "mesh": mesh, "loading": loading, **held}
    analysis = Analysis(Case.model_validate(entries), MPI.COMM_SELF)
    torque = [0.0]
    result = analysis.run(lambda step: torque.append(_torque(analysis)))
    if any(step.contacts for step in result.steps):
        raise ValueError("the rod's ends touch, which the solid's cannot")
    return {
        "unknowns": analysis.rod.V.dofmap.index_map.size_global,
        "seconds": time.perf_counter() - began,
        "travel": [0.0] + [step.travel_mm for step in result.steps],
        "force": [0.0] + [step.force_N for step in result.steps],
        "torque": torque,
        "set": result.steps[-1].travel_mm,
        "full": _rod_section(analysis, result.snapshots[1]),
        "end": _rod_section(analysis, result.snapshots[2]),
        "inside": [
            float(analysis.setup.inside.shear(shot.surface_state, shot.components)[ROD_ELEMENTS // 2].mean())
            for shot in result.snapshots[1:3]
        ],
    }


def _torque(analysis: Analysis) -> float:
    """Moment about the coil's axis that the section resultants of the middle element carry, N mm."""
    snapshot = analysis.snapshot("now")
    middle = ROD_ELEMENTS // 2
    E, resultants = snapshot.triads[middle], snapshot.resultants[middle].mean(axis=0)
    centre = snapshot.x[middle : middle + 2].mean(axis=0)
    return float((E @ resultants[3:] + np.cross(centre, E @ resultants[:3]))[2])


def _rod_section(analysis: Analysis, snapshot: Snapshot) -> dict[str, Any]:
    """Places and stresses of the middle element's points in and on the wire, in the axes t, outward, t × outward."""
    middle = ROD_ELEMENTS // 2
    radius = float(analysis.setup.wire_radius[middle])
    E = snapshot.triads[middle]
    centre = snapshot.x[middle : middle + 2].mean(axis=0)
    outward = centre * [1.0, 1.0, 0.0]
    outward -= (outward @ E[:, 0]) * E[:, 0]
    outward /= np.linalg.norm(outward)
    turn = np.stack([outward, np.cross(E[:, 0], outward)]) @ E[:, 1:]  # local y, z → outward, t × outward
    angle = 2.0 * np.pi * np.arange(snapshot.surface_state.shape[2]) / snapshot.surface_state.shape[2]
    points = np.concatenate([analysis.rod.rule.points, np.stack([np.cos(angle), np.sin(angle)], axis=-1)])
    places = radius * points @ turn.T
    state = np.concatenate([state[middle].mean(axis=0) for state in (snapshot.point_state, snapshot.surface_state)])
    normal, *shears = (component(state, snapshot.components, name) for name in ("s11", "t12", "t13"))
    stress = np.column_stack([normal, np.column_stack(shears) @ turn.T])
    return {"y": places[:, 0].tolist(), "z": places[:, 1].tolist(), "stress": stress.tolist()}
