"""Every number that steers the iteration and the steps, with its unit and its reason; `solver.control` of a case file.

How much each of them matters is measured in docs/methods.md: each halved and doubled over the shipped springs.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from annotated_types import Unit
from pydantic import ConfigDict, Field

from coilset.meshes.entry import Whole

Positive = Annotated[float, Unit("1"), Field(gt=0, strict=True)]
Fraction = Annotated[float, Unit("1"), Field(gt=0, lt=1, strict=True)]
Growth = Annotated[float, Unit("1"), Field(ge=1, strict=True)]
Count = Annotated[Whole, Field(ge=1, strict=True)]
STRICT = ConfigDict(extra="forbid", allow_inf_nan=False)


@dataclass(frozen=True)
class NewtonControl:
    """How one step is solved.

    Attributes:
        stagnation: iterations without a new least residual that count as stagnation.
        part_tolerance: ε of (6.3.1) for a part of a step, which is only a place to go on from.
        smallest_part: of a step, balanced on the way to the whole; smaller ones are left to the step control.
        augmentations: of the contacts in a step, at most.
        accepted_work: |s(λ)/s(0)| of the out-of-balance work up to which a full correction is taken, though the norm
            grows.
        sought_work: |s(λ)/s(0)| at which the search for a zero of the work ends.
        search_trials: of that search, at most.
        bracket_margin: share of the bracket by which a trial keeps away from its ends.
        backtrack: factor of the step length where the work has no zero.
        smallest_step_length: where going back ends.
        stress_backtrack: factor of the step length where the law finds no stress.
        free_penetration: wire diameters up to which a correction may press coils and seats; None: the contacts' limit.
        penetration_growth: factor by which a deeper penetration may grow in one correction.
        smallest_contact_step: share of a correction that is gone whatever the contacts say.
        contact_bisections: to find how far a correction may go.
        foreseen_forces: is the stiffness of turning rods built with the forces that the last correction foresees? None:
            where nothing touches, and after a correction that has only feigned greater forces.
    """

    __pydantic_config__: ClassVar[ConfigDict] = STRICT
    stagnation: Count = 24
    part_tolerance: Fraction = 0.2
    smallest_part: Fraction = 0.1
    augmentations: Count = 40
    accepted_work: Fraction = 0.3
    sought_work: Fraction = 0.3
    search_trials: Count = 6
    bracket_margin: Fraction = 0.1
    backtrack: Fraction = 0.4
    smallest_step_length: Fraction = 1e-3
    stress_backtrack: Fraction = 0.25
    free_penetration: Positive | None = None
    penetration_growth: Growth = 1.5
    smallest_contact_step: Fraction = 0.02
    contact_bisections: Count = 6
    foreseen_forces: Annotated[bool | None, Field(strict=True)] = None


@dataclass(frozen=True)
class StepControl:
    """How steps follow each other; sizes are in regular steps, of which a phase has its `steps`.

    Attributes:
        smallest: size below which the path is given up.
        attempts: solves for each regular step, and `spare_attempts` more, before the program is said to stall.
        spare_attempts: see `attempts`.
        automatic: regular steps of an automatic phase; its first step is one of them.
        easy: iterations up to which an automatic step lets the next one grow.
        hard: iterations from which it makes the next one shrink.
        growth: factor of an automatic step after an easy one.
        shrinkage: factor of an automatic step after a hard one.
        largest: size of an automatic step.
        cut: factor of a step that found no equilibrium.
        step_share: of the accuracy that is asked for, which the error of one automatic step may take.
        tolerated_share: of that, up to which a step is kept all the same; the next one is shorter.
        finest: size below which an automatic step is not made shorter for its error.
        caution: factor of the size that the estimate allows.
        least_factor: of a step after one with a great error, and of one that is cut for its error.
        regrowth: factor by which an equal step that was cut grows again, up to 1.
        probe: travel by which the initial rate is measured, in free lengths.
        unstable_cuts: how often a step is cut where it ends in an unstable state, before its path is left.
        branch_amplitude: maximum displacement of the weakest mode by which a path is left at first, in wire radii.
        snap_advance: way of a spring that snaps in one step of it, in wire radii.
        snap_steps: of these at most, until it rests.
        snap_failures: of these that may fail, or go more than four times as far, one after the other.
    """

    __pydantic_config__: ClassVar[ConfigDict] = STRICT
    smallest: Fraction = 2.0**-10
    attempts: Count = 40
    spare_attempts: Annotated[Whole, Field(ge=0, strict=True)] = 200
    automatic: Count = 16
    easy: Count = 5
    hard: Count = 10
    growth: Growth = 1.5
    shrinkage: Fraction = 0.7
    largest: Growth = 2.0
    cut: Fraction = 0.5
    step_share: Positive = 0.2
    tolerated_share: Growth = 1.5
    finest: Fraction = 2.0**-6
    caution: Fraction = 0.9
    least_factor: Fraction = 0.25
    regrowth: Growth = 2.0
    probe: Fraction = 1e-3
    unstable_cuts: Count = 8
    branch_amplitude: Positive = 0.2
    snap_advance: Positive = 1.0
    snap_steps: Count = 200
    snap_failures: Count = 8
