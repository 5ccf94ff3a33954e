"""Whether the mesh is fine enough for contact: how far the curve that it sees lies from the wire's axis."""

import numpy as np

from coilset.meshes.geometry import Spring
from coilset.model.contact.curve import CentreLine
from coilset.model.warning import Warning

USUAL = 0.02  # wire diameters: as deep as coils and seats are usually pressed into each other


def distance(spring: Spring, turns: np.ndarray) -> tuple[float, float]:
    """Greatest distance of contact's curve from the wire's axis across it, in wire diameters, and the turn there.

    Args:
        spring: Spring.
        turns: of the stations, shape (n,), n ≥ 2.
    """
    line = CentreLine(turns, 0.5 * spring.wire_diameter(turns), np.diff(spring.arc_length(turns)))
    points = line.points()
    away = points.at(spring.centre_line(turns)) - spring.centre_line(points.turns)
    along = spring.tangent(points.turns)
    across = np.linalg.norm(away - np.sum(away * along, axis=1, keepdims=True) * along, axis=1)
    part = across / spring.wire_diameter(points.turns)
    return float(part.max()), float(points.turns[part.argmax()])


def coarse_mesh_warnings(spring: Spring, turns: np.ndarray) -> list[Warning]:
    """A mesh on which contact is off by more than coils and seats are usually pressed into each other."""
    part, turn = distance(spring, turns)
    if part <= USUAL:
        return []
    message = (
        f"on this mesh the curve that contact sees is off the wire's axis by {100 * part:.2g} % of the wire's diameter "
        f"at turn {turn:.3g}, more than {100 * USUAL:g} %; more elements_per_turn make it less"
    )
    return [Warning("contact mesh", "mesh.elements_per_turn", message, part, USUAL, "wire diameters")]
