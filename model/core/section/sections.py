"""What a kind of sections is to a rod."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Self

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.core.material.point.over_step import LawOverStep
from coilset.model.core.runtime.threads import Threads

TWIST, BEND = 3, 5  # φ′ and κ3 among the strains of a section


class Sections(ABC):
    """The sections of a rod's elements: stress, section forces and tangents at given section strains.

    Attributes:
        components: names of the columns of a point's state.
        passing: arrays of the trial state in which `update` may write one element after the other in the same place,
            of which each thread has one, so that an evaluation need not keep them.
        iterate: arrays of the trial state on which no section force depends: where an iteration of their own begins.
        radius: wire radius of each element, shape (cells,), mm; placement: Placement of the sections.
        threads: Threads that advance them.
        law_over_step: LawOverStep.
    """

    components: tuple[str, ...]
    passing: tuple[str, ...] = ()
    iterate: tuple[str, ...] = ()
    radius: np.ndarray
    placement: Placement
    threads: Threads
    law_over_step: LawOverStep

    @abstractmethod
    def part(self, cells: slice) -> Self:
        """Those of some elements."""

    @abstractmethod
    def initial_state(self) -> dict[str, np.ndarray]:
        """Arrays of the state at the start, by name, each of shape (cells, ...)."""

    @abstractmethod
    def update(
        self,
        strain: np.ndarray,
        start: Mapping[str, np.ndarray],
        trial: dict[str, np.ndarray],
        s: np.ndarray,
        D: np.ndarray,
        with_tangent: bool = True,
    ) -> bool:
        """Advance all sections to the end of an increment.

        Args:
            strain: ε, γ12, γ13, φ′, κ2, κ3 of the chords, shape (cells, sections, 6).
            start: state at the last equilibrium, with its `strain`; not changed.
            trial: state at the end of the increment; written.
            s: written, resultants about the chords, shape (cells, sections, 6), N and N mm.
            D: written, their derivatives by the strains, shape (cells, sections, 6, 6).
            with_tangent: whether D is needed.

        Returns:
            Whether the strains are finite and the law found a solution at all points.
        """

    @abstractmethod
    def update_surface(self, strain: np.ndarray, start: Mapping[str, np.ndarray], trial: dict[str, np.ndarray]) -> None:
        """Advance the points on the wire's surface, which carry no load, as `update` does the others."""
