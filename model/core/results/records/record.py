"""The results of a run as frozen records, which writers, figures and checkpoints take."""

import math
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from typing import Any, Literal

import numpy as np

from coilset.model.core.base.warning import Warning
from coilset.model.core.results import surface
from coilset.model.core.results.records.drawn import Drawn, SectionPoints
from coilset.model.core.results.records.frame import Frame
from coilset.model.core.results.records.units import words_and_unit

ENDS = ("bottom", "top")
AT_REST = 1e-6  # of the greatest load so far, and of the height: what changes by less stays as it is


@dataclass(frozen=True)
class Step:
    """One converged step.

    Its `iterations` are those of the solve that found it; its `evaluations` of states, and `failed_solves`, count what
    failed before it too, see coilset.model.core.equilibrium.newton.outcome.Outcome.

    Attributes:
        number: from 1 on; phase: number of the phase that it belongs to, from 0 on.
        progress: part of the phase that is behind at its end.
        seat_height_mm: distance of the seats or heads; travel_mm: that of the unloaded spring, less this.
        cuts: how often it was cut.
        contacts: closed contact elements; penetration_mm: the maximum of coils and seats.
        force_N: axial force of the seats or heads on the spring, compression positive; 0 after lift-off from a seat.
        negative_pivots: negative eigenvalues of the tangent; the state is unstable if there are any.
        left_branch: 1 if the step includes a snap-through, from a path that ends or is unstable, else 0.
        released_energy_Nmm: potential energy that it lost then.
        axis_offset_mm: maximum distance by which a turn's mean has moved off the spring's axis.
        least_eigenvalue: the lowest of the tangent, N/mm; None where it was not requested.
        plastic_work_max_N_per_mm2: maximum b* on the wire's surface.
        lift_off_mm: clearance between the wire and the seat that it has left; 0 while both seats press.
        least_rise: minimum rise from a coil to the next, over the rise at which they touch; None where coils pass
            each other by their shape, or there is only one.
        steps_force_error_N: what the length of the steps up to here has left wrong in the force, true value minus
            result, and steps_height_error_mm in the height at which this force would be; None where it is not known.
            Of a spring that its heads turn these are errors of torque and rotation, at the mean radius of its coil.
        estimated_force_error_N, estimated_height_error_mm: sizes of both errors by all causes, see RunErrors; None
            where one is not known, and until the run is complete.
        hours: since the start, of a material that creeps.
        temperature_K: of the spring; at its start where plastic work heats it.
        load_loss_percent: of the force with which time began to pass, at constant height; None where no time passes.
        turn_deg: rotation of the top head about the spring's axis, less that of the bottom one.
        torque_Nmm: moment of the top head on the spring about its axis.
    """

    number: int
    phase: int
    progress: float
    seat_height_mm: float
    travel_mm: float
    force_N: float
    iterations: int
    evaluations: int
    failed_solves: int
    cuts: int
    contacts: int
    penetration_mm: float
    negative_pivots: int = 0
    left_branch: int = 0
    released_energy_Nmm: float = 0.0
    axis_offset_mm: float = 0.0
    least_eigenvalue: float | None = None
    plastic_work_max_N_per_mm2: float = 0.0
    lift_off_mm: float = 0.0
    least_rise: float | None = None
    steps_force_error_N: float | None = None
    steps_height_error_mm: float | None = None
    estimated_force_error_N: float | None = None
    estimated_height_error_mm: float | None = None
    hours: float = 0.0
    temperature_K: float = 0.0
    load_loss_percent: float | None = None
    turn_deg: float = 0.0
    torque_Nmm: float = 0.0

    def measured(self, radius: float = 0.0) -> tuple[float, float]:
        """Travel, mm, and force, N; of a spring whose heads turn it about its axis those at a `radius`, mm, not 0."""
        return (
            (radius * math.radians(self.turn_deg), self.torque_Nmm / radius)
            if radius
            else (self.travel_mm, self.force_N)
        )

    def load(self, radius: float) -> float:
        """The greater of the axial force and that of the torque at a radius, mm; N."""
        return max(abs(self.force_N), abs(self.torque_Nmm) / radius)

    def rests(self, before: "Step", load: float, radius: float) -> bool:
        """Whether it neither loads nor relaxes the spring, so that what was wrong before it is as wrong after it.

        A spring free of load may move between its seats, where weak springs hold its tips.

        Args:
            before: the step before it.
            load: the greatest so far, N; radius: of the coil, mm.
        """
        least = AT_REST * load
        turned = abs(self.torque_Nmm - before.torque_Nmm) > least * radius
        if self.hours != before.hours or (turned and not (self.lift_off_mm or before.lift_off_mm)):
            return False
        if max(abs(self.force_N), abs(before.force_N)) <= least:
            return True
        height = abs(self.seat_height_mm - before.seat_height_mm)
        return abs(self.force_N - before.force_N) <= least and height <= AT_REST * self.seat_height_mm


@dataclass(frozen=True)
class Snapshot:
    """The spring at one moment, in the order of its stations and elements; complete on rank 0.

    Attributes:
        name: what moment it is, such as `start`, `block`, `force 0 N`.
        height, force: of the seats, mm and N.
        x: station positions, shape (n + 1, 3), mm.
        triads: element triads (columns), shape (n, 3, 3).
        resultants: N, Q2, Q3, Mt, M2, M3 at the sections, shape (n, sections, 6), N and N mm.
        point_state: at the section points, shape (n, sections, points, n_state), MPa.
        surface_state: at the points on the wire's surface, shape (n, sections, surface points, n_state), MPa.
        components: names of the columns of both.
        turn: rotation of the top head or, if nothing holds the spring, of its top tip about the axis, less that of the
            bottom one, degrees.
        free: whether nothing holds the spring, see coilset.model.core.equilibrium.path.free_ends.
    """

    name: str
    height: float
    force: float
    x: np.ndarray
    triads: np.ndarray
    resultants: np.ndarray
    point_state: np.ndarray
    surface_state: np.ndarray
    components: tuple[str, ...]
    turn: float = 0.0
    free: bool = False

    @property
    def shear(self) -> np.ndarray:
        """Magnitude of the shear stress at the section points, shape (n, sections, points), MPa."""
        return surface.shear(self.point_state, self.components)


@dataclass(frozen=True)
class ForceLine:
    """Planes and axis for the evaluation of a spring's force line.

    Attributes:
        lower, upper: heights of two planes above the bottom seat of the unloaded spring, mm; None: not requested.
        point, direction: of the damper's axis, mm, in the spring's coordinates; the direction of any length.
        guides, friction: places of two guides along the axis from the point, mm, and their coefficient of friction.
    """

    lower: float | None
    upper: float | None
    point: tuple[float, ...]
    direction: tuple[float, ...]
    guides: tuple[float, ...] = ()
    friction: float = math.nan


@dataclass(frozen=True)
class SeatReaction:
    """Force and moment of one seat, or clamped head, on the spring, and its pose.

    Attributes:
        force_N: axial force, compression positive; zero after lift-off.
        lateral_x_N, lateral_y_N: force across the axis, with that of a held tip.
        moment_x_Nmm, moment_y_Nmm, moment_z_Nmm: about the point where the axis meets the seat, with those of a held
            tip; z along the axis.
        centre_x_mm, centre_y_mm: where the resultant crosses the seat (force centre), from the axis.
        eccentricity_mm: its distance from the axis.
        pressure_x_mm, pressure_y_mm: centre of the seat's pressure alone, without the force on a held tip.
        length_mm: length of wire in contact with the seat, to the spacing of its points.
        down_turns: extent of the contact, turns from the wire's tip to the farthest place where it touches the seat.
        tilt_rad: angle between the seat's axis and the spring's.
        shift_x_mm, shift_y_mm: displacement of the seat across the axis.
        tilt_x_deg, tilt_y_deg, turn_deg: its rotation vector, about the axis last.
    """

    force_N: float
    lateral_x_N: float
    lateral_y_N: float
    moment_x_Nmm: float
    moment_y_Nmm: float
    moment_z_Nmm: float
    centre_x_mm: float
    centre_y_mm: float
    eccentricity_mm: float
    pressure_x_mm: float
    pressure_y_mm: float
    length_mm: float
    down_turns: float
    tilt_rad: float
    shift_x_mm: float
    shift_y_mm: float
    tilt_x_deg: float
    tilt_y_deg: float
    turn_deg: float


@dataclass(frozen=True)
class SeatReactions:
    """Both ends after one step.

    Attributes:
        step: number of the step.
        active_turns: turns that carry the load, ∫ (Mt/(F r))² dt: the number of turns under the torque F r throughout
            that would hold as much torsional energy, as in R = G d⁴/(64 r³ n). Mt, F and r are those of the state; not
            a number without a force.
        free_turns: turns of wire that touch neither seat nor coil.
        side_force_N: force of the top head on the spring across the axis.
        line_lower_x_mm, line_lower_y_mm, line_upper_x_mm, line_upper_y_mm: where the force line, the line of action of
            the top head's force, crosses the two planes of the ForceLine; not numbers without one, or without a force.
        damper_moment_Nmm, damper_torque_Nmm: moment of the top head's reaction on the body above it, about the point of
            the damper: its size across the damper's axis, and its part about it.
        damper_friction_N: friction of the damper's rod by that force alone; not a number without guides.
        imbalance_N, imbalance_Nmm: size of the sum of all forces on the wire, and of their moments about the origin:
            of both ends, of arbor and sleeve, and of the coils on each other.
        bottom, top: SeatReactions of the ends.
        pressure: one row for each point of the wire in contact: number of the kind of contact, number of the point,
            force per length of wire in N/mm; shape (m, 3). Between coils it is twice the point's own force,
            as each of both wires searches for the other with half of the bedding.
    """

    step: int
    active_turns: float
    free_turns: float
    side_force_N: float
    line_lower_x_mm: float
    line_lower_y_mm: float
    line_upper_x_mm: float
    line_upper_y_mm: float
    damper_moment_Nmm: float
    damper_torque_Nmm: float
    damper_friction_N: float
    imbalance_N: float
    imbalance_Nmm: float
    bottom: SeatReaction
    top: SeatReaction
    pressure: np.ndarray

    def row(self) -> dict[str, Any]:
        """As flat entries, without the pressure."""
        flat: dict[str, Any] = {name: getattr(self, name) for name in WHOLE}
        for end in ENDS:
            flat |= {f"{end}_{name}": value for name, value in asdict(getattr(self, end)).items()}
        return flat

    @classmethod
    def from_row(cls, row: dict[str, Any], pressure: np.ndarray) -> "SeatReactions":
        """The reverse of `row`."""
        names = [item.name for item in fields(SeatReaction)]
        bottom, top = (SeatReaction(**{name: row[f"{end}_{name}"] for name in names}) for end in ENDS)
        return cls(**{name: row[name] for name in WHOLE}, bottom=bottom, top=top, pressure=pressure)


WHOLE = tuple(item.name for item in fields(SeatReactions) if item.name not in (*ENDS, "pressure"))
"""Entries of SeatReactions that are of the whole spring."""


@dataclass(frozen=True)
class ContactRecord:
    """One kind of contact.

    Attributes:
        name: for labels.
        end: `bottom` or `top` for a seat, else None.
        wire_turns: turns of the points of the wire on which it acts, shape (m,); empty for kinds that have none.
    """

    name: str
    end: str | None
    wire_turns: np.ndarray


@dataclass(frozen=True)
class Limits:
    """Limits with which the results of a run are compared.

    Attributes:
        plastic_work: b* up to which the material's constants are valid, N/mm².
        strength: minimum tensile strength of the wire, MPa; None if no wire of a standard is named.
        penetration: usual maximum penetration, mm.
        accuracy: requested error due to the step size, over the maximum force and over the set; None: it is
            not estimated.
        shear: shear stress allowed at block for a wire of a standard, MPa; None: no such wire is named.
        shear_of: which stress it limits, `corrected stress` or `uncorrected stress`.
        creep: range of the tests that the constants of creep are from, None if it is unknown or nothing creeps.
    """

    plastic_work: float
    strength: float | None
    penetration: float
    accuracy: float | None
    shear: float | None = None
    shear_of: str = ""
    creep: Any = None


@dataclass(frozen=True)
class Limit:
    """Limits of one result.

    Attributes:
        name: of the result in the summary.
        low, high: between which it must be.
        source: where they are from, in words.
    """

    name: str
    low: float
    high: float
    source: str

    @property
    def words(self) -> str:
        """The result, with its unit."""
        words, unit = words_and_unit(self.name)
        return f"{words}, {unit}"

    def margin(self, value: float) -> float:
        """Distance from the nearer limit; negative outside."""
        return min(value - self.low, self.high - value)


@dataclass(frozen=True)
class Setup:
    """Description of a run: spring, mesh, load program, limits.

    Attributes:
        spring: the stress-free spring, Drawn.
        material: name of the law.
        ends: `seats` or `clamped`.
        phases: labels of the load program.
        forces_given, torques_given: of each phase, whether it ends at a given axial force, or at a torque of a head.
        turns: of the stations, shape (n + 1,).
        wire_radius: of the elements, shape (n,), mm.
        contacts: ContactRecords.
        sections: SectionPoints.
        buckling_travel: at which the spring buckles after EN 13906-1, mm; infinite if it never does.
        limits: Limits.
        rates_at: travels, mm, at which the rate is requested.
        warnings: Warnings about the case, before it ran.
        coiling_diameter: mean diameter to which the wire was coiled at mid-wire, mm; None: it was not coiled.
        force_line: ForceLine, or None.
        initial_tension: with which coils are wound onto each other, N; 0: they are not.
        strength: coilset.model.physics.fatigue.strength.Strength of the wire, or None.
        nominal_stress: under 1 N by EN 13906-1, and corrected for curvature, MPa/N; None if no cylinder.
        bounds: Limits of results.
    """

    spring: Drawn
    material: str
    ends: str
    phases: tuple[str, ...]
    forces_given: tuple[bool, ...]
    torques_given: tuple[bool, ...]
    turns: np.ndarray
    wire_radius: np.ndarray
    contacts: tuple[ContactRecord, ...]
    sections: SectionPoints
    buckling_travel: float
    limits: Limits
    rates_at: tuple[float, ...] = ()
    warnings: tuple[Warning, ...] = ()
    coiling_diameter: float | None = None
    force_line: ForceLine | None = None
    initial_tension: float = 0.0
    strength: Any = None
    nominal_stress: tuple[float | None, float | None] = (None, None)
    bounds: tuple[Limit, ...] = ()

    @property
    def slender(self) -> bool:
        """Whether it can buckle."""
        return math.isfinite(self.buckling_travel)

    def is_force_given(self, step: Step) -> bool:
        """Whether the force at the end of a step is a target of the load program, so that its height is the result."""
        return self.forces_given[step.phase] and step.progress >= 1.0

    def is_torque_given(self, step: Step) -> bool:
        """Whether the torque at the end of a step is a target, so that its rotation is the result."""
        return self.torques_given[step.phase] and step.progress >= 1.0

    @property
    def section_turns(self) -> np.ndarray:
        """Turns of the sections, shape (n, sections)."""
        return self.turns[:-1, None] + np.diff(self.turns)[:, None] * self.sections.abscissae

    @cached_property
    def inside(self) -> surface.Inside:
        """Position of the inside of the coil on the wire's surface; plane sections have that of manufacture."""
        return surface.Inside.of(bool(self.sections.curvature.any()), self.spring.hand)

    def outer_length(self, x: np.ndarray) -> float:
        """Height of the wire between two planes across the axis that just touch it, stations at `x`, mm."""
        top = x[:, 2] + self.spring.above
        bottom = x[:, 2] - self.spring.below
        return float(top.max() - bottom.min())


@dataclass(frozen=True)
class BucklingMode:
    """Buckling mode of a slender spring: the weakest mode of the tangent at the step with its lowest eigenvalue.

    Attributes:
        travel_mm, force_N: of the step.
        eigenvalue: of the tangent there, N/mm.
        x: station positions, shape (n + 1, 3), mm.
        displacement: of the stations, maximum 1 mm, shape (n + 1, 3).
    """

    travel_mm: float
    force_N: float
    eigenvalue: float
    x: np.ndarray
    displacement: np.ndarray


@dataclass(frozen=True)
class Errors:
    """Sizes of the errors by one cause; None where they are not known or there is no such number.

    Attributes:
        force_N: of the maximum force; set_mm: of the set; residual_shear_inside_MPa: of the residual shear stress. Of a
            spring that its heads turn the first two are those of torque and rotation, at the mean radius of its coil.
    """

    force_N: float | None
    set_mm: float | None
    residual_shear_inside_MPa: float | None


@dataclass(frozen=True)
class RunErrors:
    """Estimated errors of a run by their causes, see coilset.model.tools.further_runs.error_estimates.

    Attributes:
        steps: the length of the steps; mesh: that of the elements; section: the points of the sections; contact: the
            stiffness of seats and coils against penetration; warping: that of sections that are not round, kept
            elastic, or found among polynomials of a degree.
    """

    steps: Errors
    mesh: Errors
    section: Errors
    contact: Errors
    warping: Errors

    @cached_property
    def total(self) -> Errors:
        """All of them together, as if they had the same sign; None where one is not known."""

        def together(name: str) -> float | None:
            values = [getattr(getattr(self, cause.name), name) for cause in fields(self)]
            return None if None in values else float(sum(values))

        return Errors(*(together(item.name) for item in fields(Errors)))

    def largest(self, name: str) -> str:
        """The cause of the largest error of a number, by its name in Errors."""
        return max((cause.name for cause in fields(self)), key=lambda cause: getattr(getattr(self, cause), name) or 0.0)


@dataclass(frozen=True)
class WorkingState:
    """The spring at a working length or force.

    Attributes:
        kind, value: what the case gives, `length` in mm or `force` in N.
        reason: why the spring cannot be there; empty if it is.
        rate: of the spring there, N/mm; NaN where it is not.
        step: Step that leads there, with the errors there; seats: SeatReactions; snapshot: Snapshot. None where the
            spring is not there.
    """

    kind: Literal["length", "force"]
    value: float
    reason: str = ""
    rate: float = float("nan")
    step: Step | None = None
    seats: SeatReactions | None = None
    snapshot: Snapshot | None = None

    @property
    def label(self) -> str:
        """In words."""
        return f"{self.value:g} {'mm' if self.kind == 'length' else 'N'}"

    @property
    def length(self) -> float:
        """Of the spring there, mm; NaN where it is not."""
        return self.step.seat_height_mm if self.step else math.nan

    @property
    def force(self) -> float:
        """Under which it is there, N; NaN where it is not."""
        return self.step.force_N if self.step else math.nan

    @property
    def error(self) -> float | None:
        """Size of the error of the force at a length, N, or of the length under a force, mm, by all causes; None where
        it is not known."""
        if self.step is None:
            return None
        return self.step.estimated_force_error_N if self.kind == "length" else self.step.estimated_height_error_mm


@dataclass(frozen=True, eq=False)
class Working:
    """All working states of a spring.

    Attributes:
        states: WorkingStates in the order of the file.
        set: further set of the spring by going there, mm; None where the load program does not end with a release.
    """

    states: tuple[WorkingState, ...]
    set: float | None = None

    @property
    def reached(self) -> tuple[WorkingState, ...]:
        """Those at which the spring can be."""
        return tuple(state for state in self.states if not state.reason)


@dataclass(frozen=True)
class Result:
    """Results of a run so far; `complete` is False if it ended before its program did.

    Attributes:
        steps: converged Steps.
        seats, frames: SeatReactions and Frames of the wire after each of them; empty if only the steps are recorded.
        snapshots: Snapshots at the start and after each phase.
        rate: initial rate, N/mm; NaN where no equilibrium was found for it. rate_error: estimated size of its error by
            the mesh, N/mm; None where it is not known.
        warnings: Warnings of moments that its other records do not show.
        mode: BucklingMode of a spring that is slender enough to buckle; else None.
        errors: RunErrors of a complete run; None where they are not estimated.
        working: the finished spring at its working lengths; None without any, and until the run is complete.
        finer: what became of a finer run that its errors call for, in words; empty without one.
    """

    steps: tuple[Step, ...] = ()
    seats: tuple[SeatReactions, ...] = ()
    frames: tuple[Frame, ...] = field(default=(), repr=False)
    snapshots: tuple[Snapshot, ...] = field(default=(), repr=False)
    rate: float = float("nan")
    rate_error: float | None = None
    complete: bool = False
    warnings: tuple[Warning, ...] = ()
    mode: BucklingMode | None = field(default=None, repr=False)
    errors: RunErrors | None = None
    working: Working | None = field(default=None, repr=False)
    finer: str = ""

    @property
    def top(self) -> Step | None:
        """The step of the force of largest magnitude; None before the first step."""
        return max(self.steps, key=lambda step: abs(step.force_N), default=None)

    @property
    def greatest_force(self) -> float:
        """Magnitude of the largest force so far, N."""
        return abs(self.top.force_N) if self.top else 0.0
