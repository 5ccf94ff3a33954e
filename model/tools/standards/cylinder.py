"""The cylindrical spring of constant wire diameter that EN 13906-1 covers, from a spring's geometry."""

from dataclasses import dataclass
from math import atan, pi
from typing import Literal

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.buckling import critical_travel
from coilset.model.tools.standards.rate import WireNumbers

CylinderEnds = Literal["open", "closed", "closed and ground", "mixed"]
SAME = 1e-9  # maximum relative change of coil and wire diameter along a cylinder, and of a constant pitch
PARTS = 400  # of the active turns of a variable pitch


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
        pitches: of the active turns at the middles of equal parts, if the pitch of the body varies; else empty.
        wire: numbers of a wire that is not round, whose height is d; None of round wire.
    """

    d: float
    D: float
    turns: float
    n: float
    length: float
    pitch: float
    ends: CylinderEnds
    solid: float
    pitches: tuple[float, ...] = ()
    wire: WireNumbers | None = None

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
            _pitches(spring),
            None if spring.section is None else WireNumbers.of(spring.section, float(np.mean(d)), float(np.mean(D))),
        )

    def series_force(self, travel: float, turn_rate: float) -> float:
        """Force at a travel of coils that close one by one, N: the s(F) = ∫ min(F/R₁, p − d) dt of docs/springs.md.

        Args:
            travel: from the free length, mm.
            turn_rate: R₁ = G d⁴/(8 D³), the rate of one turn, N/mm.

        Returns:
            The force at which s is the travel; that at which the last coil closes, if it is more than all coils have.
        """
        play = np.maximum(np.array(self.pitches) - self.d, 0.0)
        closing = turn_rate * np.sort(play)  # the forces at which the parts close
        part = self.n / len(play)
        at_closing = part * np.minimum(closing[:, None] / turn_rate, play).sum(axis=1)
        return float(np.interp(travel, np.append(0.0, at_closing), np.append(0.0, closing)))

    @property
    def index(self) -> float:
        """w = D/d."""
        return self.D / self.d

    @property
    def of_rate(self) -> float:
        """Diameter of the round wire whose formula gives its rate, mm."""
        return self.wire.of_rate if self.wire else self.d

    @property
    def of_stress(self) -> float:
        """Diameter of the round wire with the same stress by a torque, mm."""
        return self.wire.of_stress if self.wire else self.d

    @property
    def of_mass(self) -> float:
        """Diameter of the round wire of the same area, mm."""
        return self.wire.of_mass if self.wire else self.d

    @property
    def correction(self) -> float:
        """Greatest shear stress in the coil over the nominal one."""
        return self.wire.correction if self.wire else en13906.stress_correction(self.index)

    def buckling_travel(self, modulus_ratio: float, seating: float) -> float:
        """Travel at which it buckles, mm, with G/E and the coefficient ν of its ends; infinite if it never does."""
        bending, shear = self.wire.buckling_ratios(modulus_ratio) if self.wire else (modulus_ratio, None)
        return critical_travel(self.length, self.D, bending, seating, shear)

    @property
    def pitch_angle(self) -> float:
        """α of the active turns, rad."""
        return atan(self.pitch / (pi * self.D))


def _pitches(spring: Spring) -> tuple[float, ...]:
    """Pitches of the active turns, mm; empty if that of the body between the transitions is constant."""
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    body = np.linspace(start + spring.bottom.transition_turns, end - spring.top.transition_turns, PARTS)
    pitch = spring.pitch(body)
    if np.ptp(pitch) <= SAME * pitch.max():
        return ()
    middles = start + (end - start) * (np.arange(PARTS) + 0.5) / PARTS
    return tuple(spring.pitch(middles).tolist())
