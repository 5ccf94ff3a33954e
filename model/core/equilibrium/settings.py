"""Numbers that control the course of the iteration and the steps, with their units; `solver.control` of a case file.

How exactly equilibrium is solved, and in how many iterations at most, are entries of `solver` in `case/case.py`.

These are the numbers that a spring may need to be changed. What else controls the course are constants beside their
use; how much each number and constant matters is measured in docs/tuning.md.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, NamedTuple

from annotated_types import Unit
from pydantic import ConfigDict, Field

from coilset.model.core.base.strict_entries import Whole

Positive = Annotated[float, Unit("1"), Field(gt=0, strict=True)]
Fraction = Annotated[float, Unit("1"), Field(gt=0, lt=1, strict=True)]
Growth = Annotated[float, Unit("1"), Field(ge=1, strict=True)]
Count = Annotated[Whole, Field(ge=1, strict=True)]
MethodName = Literal["newton", "modified-newton", "modified-newton-anderson", "bfgs", "broyden", "arc-length"]
STRICT = ConfigDict(extra="forbid", allow_inf_nan=False)


# Entries of earlier versions that are constants now, each in capitals in its file of model/.
CONSTANTS = {
    "newton.part_tolerance": "core/equilibrium/newton/iteration.py",
    "newton.smallest_part": "core/equilibrium/newton/newton.py",
    "newton.accepted_work": "core/equilibrium/newton/line_search.py",
    "newton.sought_work": "core/equilibrium/newton/line_search.py",
    "newton.search_trials": "core/equilibrium/newton/line_search.py",
    "newton.bracket_margin": "core/equilibrium/newton/line_search.py",
    "newton.backtrack": "core/equilibrium/newton/line_search.py",
    "newton.smallest_step_length": "core/equilibrium/newton/line_search.py",
    "newton.stress_backtrack": "core/equilibrium/newton/line_search.py",
    "newton.penetration_growth": "core/equilibrium/newton/contact_limit.py",
    "newton.smallest_contact_step": "core/equilibrium/newton/contact_limit.py",
    "newton.contact_bisections": "core/equilibrium/newton/contact_limit.py",
    "steps.easy": "core/equilibrium/path/step_sizes.py",
    "steps.hard": "core/equilibrium/path/step_sizes.py",
    "steps.shrinkage": "core/equilibrium/path/step_sizes.py",
    "steps.cut": "core/equilibrium/path/step_sizes.py",
    "steps.tolerated_share": "core/equilibrium/path/step_sizes.py",
    "steps.finest": "core/equilibrium/path/step_sizes.py",
    "steps.regrowth": "core/equilibrium/path/step_sizes.py",
    "steps.unstable_cuts": "core/equilibrium/path/step_sizes.py",
    "steps.least_rest": "physics/accuracy/step_error.py",
    "steps.caution": "physics/accuracy/step_error.py",
    "steps.least_factor": "physics/accuracy/step_error.py",
    "steps.bend": "core/equilibrium/path/guess.py",
    "steps.snap_advance": "physics/stability/branch_switching.py",
    "steps.snap_steps": "physics/stability/branch_switching.py",
    "steps.snap_failures": "physics/stability/branch_switching.py",
}


@dataclass(frozen=True)
class NewtonControl:
    """How one step is solved.

    Attributes:
        stagnation: number of iterations without a new minimum of the residual that counts as stagnation.
        augmentations: maximum number of augmentations of the contacts in a step.
        predicted_forces: whether the stiffness of rotating rods is built with the forces that the last correction
            predicts; left out: where no contact, and after corrections that increase only spurious forces.
    """

    __pydantic_config__: ClassVar[ConfigDict] = STRICT
    stagnation: Count = 24
    augmentations: Count = 40
    predicted_forces: Annotated[bool | None, Field(strict=True)] = None


@dataclass(frozen=True)
class StepControl:
    """How steps follow each other. Sizes are relative to a regular step; a phase has `steps` of these.

    Attributes:
        smallest: size below which the path is abandoned.
        patience: evaluations in vain, of attempts without an equilibrium, after which a snap is tried, with as many at
            most, and the program is given up, unless it has advanced by a hundredth of the phase, or by a regular step.
        automatic: number of regular steps in an automatic phase; it starts with one of these.
        growth: factor on the length of an automatic step after an easy one; it never grows by more.
        largest: maximum size of an automatic step.
        largest_with_friction: the same with friction, as no estimate shows what long steps miss of its path.
        step_share: share of the requested accuracy that the error of one automatic step may use up.
        probe: travel over which the initial rate is measured.
        branch_amplitude: maximum displacement in the weakest mode with which a path is left.
    """

    __pydantic_config__: ClassVar[ConfigDict] = STRICT
    smallest: Fraction = 2.0**-10
    patience: Count = 1000
    automatic: Count = 16
    growth: Growth = 1.5
    largest: Growth = 3.0
    largest_with_friction: Growth = 2.0
    step_share: Positive = 0.2
    probe: Annotated[Fraction, Unit("free lengths")] = 1e-3
    branch_amplitude: Annotated[Positive, Unit("wire radii")] = 0.2


class Drive(NamedTuple):
    """What drives one freedom of a head.

    Attributes:
        freedom: its number, of the bottom head from 0, of the top head from 6 on.
        kind: whether its value is prescribed or the force that is conjugate to it.
        end: its value at the end of the phase, mm, rad, N or N mm; None: as at its start.
        table: travels, mm, and values over them; empty if there are none.
    """

    freedom: int
    kind: Literal["value", "force"]
    end: float | None
    table: tuple[tuple[float, ...], ...] = ()
