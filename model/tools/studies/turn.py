"""Some turns of a case as a 3D solid between rigid heads, taken along the path of the same turns as a rod."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pyvista
from mpi4py import MPI

from coilset.meshes.solids.solid import SectionGrid, coil_section
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import Case, check
from coilset.model.core.case.material import case_law
from coilset.model.core.case.phases import AnyPhase, Phase, TimePhase
from coilset.model.core.equilibrium.path.free_ends import END_COIL, mean_rotation, nearest_rotation
from coilset.model.core.results.records.record import Snapshot, Step
from coilset.model.physics.slice.analysis import same_in_all_turns
from coilset.model.physics.solid import output
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.program import AxialProgram
from coilset.model.physics.solid.sampling import SectionSample

MOST_TURNS = 5.0
GRID = SectionGrid(2, 2)
LAYERS = 24  # elements round a turn
NEAREST = 0.99  # of the travel to where coils touch: the solid has no contact
PROBE = 1e-6  # travel of the two first steps, in free lengths: the initial rate, and how long an iteration takes
PER_STEP = 5  # iterations of a step, about
ZERO = 1e-5  # force that a release leaves, of the maximum
DIAMETER = 41  # points on the diameter of the section, from the inside of the coil to the outside


@dataclass(frozen=True)
class TurnStep:
    """One converged step; the columns of history.csv. Travel is that of the whole spring."""

    number: int
    phase: int
    travel_mm: float
    force_N: float
    rod_force_N: float
    torque_Nmm: float
    iterations: int
    cuts: int
    hours: float
    load_loss_percent: float | None
    rod_load_loss_percent: float | None


@dataclass
class Moment:
    """Solid and rod at the end of a phase.

    Attributes:
        name: of it; force: of the solid, N.
        height: of the solid, over the axis, mm; free: whether nothing holds it and the rod.
        shear: τ13 of the solid along the diameter of its middle section, from the inside of the coil, shape
            (DIAMETER,), MPa; positive as in a compressed spring.
        rod_inside: the rod's at the inside, MPa.
        body: for files and pictures; None on other ranks than the first.
    """

    name: str
    force: float
    height: float
    free: bool
    shear: np.ndarray
    rod_inside: float
    body: pyvista.UnstructuredGrid | None


@dataclass
class Cost:
    """What a run will cost: unknowns, steps, and seconds estimated from the first two steps."""

    unknowns: int
    steps: int
    seconds: float


@dataclass
class TurnResult:
    """Result of a run; `complete` is False if it ended before its load program did; the rate is in N/mm."""

    steps: list[TurnStep] = field(default_factory=list)
    moments: list[Moment] = field(default_factory=list)
    rate: float = float("nan")
    complete: bool = False


class TurnAnalysis:
    """Turns of a cylindrical spring as solid and as rod, between clamped heads that do not rotate.

    The rod goes first, with the case's kind of section. Its steps are the solid's: the same travels and times. At the
    end of a phase that drives the force, the solid goes on to this force. Neither coils that touch nor seats take part.

    Args:
        case: Case of a cylindrical spring of round wire.
        turns: of the solid.
        grid: elements of the wire's section; layers: round a turn.
        comm: MPI communicator, for the solid; every rank has its own rod.

    Attributes:
        case, spring, law: as given; part: turns of the solid over those of the spring.
        rod: Analysis of the same turns, run; problem: SolidProblem; result: TurnResult.

    Raises:
        InputError: the spring is not cylindrical, of round wire and free of stress, or its load program needs more than
            a travel, a force or a hold at constant height; or the rod's coils touch.
        SolveError: the rod finds no equilibrium.
    """

    def __init__(
        self,
        case: Case,
        turns: float = 1.0,
        grid: SectionGrid = GRID,
        layers: int = LAYERS,
        comm: MPI.Comm = MPI.COMM_WORLD,
    ) -> None:
        if not 1.0 <= turns <= MOST_TURNS:
            raise InputError(f"{turns:g} is not possible; give 1 to {MOST_TURNS:g} turns", "--turns")
        self.case, self.spring, self.turns = case, case.spring.build(), turns
        for entry in case.past:
            raise InputError(f"a solid begins free of stress; leave '{entry}' out", f"spring.{entry}")
        if getattr(case.spring, "wire", None) is not None:
            raise InputError("the solid's wire is round; use 'coilset slice'", "spring.wire")
        d, D, self.pitch = (
            same_in_all_turns(self.spring, name) for name in ("wire_diameter", "mean_diameter", "pitch")
        )
        self.wire_diameter, self.mean_diameter = d, D
        self.part = turns / self.spring.turns
        # coils touch where d / cos α = p, tan α = p / (π D)
        self._nearest = NEAREST * turns * (self.pitch - d / np.sqrt(1.0 - (d / (np.pi * D)) ** 2))
        self.law = case_law(case, self.spring)
        self.rod = Analysis(self._as_rod(), MPI.COMM_SELF)
        if any(step.contacts for step in self.rod.run().steps):
            raise InputError("coils would touch, which those of the solid cannot; give less travel", "loading")
        wire = coil_section(d, D, self.pitch, 360.0 * turns, round(layers * turns), comm, grid)
        self.problem = SolidProblem(wire, MaterialPoints(self.law, case.temperature))
        self.program = AxialProgram(self.problem)
        y = 0.5 * d * np.linspace(-1.0, 1.0, DIAMETER)
        self.diameter, self._sample = y, SectionSample(self.problem.solid, 0.5 * wire.length, y, np.zeros_like(y))
        self.result, self._start = TurnResult(), self._positions()

    def _as_rod(self) -> Case:
        """The case of the rod: the same turns between clamped ends."""
        data = self.case.model_dump(mode="json")
        spring = {
            "wire_diameter": self.wire_diameter,
            "mean_diameter": self.mean_diameter,
            "turns": self.turns,
            "pitch": self.pitch,
        }
        kept = {name: data[name] for name in ("material", "temperature", "mesh", "accuracy", "solver", "release")}
        loading = [self._phase(index, phase) for index, phase in enumerate(self.case.loading)]
        return check({**kept, "spring": spring, "ends": "clamped", "loading": loading})

    def _phase(self, index: int, phase: AnyPhase) -> dict[str, Any]:
        """A phase of the same turns."""
        data = phase.model_dump(mode="json", exclude_none=True)
        if isinstance(phase, TimePhase):
            if phase.heat or phase.duration.keep != "height":
                problem = "the solid holds its height at one temperature; use 'coilset slice'"
                raise InputError(problem, f"loading.{index}.{'heat' if phase.heat else 'hold.keep'}")
            return data
        if phase.heads:
            raise InputError("the solid's heads are driven along the axis only", f"loading.{index}.to")
        kind, value = phase.goal(self.spring.free_length, self.spring.block_height)
        if kind == "force":
            return data
        travel = self.part * (self.spring.free_length - value)
        if phase.to != "block" and travel > self._nearest:
            problem = (
                f"coils would touch, which those of the solid cannot; give up to {self._nearest / self.part:.4g} mm"
            )
            raise InputError(problem + " of travel", f"loading.{index}.to")
        return data | {"to": {"travel": float(min(travel, self._nearest))}}

    @property
    def travel(self) -> float:
        """Shortening of the whole spring, mm."""
        return self.program.stations[-1].travel / self.part

    def cost(self) -> Cost:
        """Make two tiny steps, which give the initial rate and the time of an iteration; collective."""
        probe = PROBE * self.part * self.spring.free_length
        self.program.go(probe)
        began = time.perf_counter()
        station = self.program.go(2.0 * probe)
        seconds = (time.perf_counter() - began) / max(station.iterations, 1)
        self.result.rate = station.force / station.travel * self.part
        steps = len(self.rod.result.steps)
        return Cost(self.problem.unknowns, steps, self.problem.comm.bcast(seconds * steps * PER_STEP))

    def run(self, report: Callable[[TurnStep], object] = lambda step: None) -> TurnResult:
        """Go through the load program after `cost`; collective.

        Args:
            report: called with each converged TurnStep.

        Raises:
            SolveError: if no equilibrium was found; `result` holds the results so far.
        """
        result = self.rod.result
        for index, phase in enumerate(self.case.loading):
            steps = [step for step in result.steps if step.phase == index]
            held = self.program.stations[-1].force
            rod_held = next((s.force_N for s in reversed(result.steps) if s.phase < index), 0.0)
            for step in steps:
                began, elapsed = len(self.program.stations), step.hours - float(self.problem.solid.clock[0])
                self.program.go(step.travel_mm, elapsed if elapsed > 0.0 else 0.0)
                if step is steps[-1] and isinstance(phase, Phase):
                    self._reach(phase)
                self._record(step, began, (held, rod_held) if isinstance(phase, TimePhase) else None, report)
            self.result.moments.append(self._end_of_phase(phase.label, result.snapshots[index + 1]))
        self.result.complete = True
        return self.result

    def _reach(self, phase: Phase) -> None:
        """Go on to the force of a phase that drives it."""
        kind, force = phase.goal(self.spring.free_length, self.spring.block_height)
        if kind == "force":
            limit = ZERO * max(abs(station.force) for station in self.program.stations)
            self.program.reach(force, self.result.rate / self.part, limit)

    def _record(
        self, step: Step, began: int, held: tuple[float, float] | None, report: Callable[[TurnStep], object]
    ) -> None:
        made: Sequence[Any] = self.program.stations[began:]
        station = made[-1]
        losses = [
            100.0 * (1.0 - now / before) if held and before else None
            for now, before in zip((station.force, step.force_N), held or (0.0, 0.0), strict=True)
        ]
        record = TurnStep(
            len(self.result.steps) + 1,
            step.phase,
            self.travel,
            float(station.force),
            step.force_N,
            float(station.torque),
            sum(one.iterations for one in made),
            sum(one.cuts for one in made),
            float(self.problem.solid.clock[0]),
            *losses,
        )
        self.result.steps.append(record)
        report(record)

    def _end_of_phase(self, name: str, shot: Snapshot) -> Moment:
        """Solid and rod at the end of a phase; the solid is let go of where the rod is."""
        if not shot.free:
            return self._moment(name, shot, self._positions())
        before = self._positions()
        with self.problem.continuation.excursion():
            self.problem.let_go()
            after = self._positions()
            rotations = [nearest_rotation(after[end], before[end]) for end in self._end_coils()]
            return self._moment(name, shot, after @ mean_rotation(rotations).T)

    def _positions(self) -> np.ndarray:
        """Of all nodes of the solid at the last equilibrium, on every rank, shape (nodes, 3), mm; collective."""
        solid = self.problem.solid
        x = solid.state["x"].equilibrium.reshape(-1, 3)[: solid.configuration.owned]
        return np.concatenate(solid.comm.allgather(x))

    def _end_coils(self) -> tuple[np.ndarray, np.ndarray]:
        """Which nodes are on the bottom and on the top end coil, shape (nodes,) each."""
        x, y, z = self._start.T
        angle = np.arctan2(y, x) / (2.0 * np.pi)
        turn = angle + np.round(z / self.pitch - angle)
        return turn <= END_COIL, turn >= self.turns - END_COIL

    def _moment(self, name: str, shot: Snapshot, x: np.ndarray) -> Moment:
        inside = self.rod.setup.inside.shear(shot.surface_state, shot.components).mean(axis=1)
        middle = len(inside) // 2
        rod = float(np.mean(inside[middle - 1 + len(inside) % 2 : middle + 1]))  # one element, or the two in the middle
        force = float(self.program.stations[-1].force)
        height = float(np.ptp(x[:, 2]) - np.ptp(self._start[:, 2])) + self.part * self.spring.free_length
        stress = self._sample.stress()[:, 2]
        return Moment(name, force, height, shot.free, stress, rod, output.grid(self.problem.solid))
