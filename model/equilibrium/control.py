"""Every number that steers the iteration and the steps, with its unit and its reason; `solver.control` of a case file.

How much each of them matters is measured in docs/methods.md: each halved and doubled over the shipped springs.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class NewtonControl:
    """How one step is solved.

    Attributes:
        stagnation: iterations without a new least residual that count as stagnation.
        part_tolerance: ε of (6.3.1) for a part of a step, which is only a place to go on from.
        smallest_part: of a step, balanced on the way to the whole; smaller ones are left to the step control.
        augmentations: of the contacts in a step, at most.
        accepted_work: |s(λ)/s(0)| of the out-of-balance work up to which a full correction is taken though the norm grows.
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
    """

    stagnation: int = 25
    part_tolerance: float = 0.2
    smallest_part: float = 0.1
    augmentations: int = 40
    accepted_work: float = 0.3
    sought_work: float = 0.3
    search_trials: int = 6
    bracket_margin: float = 0.1
    backtrack: float = 0.4
    smallest_step_length: float = 1e-3
    stress_backtrack: float = 0.25
    free_penetration: float | None = None
    penetration_growth: float = 1.5
    smallest_contact_step: float = 0.02
    contact_bisections: int = 6


@dataclass(frozen=True)
class StepControl:
    """How steps follow each other; sizes are in regular steps, of which a phase has its `steps`.

    Attributes:
        smallest: size below which the walk is given up.
        attempts: solves for each regular step, and `spare_attempts` more, before the walk is said to stall.
        spare_attempts: see there.
        automatic: regular steps of an automatic phase; its first step is one of them.
        easy: iterations up to which an automatic step lets the next one grow.
        hard: iterations from which it makes the next one shrink.
        growth: factor of an automatic step after an easy one.
        shrinkage: factor of an automatic step after a hard one.
        largest: size of an automatic step.
        cut: factor of a step that found no equilibrium.
        regrowth: factor by which an equal step that was cut grows again, up to 1.
        probe: travel by which the initial rate is measured, in free lengths.
    """

    smallest: float = 2.0**-10
    attempts: int = 40
    spare_attempts: int = 200
    automatic: int = 16
    easy: int = 5
    hard: int = 10
    growth: float = 1.5
    shrinkage: float = 0.7
    largest: float = 2.0
    cut: float = 0.5
    regrowth: float = 2.0
    probe: float = 1e-3
