"""The load program of a spring: stages to heights, forces and other values of its heads, one after the other."""

import logging
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.body.body import Moment
from coilset.model.core.contact.base import SEAT_DOFS
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.path.step_sizes import ON_MARK, Path, Position
from coilset.model.core.equilibrium.settings import Drive
from coilset.model.core.equilibrium.system.heads import AXIAL, When
from coilset.model.core.equilibrium.system.layout import SEATS
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System

log = logging.getLogger("coilset.steps")
START = Moment(0.0, 0.0)
STILL, STILL_FORCE = 1e-9, 1e-10  # mm, and over E A: heights and forces differ by no more where they stay
FIRST_TIME = 1e-6  # of a hold: below it equal steps are equal times, above it equal factors of time


@dataclass(frozen=True)
class Stage:
    """Go to a height or to a force, or let time pass.

    Attributes:
        kind: what is driven.
        value: at the end, mm or N; None: as at the start.
        steps: number of equal steps, or auto, or the parts of the stage at which they end, ascending to 1.
        label: in words.
        hours: how long it takes; 0: no time.
        temperature: at the end, K; None: as at the start.
        even: whether equal parts take equal times although the temperature stays.
        drives: of the heads' other freedoms that this or an earlier stage drives.
    """

    kind: Literal["height", "force"]
    value: float | None
    steps: int | Literal["auto"] | tuple[float, ...]
    label: str
    hours: float = 0.0
    temperature: float | None = None
    even: bool = False
    drives: tuple[Drive, ...] = ()


@dataclass(frozen=True)
class ProgramPosition:
    """Position in the load program.

    Attributes:
        stage: number of the stage.
        height, force: where the stage began, mm and N.
        on_path: Position on the path of the stage.
        redirected: where it goes in place of the stage's own target; None: there.
        behind: part of the stage before its path.
        opened_from: the force from which the heads are opened, N, see LoadProgram; None: they are not.
        begun: Moment when the stage began.
        heads: values of the heads' freedoms where it began, mm and rad, and their forces on the spring, N and N mm.
    """

    stage: int
    height: float
    force: float
    on_path: Position
    redirected: Stage | None = None
    behind: float = 0.0
    opened_from: float | None = None
    begun: Moment = START
    heads: tuple[float, ...] = (0.0,) * 24


@dataclass(frozen=True)
class StepTaken:
    """One converged step.

    Attributes:
        number: from 1.
        progress: part of the stage that is behind.
        part: part of the stage that it took.
        cuts: how often it was cut.
        outcome: Outcome.
    """

    number: int
    progress: float
    part: float
    cuts: int
    outcome: Outcome


_SIDEWAYS, _TILT = (("a displacement", "mm"), ("a side force", "N")), (("a tilt", "°"), ("a tilt moment", "N mm"))
_TURN = ("a rotation", "°"), ("a torque", "N mm")
_TARGETS = (_SIDEWAYS, _SIDEWAYS, (("a height", "mm"), ("a force", "N")), _TILT, _TILT, _TURN)
"""Names and units of what may drive each freedom of a head: its value, or its force."""


class Driven(Protocol):
    """What a load program drives: coilset.model.core.equilibrium.system.heads.Heads, or what takes their place."""

    free_length: float
    measure: int
    system: System

    @property
    def height(self) -> float:
        """See Heads, as all that follows."""
        ...

    @property
    def force(self) -> float:
        """Axial force at the last equilibrium."""
        ...

    def load(self, values: Mapping[int, float], forces: Mapping[int, float], kept: Collection[int] = ()) -> Load:
        """The load to values and forces of freedoms."""
        ...

    def freedom_at(self, height: float) -> float:
        """Value of the axial freedom at a height."""
        ...

    def freedoms(self, when: When) -> np.ndarray:
        """Values of all freedoms."""
        ...

    def reactions(self, when: When) -> np.ndarray:
        """Forces that are conjugate to them."""
        ...


class LoadProgram:
    """Drives a spring through stages.

    A spring whose coils have slipped past each other is released along a path on which its force rises for a while, and
    which a force that falls cannot follow. Where it finds no equilibrium, the heads are opened, as a press does, until
    the force has fallen by a regular step.

    Args:
        control: Heads, or what takes their place.
    """

    def __init__(self, control: Driven, continuation: Continuation) -> None:
        self.control, self.continuation = control, continuation
        self.begin(0)

    def begin(self, number: int) -> None:
        """Begin a stage at the last equilibrium."""
        self.redirected: Stage | None = None
        self.number = number
        self._begin_path()

    def _begin_path(self, behind: float = 0.0, opened_from: float | None = None) -> None:
        """Begin a path at the last equilibrium, where a part of the stage is behind."""
        self._behind, self._opened_from = behind, opened_from
        self._height, self._force = self.control.height, self.control.force
        self._heads = (*self.control.freedoms("equilibrium"), *self.control.reactions("equilibrium"))
        self._begun = self.now
        self.continuation.begin()

    @property
    def now(self) -> Moment:
        """Time and temperature at the last equilibrium."""
        return Moment(*(float(value) for value in self.control.system.body.clock[:2]))

    @property
    def position(self) -> ProgramPosition:
        """Position in the load program."""
        return ProgramPosition(
            self.number,
            self._height,
            self._force,
            self.continuation.steps.position,
            self.redirected,
            self._behind,
            self._opened_from,
            self._begun,
            tuple(float(value) for value in self._heads),
        )

    @position.setter
    def position(self, position: ProgramPosition) -> None:
        self.number, self._height, self._force = position.stage, position.height, position.force
        self._behind, self._opened_from = position.behind, position.opened_from
        self._begun, self._heads = position.begun, position.heads
        self.continuation.steps.position, self.redirected = position.on_path, position.redirected

    def run(self, stage: Stage) -> Iterator[StepTaken]:
        """Go on to the stage's target, step by step.

        Raises:
            SolveError: as Continuation.advance.
        """
        self.stage, continuation = self.redirected or stage, self.continuation
        self.control.measure = measure = self._measure(self.stage)
        continuation.guess.carried = measure % SEAT_DOFS >= SEAT_DOFS // 2  # a rotation
        while continuation.steps.position.done < self._regular(self.stage):
            opens = self._opened_from is None and self._can_open(self.stage)
            if opens and not continuation.steps.position.done and self._rises_first(self.stage):
                self._open("its force rises first")
                opens = False
            path = replace(self._path(self._driven(self.stage)), gives_way=opens)
            before = self._progress(path)
            try:
                outcome, cuts = continuation.advance(path)
            except SolveError as failure:
                if not opens:
                    raise
                self._open(str(failure))
                continue
            error = outcome.estimate.force if outcome.estimate is not None else math.nan
            log.info(
                "step %d: %.6g mm, %.6g N, %d iterations, out of balance %.1e, error about %.2g N; next %.4g of a "
                "regular step",
                continuation.number,
                self.control.height,
                self.control.force,
                outcome.iterations,
                outcome.ratio,
                error,
                continuation.steps.position.size,
            )
            progress = self._progress(path)
            if self._fallen(self.control.force) * continuation.control.automatic >= 1.0:
                self._begin_path(progress)
            yield StepTaken(continuation.number, progress, progress - before, cuts, outcome)

    def _progress(self, path: Path) -> float:
        """Part of the stage that is behind."""
        return self._behind + (1.0 - self._behind) * path.progress(self.continuation.steps.position.done)

    # ---- a release along which the force rises ---------------------------------------------------------------------

    def _can_open(self, stage: Stage) -> bool:
        """Whether a stage releases the spring by its force alone; collective."""
        drives = any(drive.end is not None or drive.table for drive in stage.drives)
        if stage.kind != "force" or stage.value is None or stage.hours or drives:
            return False
        force = self.control.force
        resists = (self.control.free_length - self.control.height) * force > 0.0
        return resists and 0.0 <= stage.value / force < 1.0

    def _rises_first(self, stage: Stage) -> bool:
        """Whether the spring would be unstable where it is, were its force prescribed; collective."""
        control, continuation = self.control, self.continuation
        if continuation.branches is None:
            return False
        continuation.system.restore()
        return bool(continuation.branches.is_unstable(self._load(stage, control.force, 0.0)))

    def _open(self, reason: str) -> None:
        """Open the heads from here on."""
        log.info("step %d: the heads are opened (%s)", self.continuation.number + 1, reason)
        self._begin_path(self._progress(self._path(self._driven(self.stage))), self.control.force)

    def _driven(self, stage: Stage) -> Stage:
        """What drives a stage now: itself, or the height, which leads beyond the free spring and never to its end."""
        if self._opened_from is None:
            return stage
        return replace(stage, kind="height", value=2.0 * self.control.free_length - self._height)

    def _fallen(self, force: float) -> float:
        """Part of the way from where the heads are opened to the stage's target, by a force."""
        if self._opened_from is None or self.stage.value is None:
            return 0.0
        return (force - self._opened_from) / (self.stage.value - self._opened_from)

    def opened_too_far(self, force: float) -> str | None:
        """The reason why a trial state with this force lies beyond the target of an opening, or None."""
        return "the heads would be opened beyond the target" if self._fallen(force) >= 1.0 else None

    def settle(self, taken: StepTaken) -> StepTaken:
        """Find equilibrium again at the same height or force, after something else has changed the body; collective.

        Returns:
            The last step, with what this cost.

        Raises:
            SolveError: if there is none near.
        """
        control = self.control
        axial = control.force if self.stage.kind == "force" else control.height
        load = self._load(self.stage, axial, 1.0)
        outcome = self.continuation.settle(load, taken.outcome)
        if not outcome.converged:
            raise SolveError(f"no equilibrium with the temperatures after step {taken.number}: {outcome.reason}")
        return replace(taken, outcome=outcome)

    def redirect(self, stage: Stage) -> None:
        """Go to another target from here on, in place of the stage in progress."""
        self.begin(self.number)
        self.stage = self.redirected = stage

    def _regular(self, stage: Stage) -> int:
        if isinstance(stage.steps, tuple):
            return len(self._marks(stage.steps))
        return self.continuation.control.automatic if stage.steps == "auto" else stage.steps

    def _marks(self, steps: tuple[float, ...]) -> list[float]:
        """The ends of steps, in parts of the path to which they belong."""
        return [(mark - self._behind) / (1.0 - self._behind) for mark in steps if mark > self._behind + ON_MARK]

    def _path(self, stage: Stage) -> Path:
        regular, begin = self._regular(stage), self._force if stage.kind == "force" else self._height
        end = begin if stage.value is None else stage.value
        marks = np.array([0.0, *self._marks(stage.steps)]) if isinstance(stage.steps, tuple) else None

        def part(done: float) -> float:
            return done / regular if marks is None else float(np.interp(done, np.arange(regular + 1), marks))

        def load(done: float) -> Load:
            if done >= regular:
                return self._load(stage, end, 1.0)
            return self._load(stage, begin + part(done) * (end - begin), part(done))

        return Path(
            load,
            regular,
            stage.label,
            stage.steps == "auto",
            self._place,
            lambda: self._reachable(stage),
            None if marks is None else lambda done: regular * part(done),
            self._moments(stage, part) if stage.hours else None,
        )

    def _place(self) -> str:
        """The last equilibrium in words: height and force, or value and force of another freedom that is driven."""
        control, measure = self.control, self.control.measure
        if measure == AXIAL:
            return f"{control.height:.6g} mm and {control.force:.6g} N"
        value, force = (
            values[measure] for values in (control.freedoms("equilibrium"), control.reactions("equilibrium"))
        )
        if measure % SEAT_DOFS < SEAT_DOFS // 2:
            return f"{value:.6g} mm sideways and {force:.6g} N"
        return f"{math.degrees(value):.4g}° and {force:.6g} N mm"

    def _reachable(self, stage: Stage) -> str:
        """The last equilibrium as another target, rounded to four digits towards where the stage began."""
        by_force, control, measure = stage.kind == "force", self.control, self.control.measure
        begin, value = (self._force, control.force) if by_force else (self._height, control.height)
        if measure != AXIAL:
            by_force = any(drive.freedom == measure and drive.kind == "force" for drive in stage.drives)
            begin = self._heads[measure + (SEATS if by_force else 0)]
            value = float((control.reactions if by_force else control.freedoms)("equilibrium")[measure])
            if measure % SEAT_DOFS >= SEAT_DOFS // 2 and not by_force:
                begin, value = math.degrees(begin), math.degrees(value)
        elif stage.value is None:
            return ""
        if value in (0.0, begin):
            return ""
        scale = 10.0 ** (3 - math.floor(math.log10(abs(value))))
        rounded = (math.ceil if value < begin else math.floor)(scale * value) / scale
        words, unit = _TARGETS[measure % SEAT_DOFS][by_force]
        return f"{words} of {rounded:.6g} {unit} can be reached"

    def _load(self, stage: Stage, axial: float, part: float) -> Load:
        """The load to a part of a stage, where the height or force is `axial`."""
        control = self.control
        by_force = stage.kind == "force"
        values = {} if by_force else {AXIAL: control.freedom_at(axial)}
        forces = {AXIAL: -axial} if by_force else {}
        staying = [drive for drive in stage.drives if drive.kind == "value" and drive.end is None and not drive.table]
        for drive in stage.drives:
            if drive in staying:
                continue
            begin = self._heads[drive.freedom + (0 if drive.kind == "value" else SEATS)]
            value = begin if drive.end is None else begin + part * (drive.end - begin)
            if drive.table:
                value = float(np.interp(control.free_length - axial, drive.table[0], drive.table[1]))
            (values if drive.kind == "value" else forces)[drive.freedom] = value
        return control.load(values, forces, [drive.freedom for drive in staying])

    def _measure(self, stage: Stage) -> int:
        """The freedom that a stage drives: the axial one, unless it stays and another is driven."""
        by_force, axial_force = stage.kind == "force", self.control.system.body.axial_force
        begin, still = (self._force, STILL_FORCE * axial_force) if by_force else (self._height, STILL)
        stays = stage.value is None or abs(stage.value - begin) <= still
        driven = [drive.freedom for drive in stage.drives if drive.end is not None]
        if not stays or not driven:
            return AXIAL
        return max(driven, key=lambda freedom: freedom % SEAT_DOFS)

    def _moments(self, stage: Stage, part: Callable[[float], float]) -> Callable[[float], Moment]:
        """Time and temperature along a stage, by places on its path.

        A temperature goes linearly in time, with equal times in equal steps, and so does a target. Held at constant
        temperature a spring creeps ever more slowly: equal steps then are equal ones of log(1 + t/t₁), with t₁ =
        `FIRST_TIME` of the whole.
        """
        begun, last = self._begun, self._begun.temperature if stage.temperature is None else stage.temperature

        def moment(done: float) -> Moment:
            time = min(part(done), 1.0)
            if stage.temperature is None and not stage.even and time < 1.0:
                time = FIRST_TIME * math.expm1(time * math.log1p(1.0 / FIRST_TIME))
            return Moment(begun.hours + time * stage.hours, begun.temperature + time * (last - begun.temperature))

        return moment
