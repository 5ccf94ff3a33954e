"""From a case to the slice's history: the cylindrical coil of a case file, its section, and its load program."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from coilset.meshes.sections.mesh import SectionMesh, section_mesh
from coilset.meshes.sections.shapes import Outline, round_wire
from coilset.meshes.springs.geometry import Spring
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.case import Case
from coilset.model.core.case.material import case_law
from coilset.model.core.case.phases import AnyPhase, Phase, TimePhase
from coilset.model.core.case.stages import stage_of
from coilset.model.core.case.targets import check_travel
from coilset.model.core.results.records.releases import FREE
from coilset.model.physics.slice.contact import SelfContact
from coilset.model.physics.slice.lattice import Lattice
from coilset.model.physics.slice.problem import Effort, SliceProblem
from coilset.model.physics.slice.slice import Coil, Slice
from coilset.model.physics.slice.watch import Watch

ACROSS, INSIDE = 5.75, 2.0  # triangles across the section, how much finer at the inside: 600 unknowns for a round wire
DEGREE = 2  # of the displacements
AUTOMATIC = 16  # number of equal steps of a phase whose steps are `auto`
PROBE = 1e-6  # travel over which the initial rate is measured, in free lengths
TOUCHING = 1e-7  # gap at which coils count as touching, in wire diameters
APPROACHES = 80  # a gap to a side whose normal rises by n falls to 1 − n of it in each, and n is 0.3 or more
SAME = 1e-9  # relative difference below which a quantity counts as constant over the turns


@dataclass(frozen=True)
class SliceStep:
    """One converged step; the columns of history.csv."""

    number: int
    phase: int
    progress: float
    seat_height_mm: float
    travel_mm: float
    force_N: float
    iterations: int
    cuts: int
    contacts: int
    penetration_mm: float
    pitch_mm: float
    torque_Nmm: float
    hours: float
    temperature_K: float
    load_loss_percent: float | None


@dataclass
class SliceSnapshot:
    """The section at one point of the load program.

    Attributes:
        name: of that point, such as `start`, `block`, `force 0 N`.
        height, force: of the spring, mm and N.
        x: positions of the lattice points, shape (points, 3), mm.
        stress: σ11, σ22, σ33, τ12, τ13, τ23 there, in the section's axes, shape (points, 6), MPa.
        work: plastic work b* there, shape (points,), N/mm².
        line: the stress on the line η = 0, shape (points, 6), MPa.
        turn: λ, by which the coil has turned: 1 of a coil whose ends do not.
    """

    name: str
    height: float
    force: float
    x: np.ndarray
    stress: np.ndarray
    work: np.ndarray
    line: np.ndarray
    turn: float


@dataclass
class SliceResult:
    """Result of a run; `complete` is False if it ended before its load program did.

    Attributes:
        rate: N/mm; inside_factor: elastic shear at the inside of a round wire over 8 F D/(π d³), None for others.
    """

    steps: list[SliceStep] = field(default_factory=list)
    snapshots: list[SliceSnapshot] = field(default_factory=list)
    rate: float = float("nan")
    inside_factor: float | None = None
    complete: bool = False


class SliceAnalysis:
    """The slice of a cylindrical spring with its load program, ready to run.

    Args:
        case: Case; its mesh, seat shapes and solver are ignored.
        outline: of the section; default is the round wire. `wire_diameter` must equal its height along the spring.
        across: triangles across the section, see `meshes.section`.

    Attributes:
        spring, law, coil, body, problem: geometry, Law, Coil, Slice, SliceProblem.
        lattice, points: Lattice over the section and the Watch of its points; line: Watch across the section at η = 0.

    Raises:
        InputError: if the spring is not cylindrical or does not match the section, or heat flows, or the load program
            goes below block.
    """

    def __init__(self, case: Case, outline: Outline | None = None, across: float = ACROSS):
        self.case, self.spring = case, case.spring.build()
        for entry in case.past:
            problem = f"a slice begins free of stress; leave '{entry}' out, or use 'coilset solve'"
            raise InputError(problem, f"spring.{entry}")
        if self.spring.has_tails or self.spring.axis is not None:
            raise InputError(
                "a slice is of a coil about a straight axis without hooks or arms; use 'coilset solve'", "spring"
            )
        self._check_targets()
        self.law = case_law(case, self.spring)
        outline = outline or _wire(case)
        d, D, pitch = (same_in_all_turns(self.spring, name) for name in ("wire_diameter", "mean_diameter", "pitch"))
        self.wire_diameter, self.mean_diameter, self.is_round = d, D, outline is None
        self.coil, self.turns = Coil(0.5 * D, pitch), self.spring.turns
        section = section_mesh(outline or round_wire(d), across, DEGREE, inside=INSIDE)
        _fits(section.extent, d)
        self.body = Slice(section, self.coil, self.law, case.temperature)
        self.lattice = Lattice(self.body)
        self.points = Watch(self.body, self.lattice.places)
        ξ = np.linspace(*_across(section), 61)
        ξ = ξ[np.abs(ξ) >= getattr(outline, "hole", 0.0) * ξ.max()]
        self.line = Watch(self.body, np.stack([ξ, np.zeros_like(ξ)], axis=1))
        self.problem = SliceProblem(
            self.body, _ends_turn(case), SelfContact(self.body), turns=self.turns, free_length=self.spring.free_length
        )
        self.result = SliceResult()
        self._held_force: float | None = None  # N, as time began to pass at constant height

    def _check_targets(self) -> None:
        """Reject what needs heads or a flow of heat, and heights below that at which the coils touch."""
        block = self.spring.block_height
        check_travel(self.case, self.spring)
        if self.case.heat is not None:
            raise InputError("no heat flows along a slice; leave it out, or use coilset solve", "heat")
        for index, phase in enumerate(self.case.loading):
            if isinstance(phase, TimePhase):
                continue
            if phase.heads:
                problem = "a slice has no heads; leave bottom and top out, or use coilset solve"
                raise InputError(problem, f"loading.{index}.to")
            kind, value = phase.goal(self.spring.free_length, block)
            if kind == "height" and value < block * (1.0 - SAME):
                raise InputError(
                    f"a height of {value:.6g} mm is below block, {block:.6g} mm; give to: block", f"loading.{index}.to"
                )

    @property
    def height(self) -> float:
        """Distance between the seats, mm."""
        return self.problem.height

    def run(self, report: Callable[[SliceStep], None] = lambda step: None) -> SliceResult:
        """Go through the load program.

        Args:
            report: called with each converged SliceStep.

        Raises:
            SolveError: if no equilibrium was found; `result` holds the results so far.
        """
        result = self.result
        self._probe()
        result.snapshots.append(self.snapshot("start"))
        for index, phase in enumerate(self.case.loading):
            try:
                self._phase(index, phase, report)
            except SolveError:
                result.snapshots.append(self.snapshot("last equilibrium"))
                raise
            result.snapshots.append(self._end_of_phase(phase.label))
        result.complete = True
        return result

    def _end_of_phase(self, name: str) -> SliceSnapshot:
        """The section at the end of a phase; that of a released coil, which nothing holds, without a torque, too.

        Raises:
            SolveError: if no equilibrium was found.
        """
        greatest = max((abs(step.force_N) for step in self.result.steps), default=0.0)
        if self.case.release == "held" or abs(self.problem.force) > FREE * greatest:
            return self.snapshot(name)
        with self.problem.continuation.excursion():
            self.problem.let_go()
            return self.snapshot(name)

    def _phase(self, index: int, phase: AnyPhase, report: Callable[[SliceStep], object]) -> None:
        problem, stage = self.problem, stage_of(self.case.loading, index, self.spring)
        if not (isinstance(phase, TimePhase) and phase.duration.keep == "height"):
            self._held_force = None
        elif self._held_force is None:
            self._held_force = problem.force
        steps = phase.count(AUTOMATIC)
        closes = isinstance(phase, Phase) and phase.to == "block"
        before = (
            0.0 if not closes or steps == 1 else stage.steps[-2] if isinstance(stage.steps, tuple) else 1 - 1 / steps
        )
        if not closes or before:
            for taken in problem.run(replace(stage, steps=AUTOMATIC if stage.steps == "auto" else stage.steps)):
                self._record(index, taken.progress, Effort(taken.outcome.iterations, taken.cuts), report)
                if closes and taken.progress >= (1.0 - SAME) * before:
                    break
        if closes:
            self._record(index, 1.0, self._close(self.spring.block_height, (1.0 - before) * stage.hours), report)

    def _record(self, index: int, progress: float, effort: Effort, report: Callable[[SliceStep], object]) -> None:
        problem, (hours, temperature) = self.problem, self.body.clock[:2].tolist()
        step = SliceStep(
            len(self.result.steps) + 1,
            index,
            progress,
            problem.height,
            self.spring.free_length - problem.height,
            problem.force,
            effort.iterations,
            effort.cuts,
            problem.pressure.bearing,
            max(0.0, -problem.pressure.gap),
            2.0 * np.pi * self.body.rise,
            problem.torque,
            hours,
            temperature,
            100.0 * (1.0 - problem.force / self._held_force) if self._held_force else None,
        )
        self.result.steps.append(step)
        report(step)

    def _rise(self, height: float) -> float:
        return self.coil.rise - (self.spring.free_length - height) / (2.0 * np.pi * self.turns)

    def _close(self, height: float, hours: float) -> Effort:
        """Continue until the coils just touch, slightly above the block height because of the wire's inclination.

        Args:
            height: at which the spring's drawing is at block, mm.
            hours: that the first approach takes.

        Raises:
            SolveError: if they do not touch.
        """
        rise, limit = self._rise(height), TOUCHING * self.wire_diameter
        iterations = cuts = 0
        for _ in range(APPROACHES):
            pressure = self.problem.pressure
            rise = max(self._rise(height), self.body.rise - self.body.turn * (pressure.gap - 0.5 * limit) / (2 * np.pi))
            effort, hours = self.problem.go_to_rise(rise, None, hours), 0.0
            iterations, cuts = iterations + effort.iterations, cuts + effort.cuts
            if abs(self.problem.pressure.gap - 0.5 * limit) <= 0.5 * limit or rise == self._rise(height):
                return Effort(iterations, cuts)
        raise SolveError(f"the coils do not come to touch in {APPROACHES} approaches to block")

    def _probe(self) -> None:
        """Initial rate and the stress factor at the inside, from the linear response to a small travel."""
        travel = PROBE * self.spring.free_length
        force, stress = self.problem.probe(self.coil.rise - travel / (2.0 * np.pi * self.turns), self.line)
        self.result.rate = force / travel
        if self.is_round:
            nominal = 8.0 * force * self.mean_diameter / (np.pi * self.wire_diameter**3)
            self.result.inside_factor = float(abs(stress[0, 4]) / nominal)

    def snapshot(self, name: str) -> SliceSnapshot:
        """The current state of the section."""
        positions = self.lattice.positions(self.body.x)
        return SliceSnapshot(
            name,
            self.height,
            self.problem.force,
            positions,
            self.points.section_stress(),
            self.points.state[:, 12].copy(),
            self.line.section_stress(),
            self.body.turn,
        )


def same_in_all_turns(spring: Spring, name: str) -> float:
    """`wire_diameter`, `mean_diameter` or `pitch` of a cylindrical spring, mm.

    Raises:
        InputError: if it is not the same in all turns.
    """
    function = {
        "wire_diameter": spring.wire_diameter,
        "mean_diameter": lambda t: 2.0 * spring.mean_radius(t),
        "pitch": spring.pitch,
    }[name]
    values = function(0.5 * (spring.breaks[1:] + spring.breaks[:-1]))
    if np.ptp(values) > SAME * np.abs(values).max():
        closed = name == "pitch" and not spring.bottom.form == spring.top.form == "open"
        hint = "; leave end_coils out" if closed else ""
        raise InputError(
            f"{values.min():.6g} to {values.max():.6g} mm; the same value is needed in all turns, as of a "
            f"cylindrical spring{hint}",
            f"spring.{name}",
        )
    return float(values.mean())


def _fits(extent: tuple[float, float, float, float], diameter: float) -> None:
    height = extent[3] - extent[2]
    if abs(height - diameter) > 1e-3 * diameter:
        raise InputError(
            f"{diameter:g} mm, but the section is {height:.5g} mm high along the spring; give its height",
            "spring.wire_diameter",
        )


def _wire(case: Case) -> Outline | None:
    """The outline of a case's wire that is not round.

    Raises:
        InputError: if it is turned.
    """
    spec = case.spring.wire if isinstance(case.spring, SpringSpec) else None
    if spec is None:
        return None
    if spec.angle:
        raise InputError("a slice is a section that is not turned; use 'coilset solve'", "spring.wire.angle")
    return spec.drawn()


def _across(section: SectionMesh) -> tuple[float, float]:
    """ξ of the section's surface at η = 0, at the inside and at the outside of the coil, mm."""
    if section.middle is None:
        low, high = section.extent[2:]
        raise InputError(
            f"the section lies at η = {low:.5g} to {high:.5g} mm; give η from the wire's centre line, "
            "which it must reach",
            "section.points",
        )
    return section.middle


def _ends_turn(case: Case) -> bool:
    """Whether an end is free to turn about the spring's axis."""
    for end in ("bottom", "top"):
        turn = getattr(case.seats, end).turn
        if not isinstance(turn, str):
            raise InputError(f"{turn:g} N mm/rad; the slice's ends are held or free", f"seats.{end}.turn")
    return case.ends_turn
