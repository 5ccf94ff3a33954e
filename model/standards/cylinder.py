"""The cylindrical spring of constant wire diameter that EN 13906-1 covers, from a spring's geometry."""

from dataclasses import dataclass
from math import atan, pi
from typing import Literal

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.base.errors import InputError

CylinderEnds = Literal["open", "closed", "closed and ground", "mixed"]
SAME = 1e-9  # maximum relative change of coil and wire diameter along a cylinder


@dataclass(frozen=True)
class Cylinder:
    """A cylindrical compression spring; lengths in mm.

    Attributes:
        d: wire diameter.
        D: mean coil diameter.
        turns: all turns n_t.
        n: active turns.
        length: free length L0.
        pitch: mean rise of an active turn.
        ends: form of both ends; `mixed` if they differ.
        solid: block length of the geometry, with every coil touching the next.
    """

    d: float
    D: float
    turns: float
    n: float
    length: float
    pitch: float
    ends: CylinderEnds
    solid: float

    @classmethod
    def of(cls, spring: Spring) -> "Cylinder":
        """The cylinder equivalent to a spring's geometry.

        Raises:
            InputError: if its coil or wire diameter changes.
        """
        t = spring.breaks
        d, D = spring.wire_diameter(t), 2 * spring.mean_radius(t)
        for values, name, place in ((D, "mean diameter", "mean_diameter"), (d, "wire diameter", "wire_diameter")):
            low, high = float(values.min()), float(values.max())
            if high - low > SAME * high:
                raise InputError(
                    f"EN 13906-1 is for cylinders of one wire; the {name} goes from {low:.4g} to {high:.4g} mm",
                    f"spring.{place}",
                )
        start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
        pitch = float(spring.height(end) - spring.height(start)) / spring.active_turns
        ends: CylinderEnds = spring.bottom.form if spring.bottom.form == spring.top.form else "mixed"
        return cls(
            float(np.mean(d)),
            float(np.mean(D)),
            spring.turns,
            spring.active_turns,
            spring.free_length,
            pitch,
            ends,
            spring.block_height,
        )

    @property
    def index(self) -> float:
        """w = D/d."""
        return self.D / self.d

    @property
    def pitch_angle(self) -> float:
        """α of the active turns, rad."""
        return atan(self.pitch / (pi * self.D))
