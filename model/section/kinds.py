"""The kinds of sections: how a wire's cross-section deforms, and whether it includes the wire's curvature.

- plane: the thesis's; it stays plane and neglects the curvature,
- curved: it has the fibre lengths of the curved wire, and warps under its transverse force,
- warping: it warps freely with the curved and twisted wire, and has all six stresses.
"""

from collections.abc import Callable
from typing import Any, Protocol, Self

import numpy as np

from coilset.meshes.springs.placement import Placement
from coilset.model.material.creep.in_time import LawOverTime
from coilset.model.material.law.law import Law
from coilset.model.runtime.threads import Threads
from coilset.model.section.fibres import FibreSections
from coilset.model.section.rules import DiskRule
from coilset.model.section.warping import WarpingSections

KINDS = ("plane", "curved", "warping")


class Sections(Protocol):
    """Interface of sections for the rod; `FibreSections` documents the methods.

    Attributes:
        radius, placement: of the cells.
        law_over_time: the law of their points.
        passing: arrays of the trial state in which `update` may write one element after the other in the same place,
            of which each thread has one.
        threads: Threads that advance them.
    """

    radius: np.ndarray
    placement: Placement
    law_over_time: LawOverTime
    passing: tuple[str, ...]
    threads: Threads

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the columns of a point's state."""
        ...

    def part(self, cells: slice) -> Self:
        """The sections of some of the cells."""
        ...

    @property
    def initial_state(self) -> Callable[[], dict[str, np.ndarray]]:
        """The arrays of unstressed sections."""
        ...

    @property
    def update(self) -> Callable[..., Any]:
        """Advance all sections to the end of an increment."""
        ...

    @property
    def update_surface(self) -> Callable[..., None]:
        """Advance the points on the surface to the end of an increment."""
        ...


def make_sections(
    kind: str,
    law: Law,
    parameters: np.ndarray,
    rule: DiskRule,
    radius: np.ndarray,
    placement: Placement,
    temperature: float | None = None,
    degree: int = 3,
    threads: Threads | None = None,
) -> Sections:
    """The sections of a kind; arguments as in `FibreSections` and, for the degree, `WarpingSections`.

    Raises:
        ValueError: if there is no such kind.
    """
    if kind not in KINDS:
        raise ValueError(f"kind '{kind}' is none of {', '.join(KINDS)}")
    if kind == "warping":
        return WarpingSections(law, parameters, rule, radius, placement, temperature, degree, threads)
    return FibreSections(law, parameters, rule, radius, placement, kind == "curved", temperature, threads)
