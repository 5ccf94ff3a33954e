"""The heights through which the common seats go, and the load program of each spring that follows from them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.phases import Phase, Target
from coilset.model.tools.nest.file import Press

SAME = 1e-9  # of the free length


@dataclass(frozen=True)
class Plan:
    """Heights of the common seats.

    Attributes:
        heights: after every step, mm, with the start.
        ends: number of the step at the end of each phase.
        block: height at which the first of the springs is at block, mm.
    """

    heights: np.ndarray
    ends: tuple[int, ...]
    block: float

    @property
    def free_length(self) -> float:
        """Height at which the seats touch the longer spring, mm."""
        return float(self.heights[0])

    def program(self, free_length: float) -> list[Phase]:
        """The load program of a spring of that free length; at the end it is released.

        Above its own free length the seats do not touch it: its program leaves these heights out.
        """
        heights, begin, phases = np.minimum(self.heights, free_length), 0, []
        for end in self.ends:
            way = heights[begin : end + 1]
            steps = way[np.concatenate([[True], np.abs(np.diff(way)) > SAME * free_length])]
            if len(steps) > 1:
                marks = (steps[1:] - steps[0]) / (steps[-1] - steps[0])
                to = Target(height=float(steps[-1]))
                phases.append(Phase(to=to, steps=[*marks[:-1].tolist(), 1.0]))
            begin = end
        if not phases:
            return []
        return [*phases, Phase(to=Target(force=0.0), steps=4)]


def plan(loading: Sequence[Press], springs: Sequence[Spring]) -> Plan:
    """The heights of a nest of these springs.

    Raises:
        InputError: for a height that the seats cannot have.
    """
    longest, block = max(one.free_length for one in springs), max(one.block_height for one in springs)
    heights, ends = [longest], []
    for number, press in enumerate(loading):
        to = block if press.to == "block" else press.to.height
        place = f"loading.{number}.to.height"
        if to < block * (1.0 - SAME):
            raise InputError(f"is {to:g} mm, below {block:.6g} mm, where the first of the springs is at block", place)
        if to > longest * (1.0 + SAME):
            raise InputError(f"is {to:g} mm, above the free length of the longer spring, {longest:.6g} mm", place)
        heights += np.linspace(heights[-1], to, press.steps + 1)[1:].tolist()
        ends.append(len(heights) - 1)
    return Plan(np.array(heights), tuple(ends), block)
