"""Whether the mesh is fine enough for contact: the distance of the contact curve from the wire's axis."""

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.warning import Warning
from coilset.model.core.contact.curve import CentreLine

USUAL = 0.02  # wire diameters: usual penetration of coils and seats


def distance(spring: Spring, turns: np.ndarray) -> tuple[float, float]:
    """Maximum transverse distance of the contact curve from the wire's axis, in wire diameters, and the turn there.

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
    """Warning about a mesh whose contact curve deviates by more than the usual penetration."""
    part, turn = distance(spring, turns)
    if part <= USUAL:
        return []
    message = (
        f"on this mesh the contact curve deviates from the wire's axis by {100 * part:.2g} % of the wire's diameter "
        f"at turn {turn:.3g}, more than {100 * USUAL:g} %; more elements_per_turn make it less"
    )
    return [Warning("contact mesh", "mesh.elements_per_turn", message, part, USUAL, "wire diameters")]
