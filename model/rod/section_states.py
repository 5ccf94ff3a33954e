"""The states of a rod's section points: what evaluations write of them, and what follows when a step ends.

The points on the surface carry no load: they lie in place and follow when a step ends. In a long rod all points do.
Their states on trial would fill as much memory as those at the last equilibrium, and each evaluation would write all of
it. So an evaluation keeps one element's at a time, and a step's end finds them once more.
"""

from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple

import numpy as np

from coilset.model.material.creep_law import CreepLaw
from coilset.model.material.rate_law import RateLaw
from coilset.model.rod.finer_path import CLOCKS, in_blocks, of_cells
from coilset.model.section.kinds import Sections
from coilset.model.state import Field, State, Where
from coilset.model.threads import Threads

POINTS, SURFACE = "point_state", "surface_state"
KEPT = 4096  # elements up to which all points' states on trial are kept: as many as a processor's caches may hold
LEAST = 4096  # points of a thread: they take the law 0.3 ms, and some 0.1 ms pass until another thread is at work


class Share(NamedTuple):
    """What one thread advances: some of the cells, their sections, and their part of the sections' arrays."""

    cells: slice
    sections: Sections
    strain: np.ndarray
    start: Mapping[str, np.ndarray]
    trial: dict[str, np.ndarray]

    def update(self, s: np.ndarray, D: np.ndarray) -> bool:
        """Advance them, and write their part of the section forces and tangents of all cells."""
        update = self.sections.update
        return bool(update(self.strain, self.start, self.trial, s[self.cells], D[self.cells]))


class SectionStates:
    """The sections' arrays in the state of a rod.

    Args:
        sections: of the rod.
        state: State, to which they are added.
        strain: its field of section strains.
        in_time: the law in time, which has clocks; None without.
        temperature: of the clocks at the start, K.
        threads: Threads that advance them.

    Attributes:
        shares: the cells that each of the threads takes.
    """

    def __init__(
        self,
        sections: Sections,
        state: State,
        strain: Field,
        in_time: CreepLaw | RateLaw | None,
        temperature: float,
        threads: Threads,
    ) -> None:
        self._threads, self._strain, cells = threads, strain, len(sections.radius)
        passing = sections.passing if cells > KEPT else ()
        self._in_place = (*passing, SURFACE)
        self._fields = {name: state.add(name, rows, Where.ELEMENT, in_place=name in self._in_place)
                        for name, rows in sections.initial_state().items()}  # fmt: skip
        self._start = {name: field.equilibrium for name, field in self._fields.items()}
        self._trial = {name: field.trial for name, field in self._fields.items()}
        self._start["strain"] = strain.equilibrium
        if in_time is not None:
            for name in CLOCKS:
                clock = state.add(name, in_time.clock(0.0, temperature), Where.SHARED)
                self._start[name], self._trial[name] = clock.equilibrium, clock.trial
        points = 2 * self._fields[POINTS].trial.shape[2]
        self.shares = threads.shares(cells, -(-LEAST // points))
        self._of_threads = [self._share(cells, sections.part(cells), passing) for cells in self.shares]
        self._blocks = [list(in_blocks(sections, share)) for share in self.shares]

    def _share(self, cells: slice, sections: Sections, passing: Collection[str]) -> Share:
        start, trial = of_cells(self._start, cells), of_cells(self._trial, cells)
        trial |= {name: np.empty_like(trial[name][:1]) for name in passing}
        return Share(cells, sections, self._strain.trial[cells], start, trial)

    @property
    def bearing(self) -> list[str]:
        """Names of the arrays on which the section forces depend."""
        return [name for name in self._fields if name != SURFACE]

    def __getitem__(self, name: str) -> np.ndarray:
        """An array on trial, or, where it lies in place, at the last equilibrium."""
        return self._fields[name].trial

    def update(self, s: np.ndarray, D: np.ndarray) -> bool:
        """Advance all sections to the trial strains; `s`, `D` and what it returns are those of `Sections.update`."""
        return all(self._threads.map(lambda share: share.update(s, D), self._of_threads))

    def follow(self) -> None:
        """Bring what lies in place to the end of the step."""
        self._threads.map(self._follow, self._blocks)

    def _follow(self, blocks: Iterable[tuple[slice, Sections]]) -> None:
        for cells, sections in blocks:
            start, reached = of_cells(self._start, cells), of_cells(self._trial, cells)
            reached |= {name: np.empty_like(start[name]) for name in self._in_place}
            strain, size = self._strain.trial[cells], cells.stop - cells.start
            if POINTS in self._in_place:
                sections.update(strain, start, reached, np.empty((size, 2, 6)), np.empty((size, 2, 6, 6)), False)
            sections.update_surface(strain, start, reached)
            for name in self._in_place:
                start[name][:] = reached[name]
