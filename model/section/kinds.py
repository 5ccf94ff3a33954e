"""The kinds of sections: what a wire's cross-section may do, and what it knows of the wire's curvature.

- plane: the thesis's; it stays plane and knows nothing of the curvature,
- curved: its fibres are as long as the curved wire makes them, and it warps as its transverse force asks,
- warping: it warps as the curved and twisted wire asks, and bears all six stresses.
"""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from coilset.meshes.placement import Placement
from coilset.model.material.law import Law
from coilset.model.section.curved import CurvedSections
from coilset.model.section.plane import PlaneSections
from coilset.model.section.rules import DiskRule
from coilset.model.section.warping import WarpingSections

KINDS = ("plane", "curved", "warping")


class Sections(Protocol):
    """What the rod asks of its sections; `PlaneSections` says what the methods do."""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the columns of a point's state."""
        ...

    @property
    def initial_state(self) -> Callable[[], dict[str, np.ndarray]]:
        """The arrays of unstressed sections."""
        ...

    @property
    def update(self) -> Callable[..., Any]:
        """Bring all sections to the end of an increment."""
        ...

    @property
    def update_surface(self) -> Callable[..., None]:
        """Bring the points on the surface to the end of an increment."""
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
) -> Sections:
    """The sections of a kind; arguments as in `PlaneSections` and, for the degree, `WarpingSections`.

    Raises:
        ValueError: if there is no such kind.
    """
    if kind not in KINDS:
        raise ValueError(f"kind '{kind}' is none of {', '.join(KINDS)}")
    if kind == "warping":
        return WarpingSections(law, parameters, rule, radius, placement, temperature, degree)
    sections = CurvedSections if kind == "curved" else PlaneSections
    return sections(law, parameters, rule, radius, placement, temperature)
