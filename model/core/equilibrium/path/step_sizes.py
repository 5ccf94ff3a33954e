"""Sizes of steps: where they end, how they are cut, how they grow again.

Equal steps end on their marks, also after a cut. Automatic ones take the size that their error and the iteration allow.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from coilset.model.core.base.errors import SolveError
from coilset.model.core.body.body import Moment
from coilset.model.core.equilibrium.newton.outcome import Outcome
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.equilibrium.system.load import Load

ON_MARK = 1e-9  # of a regular step: what is nearer to a mark is on it
CUT = 0.5  # factor on the length of a step that found no equilibrium
UNSTABLE_CUTS = 8  # of a step that ends in an unstable state, before its path is left
REGROWTH = 2.0  # factor by which an equal step that was cut grows again, up to size 1
EASY, HARD = 5, 10  # iterations up to which the next automatic step becomes longer, and from which it becomes shorter
# Factor on the length of an automatic step after a hard one, unless that was shorter than a hard one before it and took
# more iterations for its length.
SHRINKAGE = 0.7
TOLERATED_SHARE = 2.0  # of the error that a step may have, up to which it is still kept; the next one is shorter
FINEST = 2.0**-6  # size below which an automatic step is no longer shortened because of its error
RESTART = 0.25  # size up to which the step may be after one that was shortened to end at a touch, or to cross it
ADVANCE = 1e-2  # of a path, which must be made before `patience` evaluations are in vain


@dataclass(frozen=True)
class Path:
    """Loads along the way to a target.

    Attributes:
        load: the load from the last equilibrium to a place on the path, which is counted in regular steps.
        regular: number of regular steps.
        target: in words, for logs and errors.
        automatic: do steps take the size that their error and the iteration allow? Equal steps end on their marks,
            also after a cut.
        place: where on it the body is, in words.
        reachable: what can be given in place of the target, in words; empty if that is unknown.
        moment: time and temperature at a place on the path; None where no time passes.
        gives_way: whether the first step without an equilibrium ends it, as another way leads on.
        length: of the path up to a place that is counted in regular steps, in their mean length; None: they are equal.
    """

    load: Callable[[float], Load]
    regular: int = 1
    target: str = "the target"
    automatic: bool = False
    place: Callable[[], str] = lambda: "here"
    reachable: Callable[[], str] = lambda: ""
    length: Callable[[float], float] | None = None
    moment: Callable[[float], Moment] | None = None
    gives_way: bool = False

    def step_length(self, done: float, size: float) -> float:
        """Length of a step of a size from a place on the path, both in regular steps; in their mean length."""
        return size if self.length is None else self.length(done + size) - self.length(done)

    def failure(self, *reasons: str) -> SolveError:
        """The error of a path that ends where the body is, for reasons of which some may be empty."""
        why = "; ".join(reason for reason in (*reasons, self.reachable()) if reason)
        return SolveError(f"no equilibrium beyond {self.place()} on the way to {self.target}: {why}")

    def progress(self, done: float) -> float:
        """Part of the path up to a place on it, which is counted in regular steps."""
        return self.step_length(0.0, done) / self.regular


@dataclass(frozen=True)
class Position:
    """Position of the continuation on its path.

    Attributes:
        done: what is behind, in regular steps.
        size: next step, in regular steps.
        cuts: how often the step in progress was cut.
        last: length of the last step, whose increments are the guess for the next one; 0 if there is no guess.
        before: length of the last step on this path; 0 if there is none.
        earlier: length of the step before that one on this path; 0 if there is none.
        share: of the last step's error, see Estimate; 0 while the wire is elastic.
        iterations: of the last step on this path.
    """

    done: float = 0.0
    size: float = 1.0
    cuts: int = 0
    last: float = 0.0
    before: float = 0.0
    earlier: float = 0.0
    share: float = 0.0
    iterations: int = 0

    @property
    def has_left_branch(self) -> bool:
        """Whether the last step on this path left another one that became unstable."""
        return self.done > 0.0 and not self.before


class StepSizes:
    """Sizes of the steps along a path.

    Attributes:
        position: Position.
    """

    def __init__(self, control: StepControl) -> None:
        self.control, self.position = control, Position()
        self._mark: tuple[float, int] | None = None  # where the path was last found to advance; `in_vain` there

    def begin(self) -> None:
        """Stand at the start of a path."""
        self.position, self._mark = Position(), None

    def begin_patience(self) -> None:
        """Count the evaluations in vain from here on."""
        self._mark = None

    def resize(self, size: float) -> None:
        """Make the next step as large as `size` regular steps."""
        self.position = replace(self.position, size=size)

    def restart(self, wanted: float) -> None:
        """Go on after a step that a touch has made shorter than `wanted`."""
        self.resize(max(self.position.size, min(RESTART, wanted)))

    def size(self, path: Path) -> float:
        """Size of the step to try now, in regular steps."""
        position = self.position
        size = min(position.size, path.regular - position.done)
        if path.automatic:
            return size
        # on its way to the next mark, or to a later one if it was made as long as that
        mark = max(int(position.done + ON_MARK) + 1, int(position.done + size + ON_MARK))
        return min(size, mark - position.done)

    def stalls(self, path: Path, in_vain: int) -> bool:
        """Whether more than `patience` evaluations were in vain while the body hardly advanced.

        Args:
            path: it.
            in_vain: evaluations that found no equilibrium, of all so far.
        """
        done = self.position.done
        if self._mark is None or done - self._mark[0] >= min(1.0, ADVANCE * path.regular) * (1.0 - ON_MARK):
            self._mark = done, in_vain
        return in_vain - self._mark[1] > self.control.patience

    def accept(self, path: Path, outcome: Outcome, size: float) -> None:
        """Stand at the end of a step of this size."""
        last = 0.0 if outcome.left_branch else path.step_length(self.position.done, size)
        done, following = self.position.done + size, self._following(path, outcome, size)
        before, share = self.position.before, 0.0 if outcome.estimate is None else outcome.estimate.share
        self.position = Position(done, following, 0, last, last, before if last else 0.0, share, outcome.iterations)

    def cut(self, outcome: Outcome, size: float) -> bool:
        """Make a step of this size, which failed, shorter; is it still as long as a step must be?"""
        factor = CUT
        if outcome.refused and outcome.estimate is not None:  # only its error was too large
            factor = outcome.estimate.factor
        shorter = factor * size
        self.position = replace(self.position, size=shorter, cuts=self.position.cuts + 1, last=0.0)
        return shorter >= self.control.smallest

    def is_last(self, size: float) -> bool:
        """Whether a step of this size would be too short if it were cut."""
        return CUT * size < self.control.smallest

    def is_near_unstable(self, size: float) -> bool:
        """Whether a step of this size, which ends in an unstable state, is short enough to leave its path.

        The last stable state is near once the step is as short as so many cuts make a regular one, however many of
        these were for steps before.
        """
        return size <= (1.0 + ON_MARK) * CUT**UNSTABLE_CUTS or self.position.cuts >= UNSTABLE_CUTS

    def _following(self, path: Path, outcome: Outcome, size: float) -> float:
        """Size of the step after one of this size."""
        control = self.control
        if not path.automatic:
            return min(1.0, REGROWTH * size)
        easy, hard = outcome.iterations <= EASY, outcome.iterations >= HARD
        hard = hard and not self._shortened_in_vain(path.step_length(self.position.done, size), outcome.iterations)
        factor = control.growth if easy else SHRINKAGE if hard else 1.0
        if outcome.estimate is not None:
            least = FINEST / size  # up to there its error does not shorten a step
            factor = min(max(outcome.estimate.factor, least), SHRINKAGE if hard else control.growth)
        return min(control.largest, factor * size)

    def _shortened_in_vain(self, length: float, iterations: int) -> bool:
        """Whether a step is shorter than a hard one before it, and took more iterations for its length.

        Where forces jump, as at coils that slip and points that begin to flow, iterations hardly depend on the length.
        """
        last = self.position
        shorter = last.iterations >= HARD and length < last.before
        return shorter and iterations * last.before > last.iterations * length


def tolerates(share: float, size: float) -> bool:
    """Whether a step of a size is kept whose error is so much of what a step may have."""
    return share <= TOLERATED_SHARE or size <= FINEST
