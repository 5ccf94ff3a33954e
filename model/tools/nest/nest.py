"""Two coaxial springs between the same seats, each on its own as long as they do not touch each other.

Seats that are rigid and stay level give both springs the same height, and their forces add up. That holds while the
wire of the inner spring stays inside that of the outer one: the room between them is computed after every step, from
the maximum distance of the one and the minimum distance of the other from the axis, anywhere along the axis. It is
sufficient, not necessary: a cone may fit into a cone with less. Contact between the two is not computed.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mpi4py import MPI

from coilset.meshes.springs.geometry import Spring
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError, SolveError, naming
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case
from coilset.model.core.case.phases import Phase, Target
from coilset.model.core.case.targets import check_pressed
from coilset.model.core.results.records.closing import before_vertical
from coilset.model.core.results.records.record import Errors, Result, Setup, Step
from coilset.model.tools.nest.file import NAMES, Nest
from coilset.model.tools.nest.plan import Plan, plan

NEAR = 1e-6  # mm, between a step's height and the plan's


@dataclass(frozen=True)
class Member:
    """One spring of the nest after its run; `result` is None of a spring that the seats never reach."""

    name: str
    case: Case
    spring: Spring
    setup: Setup
    result: Result | None


@dataclass(frozen=True)
class Pressed:
    """The nest after its run.

    Attributes:
        plan: heights of the seats.
        members: outer and inner spring.
        forces: of each spring after every step of the plan, N, shape (2, steps + 1).
        clearance: between them then, mm, shape (steps + 1,).
        warnings: of the nest itself.
    """

    plan: Plan
    members: tuple[Member, Member]
    forces: np.ndarray
    clearance: np.ndarray
    warnings: tuple[Warning, ...]

    @property
    def force(self) -> np.ndarray:
        """Of both together, N, shape (steps + 1,)."""
        return self.forces.sum(axis=0)

    @property
    def free_length_after(self) -> float | None:
        """Height at which the seats touch the first spring after the run, mm; None if one was not released."""
        lengths = [self._after(member) for member in self.members]
        return None if None in lengths else max(length for length in lengths if length is not None)

    @property
    def force_error(self) -> float | None:
        """Estimated size of the error of the maximum force, N: those of both springs together; None if not known."""
        return _sum(self._errors(member).force_N for member in self.members)

    def closing(self) -> tuple[float | None, float | None, float | None]:
        """Height, mm, and force of both, N, before the vertical of a nest that is pressed to block, and the size of
        that force's error; None where there is no vertical, or the error is not known."""
        heights, force = self.plan.heights, self.force
        last = int(np.argmin(heights))
        if heights[last] > self.plan.block + NEAR:
            return None, None, None
        own = [_steps(member, self.plan) for member in self.members]
        errors = [
            _sum(0.0 if step is None else step.estimated_force_error_N for step in both)
            for both in zip(*own, strict=True)
        ]
        travels = (heights[0] - heights[: last + 1]).tolist()
        found = before_vertical(travels, force[: last + 1].tolist(), errors[: last + 1])
        return (None, None, None) if found is None else (float(heights[found]), float(force[found]), errors[found])

    @property
    def set_error(self) -> float | None:
        """Estimated size of the error of `free_length_after` and of the set, mm; None if not known.

        Either spring may be the longer one within the errors of both.
        """
        after, own = self.free_length_after, []
        for member in self.members:
            length, error = self._after(member), self._errors(member).set_mm
            if length is None or error is None:
                return None
            own.append((length, error))
        assert after is not None
        return max(
            max(length + error for length, error in own) - after, after - max(length - error for length, error in own)
        )

    @staticmethod
    def _errors(member: Member) -> Errors:
        """Of a spring that the seats never reach zero."""
        if member.result is None:
            return Errors(0.0, 0.0, 0.0)
        return Errors(None, None, None) if member.result.errors is None else member.result.errors.total

    @staticmethod
    def _after(member: Member) -> float | None:
        if member.result is None:
            return member.setup.spring.free_length
        if not member.result.complete:
            return None
        return float(member.setup.outer_length(member.result.snapshots[-1].x))


def _sum(errors: Iterable[float | None]) -> float | None:
    """Of errors of both springs; None if one is not known."""
    known = list(errors)
    return None if None in known else sum(one for one in known if one is not None)


def press(nest: Nest, report: Callable[[str, Step], object] = lambda name, step: None, threads: int = 1) -> Pressed:
    """Press both springs through the heights of the nest, and let them go.

    Args:
        report: called with the name of a spring and each of its steps.
        threads: of each run.

    Raises:
        InputError: if the inner spring has no room in the outer one, or a case is wrong.
        SolveError: if a spring finds no equilibrium, or the springs would touch each other.
    """
    springs = [_build(case, file) for case, file in zip(nest.cases, nest.files, strict=True)]
    turns = [np.linspace(0.0, one.turns, 64 * int(np.ceil(one.turns)) + 1) for one in springs]
    wires = [one.centre_line(t) for one, t in zip(springs, turns, strict=True)]
    room, reach = inside(springs[0], turns[0], wires[0]), outside(springs[1], turns[1], wires[1])
    if not room > reach:
        raise InputError(
            f"reaches {reach:.4g} mm from the axis, but the outer spring leaves {room:.4g} mm: it has no room inside",
            "inner",
            nest.path,
        )
    with naming(nest.path):
        heights = plan(nest.loading, springs)
    programs = [heights.program(one.free_length) for one in springs]
    members = tuple(_run(nest, number, program, report, threads) for number, program in enumerate(programs))
    steps = [_steps(member, heights) for member in members]
    forces = np.array([[0.0 if step is None else step.force_N for step in one] for one in steps])
    clearance = _clearance(members, steps)
    _refuse_touching(heights, clearance)
    return Pressed(heights, (members[0], members[1]), forces, clearance, tuple(_hands(springs)))


def _build(case: Case, file: Path) -> Spring:
    with naming(file):
        spring = case.spring.build()
        check_pressed(spring)
        return spring


def _run(nest: Nest, number: int, program: list[Phase], report: Callable[[str, Step], object], threads: int) -> Member:
    """Run one spring through its program; without one the seats do not touch it."""
    name, case = NAMES[number], nest.cases[number]
    loading = program or [Phase(to=Target(force=0.0), steps=1)]  # its own is that of another run
    with naming(nest.files[number]):
        analysis = Analysis(case.model_copy(update={"loading": loading}), MPI.COMM_SELF, threads=threads)
    if not program:
        return Member(name, case, analysis.spring, analysis.setup, None)
    try:
        analysis.run(lambda step: report(name, step))
    except SolveError as error:
        raise SolveError(f"{name}: {error}") from None
    return Member(name, analysis.case, analysis.spring, analysis.setup, analysis.result)


def _steps(member: Member, heights: Plan) -> list[Step | None]:
    """The spring's step at each height of the plan; None where the seats do not reach it, or at the start."""
    length, found = member.setup.spring.free_length, list[Step | None]([None])
    taken = iter(member.result.steps if member.result else ())
    at = length
    for height in np.minimum(heights.heights[1:], length):
        if abs(height - at) > NEAR:
            found.append(next(step for step in taken if abs(step.seat_height_mm - height) < NEAR))
        else:
            found.append(found[-1])
        at = height
    return found


def _clearance(members: Sequence[Member], steps: Sequence[Sequence[Step | None]]) -> np.ndarray:
    """Room between the springs after every step of the plan, mm."""
    far = []
    for member, own, reach in zip(members, steps, (inside, outside), strict=True):
        spring, turns, frames = member.spring, member.setup.turns, member.result.frames if member.result else []
        start = reach(spring, turns, spring.centre_line(turns))
        far.append([start if step is None else reach(spring, turns, frames[step.number - 1].x) for step in own])
    room, reach = np.array(far)
    return room - reach


def _refuse_touching(heights: Plan, clearance: np.ndarray) -> None:
    touching = np.flatnonzero(clearance <= 0.0)
    if touching.size:
        at = int(touching[0])
        raise SolveError(
            f"at the height of {heights.heights[at]:.6g} mm the springs touch each other: they overlap by "
            f"{-clearance[at]:.3g} mm; their contact is not modelled, and their forces cannot be added from "
            "there"
        )


def _hands(springs: Sequence[Spring]) -> list[Warning]:
    if springs[0].hand != springs[1].hand:
        return []
    return [
        Warning(
            "hands",
            "inner.spring.hand",
            "both springs are wound in the same direction: coils of one can slip "
            "between those of the other; nested springs are wound in opposite ones (a maker's rule)",
            float(springs[1].hand),
            float(-springs[0].hand),
        )
    ]


def outside(spring: Spring, turns: np.ndarray, x: np.ndarray) -> float:
    """The largest distance of the wire's surface from the axis, mm.

    Args:
        spring: whose wire it is.
        turns: of the stations, shape (n,).
        x: their positions, shape (n, 3), mm.
    """
    return float((np.hypot(x[:, 0], x[:, 1]) + 0.5 * spring.width * spring.wire_diameter(turns)).max())


def inside(spring: Spring, turns: np.ndarray, x: np.ndarray) -> float:
    """The minimum distance of the wire's surface from the axis, mm; arguments as in `outside`."""
    return float((np.hypot(x[:, 0], x[:, 1]) - 0.5 * spring.width * spring.wire_diameter(turns)).min())
