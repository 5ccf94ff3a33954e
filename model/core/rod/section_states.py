"""The states of a rod's section points: what evaluations write of them, and what follows when a step ends.

The points on the surface carry no load: they lie in place and follow when a step ends. In a long rod all points do.
Their trial states would fill as much memory as those at the last equilibrium, and each evaluation would write all of
it. So an evaluation keeps one element's at a time, and a step's end finds them once more.
"""

import copy
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from coilset.model.core.body.state import Field, State, Where
from coilset.model.core.rod.assembly import blocks
from coilset.model.core.section.sections import Sections

POINTS, SURFACE = "point_state", "surface_state"
BLOCK = 256  # cells that are followed together: only for these the state on the way is kept
CLOCKS = "clock", "halfway_clock"  # of the whole rod, at the end of a step, and half way along its path
KEPT = 4096  # elements up to which all points' trial states are kept: as many as a processor's caches may hold


class SectionStates:
    """The sections' arrays in the state of a rod.

    Args:
        sections: of the rod.
        state: State, to which they are added.
        strain: its field of section strains.
        in_time: the law in time, which has clocks; None without.
        temperature: of the clocks at the start, K.
    """

    def __init__(self, sections: Sections, state: State, strain: Field, in_time: Any, temperature: float) -> None:
        self._sections, self._strain, cells = sections, strain, len(sections.radius)
        passing = sections.passing if cells > KEPT else ()
        self._in_place = (*passing, SURFACE)
        self._fields = {
            name: state.add(name, rows, Where.ELEMENT, in_place=name in self._in_place)
            for name, rows in sections.initial_state().items()
        }
        self._start = {name: field.equilibrium for name, field in self._fields.items()}
        self._trial = {name: field.trial for name, field in self._fields.items()}
        self._start["strain"] = strain.equilibrium
        if in_time is not None:
            for name in CLOCKS:
                clock = state.add(name, in_time.clock(0.0, temperature), Where.SHARED)
                self._start[name], self._trial[name] = clock.equilibrium, clock.trial
        # of what passes, each thread keeps an element's
        self._on_the_way = self._trial | {
            name: np.empty((sections.threads.number, *self._trial[name].shape[1:])) for name in passing
        }
        self._blocks = list(in_blocks(sections))

    @property
    def bearing(self) -> list[str]:
        """Names of the arrays on which the section forces depend."""
        return [name for name in self._fields if name not in (SURFACE, *self._sections.iterate)]

    def __getitem__(self, name: str) -> np.ndarray:
        """A trial array, or, where it lies in place, at the last equilibrium."""
        return self._fields[name].trial

    def update(self, s: np.ndarray, D: np.ndarray) -> bool:
        """Advance all sections to the trial strains; `s`, `D` and what it returns are those of `Sections.update`."""
        return bool(self._sections.update(self._strain.trial, self._start, self._on_the_way, s, D))

    def hold_onset(self, D: np.ndarray) -> bool:
        """Write the section tangents at the trial strains of a law that holds where κ sets in; as `Sections.update`."""
        sections, strain = copy.copy(self._sections), self._strain.trial
        sections.law_over_step = sections.law_over_step.held()
        end = {name: values.copy() for name, values in self._on_the_way.items() if name not in sections.iterate}
        return bool(sections.update(strain, self._start, end, np.empty(strain.shape), D))

    def follow(self) -> None:
        """Bring what lies in place to the end of the step."""
        for cells, sections in self._blocks:
            start, reached = of_cells(self._start, cells), of_cells(self._trial, cells)
            reached |= {name: np.empty_like(start[name]) for name in self._in_place}
            strain = self._strain.trial[cells]
            if POINTS in self._in_place:
                s, D = np.empty(strain.shape), np.empty((*strain.shape, 6))
                sections.update(strain, start, reached, s, D, False)
            sections.update_surface(strain, start, reached)
            for name in self._in_place:
                start[name][:] = reached[name]


def in_blocks(sections: Sections) -> Iterator[tuple[slice, Sections]]:
    """Cells that are followed together, and their sections."""
    for part in blocks(slice(0, len(sections.radius)), BLOCK):
        yield part, sections.part(part)


def of_cells(arrays: Mapping[str, np.ndarray], cells: slice) -> dict[str, np.ndarray]:
    """The cells' part of the sections' arrays, with the rod's clocks."""
    return {name: values if name in CLOCKS else values[cells] for name, values in arrays.items()}
