"""The load program of a spring: stages to a height or a force, one after the other."""

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from coilset.model.equilibrium.axial_control import AxialControl
from coilset.model.equilibrium.continuation import Continuation
from coilset.model.equilibrium.convergence import Outcome
from coilset.model.equilibrium.load import Load
from coilset.model.equilibrium.step_control import Path, Position

log = logging.getLogger("coilset.steps")


@dataclass(frozen=True)
class Stage:
    """Go to a height or to a force.

    Attributes:
        kind: what is driven.
        value: at the end, mm or N.
        steps: number of equal steps, or auto, or the parts of the stage at which they end, ascending to 1.
        label: in words.
    """

    kind: Literal["height", "force"]
    value: float
    steps: int | Literal["auto"] | tuple[float, ...]
    label: str


@dataclass(frozen=True)
class ProgramPosition:
    """Where in the program the spring stands.

    Attributes:
        stage: number of the stage.
        height, force: where the stage began, mm and N.
        on_path: Position on the path of the stage.
        redirected: where it goes in place of the stage's own target; None: there.
    """

    stage: int
    height: float
    force: float
    on_path: Position
    redirected: Stage | None = None


@dataclass(frozen=True)
class StepTaken:
    """One converged step: its number from 1, the part of the stage that is behind, how often it was cut, Outcome."""

    number: int
    progress: float
    cuts: int
    outcome: Outcome


class LoadProgram:
    """Drives a spring through stages.

    Args:
        control: AxialControl.
        continuation: Continuation.
    """

    def __init__(self, control: AxialControl, continuation: Continuation) -> None:
        self.control, self.continuation = control, continuation
        self.begin(0)

    def begin(self, number: int) -> None:
        """Stand at the start of a stage."""
        self.redirected: Stage | None = None
        self.number, self._height, self._force = number, self.control.height, self.control.force
        self.continuation.begin()

    @property
    def position(self) -> ProgramPosition:
        """Where the spring stands."""
        return ProgramPosition(
            self.number, self._height, self._force, self.continuation.steps.position, self.redirected
        )

    @position.setter
    def position(self, position: ProgramPosition) -> None:
        self.number, self._height, self._force = position.stage, position.height, position.force
        self.continuation.steps.position, self.redirected = position.on_path, position.redirected

    def run(self, stage: Stage) -> Iterator[StepTaken]:
        """Go on to the stage's target, step by step.

        Raises:
            SolveError: as Continuation.advance.
        """
        self.stage, continuation = self.redirected or stage, self.continuation
        while continuation.steps.position.done < (regular := self._regular(self.stage)):
            path = self._path(self.stage)
            outcome, cuts = continuation.advance(path)
            error = outcome.estimate.force if outcome.estimate is not None else math.nan
            log.info("step %d: %.6g mm, %.6g N, %d iterations, out of balance %.1e, error about %.2g N; next %.4g of a "
                     "regular step", continuation.number, self.control.height, self.control.force, outcome.iterations,
                     outcome.ratio, error, continuation.steps.position.size)  # fmt: skip
            done = continuation.steps.position.done
            progress = (done if path.length is None else path.length(done)) / regular
            yield StepTaken(continuation.number, progress, cuts, outcome)

    def redirect(self, stage: Stage) -> None:
        """Go to another target from here on, in place of the stage in progress."""
        self.begin(self.number)
        self.stage = self.redirected = stage

    def _regular(self, stage: Stage) -> int:
        if isinstance(stage.steps, tuple):
            return len(stage.steps)
        return self.continuation.control.automatic if stage.steps == "auto" else stage.steps

    def _path(self, stage: Stage) -> Path:
        regular, begin = self._regular(stage), self._force if stage.kind == "force" else self._height

        marks = np.array([0.0, *stage.steps]) if isinstance(stage.steps, tuple) else None

        def part(done: float) -> float:
            return done / regular if marks is None else float(np.interp(done, np.arange(regular + 1), marks))

        def load(done: float) -> Load:
            value = stage.value if done >= regular else begin + part(done) * (stage.value - begin)
            return self.control.to_force(value) if stage.kind == "force" else self.control.to_height(value)

        return Path(load, regular, stage.label, stage.steps == "auto",
                    lambda: f"{self.control.height:.6g} mm and {self.control.force:.6g} N",
                    None if marks is None else lambda done: regular * part(done))  # fmt: skip
