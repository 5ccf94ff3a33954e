"""From a case to its history: geometry → mesh → rod, contacts and drive → load program → results."""

from dataclasses import dataclass, field

import numpy as np
from mpi4py import MPI

from coilset.meshes.line import line_mesh
from coilset.meshes.placement import section_placement, straight
from coilset.model.contact.build import build_contacts
from coilset.model.errors import SolveError
from coilset.model.frames.rotations import triads
from coilset.model.loading.driver import Drive
from coilset.model.loading.stepper import Step, Stepper
from coilset.model.material import library
from coilset.model.problem.system import System
from coilset.model.results.seats import Resultants, observe
from coilset.model.rod.kinematics import GAUSS
from coilset.model.rod.rod import Rod
from coilset.model.section import surface
from coilset.model.solvers.solver import Solver

PROBE = 1e-3  # travel by which the initial rate is measured, in free lengths


@dataclass
class Snapshot:
    """The spring at one moment, in the order of its stations and elements; complete on rank 0.

    Attributes:
        name: what moment it is, such as `start`, `block`, `force 0 N`.
        height, force: of the seats, mm and N.
        x: station positions, shape (n + 1, 3), mm.
        triads: element triads (columns), shape (n, 3, 3).
        resultants: N, Q2, Q3, Mt, M2, M3 at the Gauss sections, shape (n, 2, 6), N and N mm.
        history: state at the section points, shape (n, 2, points, n_state), MPa.
        surface: the same at the points on the wire's surface, shape (n, 2, surface points, n_state), MPa.
        components: names of the columns of both.
    """

    name: str
    height: float
    force: float
    x: np.ndarray
    triads: np.ndarray
    resultants: np.ndarray
    history: np.ndarray
    surface: np.ndarray
    components: tuple[str, ...]

    @property
    def shear(self):
        """Magnitude of the shear stress at the section points, shape (n, 2, points), MPa."""
        return surface.shear(self.history, self.components)


@dataclass
class Result:
    """What a run has found; `complete` is False if it ended before its program did.

    `seats` has what both ends bear after each of the `steps`.
    """

    steps: list[Step] = field(default_factory=list)
    snapshots: list[Snapshot] = field(default_factory=list)
    seats: list[Resultants] = field(default_factory=list)
    rate: float = float("nan")
    complete: bool = False


class Analysis:
    """A spring with its load program, ready to run.

    Args:
        case: Case (`coilset.model.case.read_case`, or built in Python).
        comm: MPI communicator.

    Raises:
        InputError: if the spring or the material cannot be built.
    """

    def __init__(self, case, comm=MPI.COMM_WORLD):
        self.case, self.comm = case, comm
        self.spring = case.spring.build()
        self.turns = self.spring.stations(case.mesh.elements_per_turn, case.mesh.sagitta)
        self.law = library.load(case.material)
        line = line_mesh(self.spring.centre_line(self.turns), comm)
        self.wire_radius = 0.5 * self.spring.wire_diameter(0.5 * (self.turns[1:] + self.turns[:-1]))
        section, self.placement = case.mesh.section, straight(len(self.turns) - 1)
        if case.mesh.axis == "curved":
            chords = triads(np.diff(line.stations, axis=0))
            self.placement = section_placement(self.spring, self.turns, chords, GAUSS, section.kind != "plane")
        self.rod = Rod(line, self.wire_radius, self.law, section.build(), self.placement, case.temperature,
                       section.kind, section.degree)  # fmt: skip
        top = self.spring.free_length
        contacts = build_contacts(case, self.spring, self.turns, line.stations, self.law.E)
        self.system = System(self.rod, contacts, seats=(0.0, top))
        self.solver = Solver(self.system, case.solver.method, case.solver.tolerance, case.solver.options,
                             case.contact.penetration or np.inf)  # fmt: skip
        self.drive = Drive(self.system, case.ends, top, case.seats)
        deepest = case.contact.deepest * 2.0 * self.wire_radius.min()
        self.stepper = Stepper(self.drive, self.solver, self.spring.block_height, deepest)
        self.result = Result()

    def run(self, report=lambda step: None, checkpoint=None):
        """Walk through the load program; a resumed analysis goes on where its checkpoint was.

        Args:
            report: called with each converged Step.
            checkpoint: Checkpoint that is saved after each step.

        Returns:
            Result; it is also `self.result`, with all steps up to there if the run is interrupted.

        Raises:
            SolveError: no equilibrium was found; the state is that of the last converged step.
        """
        result, save = self.result, checkpoint.save if checkpoint else lambda analysis: None

        def record(step):
            result.seats.append(observe(self, step))
            result.steps.append(step)
            save(self)
            report(step)

        if not result.snapshots:
            result.rate = self.initial_rate()
            result.snapshots.append(self.snapshot("start"))
        try:
            for index in range(self.stepper.walk.phase, len(self.case.loading)):
                phase = self.case.loading[index]
                self.stepper.run_phase(phase, record)
                result.snapshots.append(self.snapshot(phase.label))
                self.stepper.begin(index + 1)
                save(self)
        except (SolveError, KeyboardInterrupt):
            self.system.restore()
            result.snapshots.append(self.snapshot("last equilibrium"))
            raise
        result.complete = True
        return result

    def initial_rate(self):
        """Force over the shortening of the wire from tip to tip, at a thousandth of the free length, N/mm."""
        self.drive.by_height(self.drive.height - PROBE * self.spring.free_length)
        before = np.ptp(self.system.gather(self.rod.x)[[0, -1], 2])
        outcome = self.solver.solve()
        if not outcome.converged:
            raise SolveError(f"no equilibrium at the first touch: {outcome.reason}")
        after = np.ptp(self.system.gather(self.rod.x)[[0, -1], 2])
        force = self.drive.read(self.solver.X)[1]
        self.system.restore()
        return force / (before - after)

    def snapshot(self, name):
        """The spring as it stands, gathered on rank 0."""
        rod = self.rod
        parts = (rod.E.values, rod.s.values, rod.history, rod.points["surface_state"])
        fields = [rod.line.in_order(values) for values in parts]
        if self.comm.rank:
            fields = [np.empty(0)] * len(parts)
        return Snapshot(name, self.drive.height, self.drive.force, self.system.gather(rod.x), *fields,
                        rod.sections.components)  # fmt: skip

    @property
    def section_turns(self):
        """Turns at which the Gauss sections stand, shape (n, 2)."""
        return self.turns[:-1, None] + np.diff(self.turns)[:, None] * GAUSS

    @property
    def inside(self):
        """Where the inside of the coil is on the wire's surface, a `coilset.model.section.surface.Inside`."""
        return surface.Inside.of(self.case.mesh.section.kind != "plane", self.spring.hand)

    def outer_length(self, x):
        """Height of the wire between two planes across the axis that just touch it, mm."""
        z, spring = x[:, 2], self.spring
        top = z + spring.seat_distance(self.turns, "top")
        bottom = z - spring.seat_distance(self.turns, "bottom")
        return float(top.max() - bottom.min())
