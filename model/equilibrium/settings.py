"""Numbers that control the course of the iteration and the steps, with their units; `solver.control` of a case file.

How exactly equilibrium is solved, and in how many iterations at most, are entries of `solver` in `case/case.py`.

How much each of them matters is measured in docs/tuning.md: each halved and doubled over the shipped springs.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, NamedTuple

from annotated_types import Unit
from pydantic import ConfigDict, Field

from coilset.model.base.strict_entries import Whole

Positive = Annotated[float, Unit("1"), Field(gt=0, strict=True)]
Fraction = Annotated[float, Unit("1"), Field(gt=0, lt=1, strict=True)]
Growth = Annotated[float, Unit("1"), Field(ge=1, strict=True)]
Count = Annotated[Whole, Field(ge=1, strict=True)]
MethodName = Literal["newton", "modified-newton", "modified-newton-anderson", "bfgs", "broyden", "arc-length"]
STRICT = ConfigDict(extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class NewtonControl:
    """How one step is solved.

    Attributes:
        stagnation: number of iterations without a new minimum of the residual that counts as stagnation.
        part_tolerance: ε of (6.3.1) for a part of a step, whose state is only the start of the next part.
        smallest_part: smallest part of a step that is solved on the way to the whole; below it, the step is cut.
        augmentations: maximum number of augmentations of the contacts in a step.
        accepted_work: |s(λ)/s(0)| of the out-of-balance work up to which a full correction is accepted although the
            norm grows.
        sought_work: |s(λ)/s(0)| at which the search for a zero of the work ends where something touches; elsewhere it
            ends at `accepted_work`.
        search_trials: maximum number of trials of that search.
        bracket_margin: distance that a trial keeps from both ends of the bracket, as a share of its width.
        backtrack: factor on the step length where the work has no zero.
        smallest_step_length: step length at which backtracking ends.
        stress_backtrack: factor on the step length where the law finds no stress.
        free_penetration: penetration that any correction may cause; left out: `contact.penetration_limit`.
        penetration_growth: factor by which one correction may increase a penetration that is deeper than that.
        smallest_contact_step: share of a correction that is made whatever it does to the contacts.
        contact_bisections: number of bisections to find the share of a correction that the contacts allow.
        predicted_forces: whether the stiffness of rotating rods is built with the forces that the last correction
            predicts; left out: where no contact, and after corrections that increase only spurious forces.
    """

    __pydantic_config__: ClassVar[ConfigDict] = STRICT
    stagnation: Count = 24
    part_tolerance: Fraction = 0.2
    smallest_part: Fraction = 0.1
    augmentations: Count = 40
    accepted_work: Fraction = 0.3
    sought_work: Fraction = 0.7
    search_trials: Count = 6
    bracket_margin: Fraction = 0.15
    backtrack: Fraction = 0.4
    smallest_step_length: Fraction = 0.05
    stress_backtrack: Fraction = 0.25
    free_penetration: Annotated[Positive, Unit("wire diameters")] | None = None
    penetration_growth: Growth = 1.5
    smallest_contact_step: Fraction = 0.02
    contact_bisections: Count = 6
    predicted_forces: Annotated[bool | None, Field(strict=True)] = None


@dataclass(frozen=True)
class StepControl:
    """How steps follow each other. Sizes are relative to a regular step; a phase has `steps` of these.

    Attributes:
        smallest: size below which the path is abandoned.
        patience: evaluations in vain, of attempts without an equilibrium, after which a snap is tried, with as many at
            most, and the program is given up, unless it has advanced by a hundredth of the phase, or by a regular step.
        automatic: number of regular steps in an automatic phase; it starts with one of these.
        easy: number of iterations up to which the next automatic step becomes longer.
        hard: number of iterations from which the next automatic step becomes shorter.
        growth: factor on the length of an automatic step after an easy one; it never grows by more.
        shrinkage: factor on the length of an automatic step after a hard one, unless that was shorter than a hard one
            before it and took more iterations for its length.
        largest: maximum size of an automatic step.
        largest_with_friction: the same with friction, as no estimate shows what long steps miss of its path.
        cut: factor on the length of a step that found no equilibrium.
        step_share: share of the requested accuracy that the error of one automatic step may use up.
        least_rest: share of that share which a step may use up even if nothing of the accuracy is left.
        tolerated_share: multiple of that share up to which a step is still kept; the next one is shorter.
        finest: size below which an automatic step is no longer shortened because of its error.
        caution: factor on the size that the estimated error allows.
        least_factor: smallest factor on the length of a step after a large error, or when it is cut because of one.
        bend: share of a step's starting point by which the change between the last two steps may alter it; a larger
            change is taken for a kink of the path.
        regrowth: factor by which an equal step that was cut grows again, up to size 1.
        probe: travel over which the initial rate is measured.
        unstable_cuts: number of times that a step ending in an unstable state is cut before its path is left.
        branch_amplitude: maximum displacement in the weakest mode with which a path is left.
        snap_advance: distance that a snapping spring moves in its first step against the drag.
        snap_steps: maximum number of these steps until the spring comes to rest.
        snap_failures: number of these steps in a row that may fail or go more than four times as far.
    """

    __pydantic_config__: ClassVar[ConfigDict] = STRICT
    smallest: Fraction = 2.0**-10
    patience: Count = 1000
    automatic: Count = 16
    easy: Count = 5
    hard: Count = 10
    growth: Growth = 1.5
    shrinkage: Fraction = 0.7
    largest: Growth = 3.0
    largest_with_friction: Growth = 2.0
    cut: Fraction = 0.5
    step_share: Positive = 0.2
    least_rest: Fraction = 0.2
    tolerated_share: Growth = 2.0
    finest: Fraction = 2.0**-6
    caution: Fraction = 0.9
    least_factor: Fraction = 0.25
    bend: Fraction = 0.05
    regrowth: Growth = 2.0
    probe: Annotated[Fraction, Unit("free lengths")] = 1e-3
    unstable_cuts: Count = 8
    branch_amplitude: Annotated[Positive, Unit("wire radii")] = 0.2
    snap_advance: Annotated[Positive, Unit("wire radii")] = 1.0
    snap_steps: Count = 200
    snap_failures: Count = 8


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
