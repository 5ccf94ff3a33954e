"""What a spring tester reads of one spring, from its unset state on."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.columns import Columns, read_columns
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import Case
from coilset.model.core.case.targets import check_pressed, lowest_height
from coilset.model.physics.manufacture.entries import Relief

WANTED = "travel and force, or height and force, or height and free_length"
UNITS_OF = {"travel": "mm", "height": "mm", "free_length": "mm", "force": "N"}
BACK = 0.02  # of the maximum travel: a return by less is scatter
RELEASED = 0.03  # of the maximum force, below which a spring counts as released
FEWEST = 8  # readings of a curve


@dataclass(frozen=True, eq=False)
class Pressing:
    """Readings of one spring that is pressed and released, once or several times.

    Attributes:
        name: of the file, for figures and messages.
        case: the spring and how it stands; its load program is not used.
        travel, force: readings, shape (n,), mm and N. Of free lengths: the travel at which the spring is free, and 0.
        branch: number of the branch of each reading, shape (n,); the even ones press, the odd ones release.
        ends: travel at which each branch ends, mm; None: it is released.
        lengths: whether free lengths were measured instead of forces.
    """

    name: str
    case: Case
    travel: np.ndarray
    force: np.ndarray
    branch: np.ndarray
    ends: tuple[float | None, ...]
    lengths: bool = False

    @cached_property
    def spring(self) -> Spring:
        """Its geometry."""
        return self.case.spring.build()

    @property
    def coiled(self) -> bool:
        """Whether its wire was bent to the coil, and flowed, before it is pressed."""
        return "made_by" in self.case.past

    @property
    def relief(self) -> Relief | None:
        """How it was stress-relieved after that, if it was."""
        return getattr(self.case.spring, "relieved", None)

    @property
    def presses(self) -> list[int]:
        """Numbers of the branches that press."""
        return list(range(0, len(self.ends), 2))

    @property
    def furthest(self) -> float:
        """Travel to block, mm."""
        return self.spring.free_length - lowest_height(self.case, self.spring)


def read_pressing(path: str | Path, case: Case) -> Pressing:
    """Read a tester's file.

    Columns `travel` (mm) and `force` (N) in the order of the readings, or `height` (mm) in place of `travel`; or
    `height` and `free_length` (mm), one row for each press: how far it was pressed, and its length afterwards.
    Headings may name another unit, as `force [kgf]`.

    Args:
        path: CSV file.
        case: of the spring.

    Raises:
        InputError: if the file cannot be read, a column or number is missing or wrong, or it shows no press.
    """
    table = read_columns(path).named(UNITS_OF)
    spring = case.spring.build()
    check_pressed(spring)
    length = spring.free_length
    if "free_length" in table.names:
        return _of_lengths(table, case, length)
    way = next((name for name in ("travel", "height") if name in table.names), None)
    if way is None or "force" not in table.names:
        raise table.lacks("force" if way else "travel", WANTED)
    travel, force = table.numbers(way), table.numbers("force")
    if len(travel) < FEWEST:
        raise InputError(f"has {len(travel)} readings; {FEWEST} are needed at least", "", path)
    travel = length - travel if way == "height" else travel
    if force.max() <= 0.0 or travel.max() <= 0.0:
        raise InputError("shows no press; compression and its travel are positive", "", path)
    if travel.max() >= length:
        raise InputError(f"goes to a travel of {travel.max():g} mm, but the spring is {length:.5g} mm long", way, path)
    turns = [*_turns(travel, BACK * float(np.ptp(travel))), len(travel) - 1]
    branch = np.zeros(len(travel), int)
    for turn in turns[:-1]:
        branch[turn + 1 :] += 1
    released = RELEASED * float(force.max())
    ends = tuple(None if k % 2 and abs(force[turn]) < released else float(travel[turn]) for k, turn in enumerate(turns))
    return Pressing(table.path.stem, case, travel, force, branch, ends)


def _of_lengths(table: Columns, case: Case, length: float) -> Pressing:
    if "height" not in table.names:
        raise table.lacks("height", WANTED)
    heights, after = table.numbers("height"), table.numbers("free_length")
    for name, values in (("height", heights), ("free_length", after)):
        wrong = (values <= 0.0) | (values > 1.1 * length)
        if wrong.any() or not len(values):
            line = table.rows[int(np.argmax(wrong))][0] if len(values) else table.head
            problem = f"must lie between 0 and the spring's free length of {length:.5g} mm"
            raise InputError(problem, f"line {line}, column {name}", table.path)
    ends = tuple(end for height in heights.tolist() for end in (length - height, None))
    branch = 2 * np.arange(len(heights)) + 1
    return Pressing(table.path.stem, case, length - after, np.zeros(len(after)), branch, ends, True)


def _turns(travel: np.ndarray, back: float) -> Sequence[int]:
    """Readings at which the travel turns by more than `back`, first from compression to release."""
    turns, sign, at = [], 1.0, 0
    for k, value in enumerate(travel):
        if sign * (value - travel[at]) > 0.0:
            at = k
        elif sign * (travel[at] - value) > back:
            turns.append(at)
            sign, at = -sign, k
    return turns
