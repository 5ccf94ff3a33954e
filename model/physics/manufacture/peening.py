"""Shot peening as an eigenstrain: a layer at the surface of the wire that would be longer, if the core let it.

The eigenstrain ε*(depth) acts along the wire. In increments, the points' own length grows by it while the section's
strains balance all resultants to zero, so that layer and core share it. In a straight elastic bar

    σ(r) = −E (ε*(r) − ⟨ε*⟩),   ⟨ε*⟩ = 2/R² ∫ ε* r dr.

The hoop stress of a peened layer, about as large, is no stress of the fibres. For yield under the torsion of a spring
it makes no difference as long as both are equal: by von Mises σ and (σ, σ) count the same beside τ. The law follows the
eigenstrain; hardening of the layer by the shots is not included.
"""

from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.warning import Warning
from coilset.model.core.material.law.loop import AnyLaw
from coilset.model.core.section.rules import DiskRule
from coilset.model.physics.manufacture.wire import Wire

INCREMENTS = 20
RINGS = 3  # in a layer, below which its stress is badly resolved


@dataclass(frozen=True)
class Layer:
    """Eigenstrain over the depth below the surface, linear between points; depth in mm from 0, the last strain 0."""

    depth: np.ndarray
    strain: np.ndarray

    def at(self, depth: np.ndarray) -> np.ndarray:
        """ε* at depths in mm, of any shape."""
        return np.interp(depth, self.depth, self.strain)


def peen(
    law: AnyLaw,
    rule: DiskRule,
    radius: float,
    bend: float,
    curved: bool,
    states: np.ndarray,
    layer: Layer,
    surface: np.ndarray | None = None,
) -> np.ndarray:
    """States of a section's points after peening.

    Args:
        law: as `Wire` takes it, without time.
        rule: quadrature of the disk.
        radius: of the wire, mm.
        bend: curvature of its axis, 1/mm, and `curved` whether the fibres include it.
        states: before, of the rule's points and then those of the surface, shape (points, n_state), or one row for all.
        surface: points without weight, as in `Wire.of_disk`.

    Raises:
        SolveError: if the section finds no equilibrium.
    """
    wire = Wire.of_disk(law, rule, radius, curved, states, surface)
    grown = layer.at(radius * (1.0 - np.hypot(*wire.disk))) / INCREMENTS
    for _ in range(INCREMENTS):
        wire.grow(grown)
        wire.step(np.zeros(6), np.arange(6), np.zeros(6), bend)
    return wire.states


def peening_warnings(layer: Layer, rule: DiskRule, radius: float) -> list[Warning]:
    """Warning about a rule that has too few rings of points in the layer."""
    rings = np.unique(np.round(np.hypot(*rule.points.T), 9))
    inside = int(np.sum(rings > 1.0 - layer.depth[-1] / radius))
    if inside >= RINGS:
        return []
    message = (
        f"the peened layer of {layer.depth[-1]:g} mm holds {inside} of {len(rings)} rings of section points; more "
        "mesh.section.radial resolve it"
    )
    return [Warning("peened layer", "mesh.section.radial", message, inside, RINGS, "rings")]
