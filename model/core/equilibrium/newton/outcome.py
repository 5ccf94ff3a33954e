"""What a solve was, in numbers and words, and what the size of its step left wrong."""

from dataclasses import KW_ONLY, dataclass, replace


@dataclass(frozen=True)
class Estimate:
    """What the length of the steps has left wrong.

    Attributes:
        force: true force at this height, less the one found, N; height: true height at this force, less the one found,
            mm. Not a number where they are not known.
        share: what this step has brought in, over what it may.
        factor: of its size, for a step that brings in what it may.
    """

    force: float
    height: float
    share: float
    factor: float


@dataclass(frozen=True)
class Outcome:
    """Outcome and cost of a step.

    Attributes:
        converged: whether it is in equilibrium.
        reason: in words.
        ratio: left side of (6.3.1).
        iterations: new states, including a first one that only meets the prescribed increments.
        factorisations: tangents assembled and factorised.
        evaluations: states evaluated, each with the law at every point, including those of line searches.
        linear_iterations: of iterative linear solvers.
        negative_pivots: negative eigenvalues of the tangent where they were counted; the state is unstable if there
            are.
        left_branch: whether the body snapped, from a path that ends or is unstable, before this state.
        released: potential energy released by the snap, N mm.
        failed_solves: solves that did not lead to it, before this one: other starts, parts of the step, and the whole
            steps that were cut. Their factorisations and evaluations are counted above, their iterations are not.
        stagnated: whether it ended because the out-of-balance forces no longer decreased.
        estimate: of the error due to the step size; None if unknown.
        refused: whether it is a rejected equilibrium: too deep a penetration, or too large an error.
    """

    converged: bool
    reason: str
    ratio: float
    _: KW_ONLY
    iterations: int = 0
    factorisations: int = 0
    evaluations: int = 0
    linear_iterations: int = 0
    negative_pivots: int = 0
    left_branch: bool = False
    released: float = 0.0
    failed_solves: int = 0
    stagnated: bool = False
    estimate: Estimate | None = None
    refused: bool = False

    def __add__(self, following: "Outcome") -> "Outcome":
        """The outcome of two solves, one after the other."""
        counts = ("iterations", "factorisations", "evaluations", "linear_iterations", "failed_solves")
        return replace(following, **{name: getattr(self, name) + getattr(following, name) for name in counts})
