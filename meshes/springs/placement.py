"""Placement of straight rods and their Gauss points so that they represent the curved wire between the nodes."""

from typing import NamedTuple

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError

STRAIGHT = 1e-9  # curvature, 1/mm, below which a section has no normal


def gauss_points(
    spring: Spring, start: np.ndarray, end: np.ndarray, abscissae: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss points on the true centre line between pairs of nodes.

    The abscissa is the fraction of the turns from one node to the other, not of the chord: functions of the turn are
    smooth, so that two Gauss points integrate along the wire with an error of fourth order in the element length.

    Args:
        spring: `Spring`.
        start: turns of the first nodes, shape (elements,).
        end: turns of the second nodes, shape (elements,).
        abscissae: ξ from 0 to 1, shape (points,).

    Returns:
        Positions in mm and unit tangents, shape (elements, points, 3), and ds/dξ in mm, shape (elements, points): the
        integral over an element is the sum of weight · ds/dξ · integrand, with weights whose sum is 1.
    """
    start, end = np.asarray(start)[:, None], np.asarray(end)[:, None]
    turn = start + (end - start) * np.asarray(abscissae)
    return spring.centre_line(turn), spring.tangent(turn), spring.speed(turn) * (end - start)


class Placement(NamedTuple):
    """Positions of the true sections of a curved wire relative to the chords, and the wire's curvature there.

    Attributes:
        matrices: from the chord's strains (ε, γ12, γ13, φ′, κ2, κ3) to the section's, shape (n, g, 6, 6).
        stretch: ds/dx, length of wire over length of chord, shape (n, g).
        curvature: κ of the wire, 1/mm, towards the section's y axis, shape (n, g); 0 for sections that ignore it.
        torsion: τ of the wire, 1/mm, shape (n, g).
        flat: the plane to which an end is ground, as each section sees it, shape (n, g, 3): its distance from the
            wire's axis in wire radii, negative if the axis itself is cut away and infinite where nothing is, and its
            unit normal (y, z) into the wire.
    """

    matrices: np.ndarray
    stretch: np.ndarray
    curvature: np.ndarray
    torsion: np.ndarray
    flat: np.ndarray

    @property
    def is_cut(self) -> bool:
        """Whether the plane of a ground end crosses a section of round wire."""
        return bool((self.flat[..., 0] < 1.0).any())

    def part(self, elements: slice | np.ndarray) -> "Placement":
        """Of some of the elements, or of all in another order; of neighbours in their order it is a view."""
        if not isinstance(elements, slice) and len(elements):
            first, last = int(elements[0]), int(elements[-1])
            elements = slice(first, last + 1) if np.array_equal(elements, np.arange(first, last + 1)) else elements
        return Placement(*(np.ascontiguousarray(values[elements]) for values in self))


def straight(elements: int, sections: int = 2) -> Placement:
    """The placement of so many sections on each of some straight rods."""
    zero = np.zeros((elements, sections))
    same = np.tile(np.eye(6), (elements, sections, 1, 1))
    return Placement(same, np.ones_like(zero), zero, zero.copy(), round_wire(zero))


def round_wire(like: np.ndarray) -> np.ndarray:
    """`Placement.flat` of sections that no grinding has touched, for an array with one entry a section."""
    return np.stack([np.full(like.shape, np.inf), np.zeros(like.shape), np.zeros(like.shape)], axis=-1)


def section_placement(
    spring: Spring, turns: np.ndarray, triads: np.ndarray, abscissae: np.ndarray, curved: bool = False
) -> Placement:
    """How the sections of the curved wire depend on the chords between the nodes.

    A section of the true centre line is rigidly tied to the section of the chord at the same ξ, by the offset o. With
    the chord's strains Γ = (ε, γ12, γ13) and K = (φ′, κ2, κ3) and the triad Q of the true section in the chord's
    frame, its strains per length of wire are

        Γ_true = Qᵀ (Γ + K × o) dx/ds,    K_true = Qᵀ K dx/ds,

    so that a rigid motion causes no strain, whatever o and Q are. Q is the smallest rotation that takes the chord's
    axis to the true tangent t; for a curved wire it is followed by the rotation about t that takes the section's
    y axis to the normal n, the direction of the centre of curvature. A straight wire has no normal and needs none.

    Args:
        spring: `Spring`.
        turns: increasing turns of the nodes, shape (n + 1,); the nodes are on the centre line.
        triads: the chords' triads, columns, shape (n, 3, 3).
        abscissae: ξ of the Gauss sections, from 0 to 1, shape (g,).
        curved: whether the sections account for the wire's curvature and torsion, with y along the normal.

    Returns:
        Placement.
    """
    position, tangent, length = gauss_points(spring, turns[:-1], turns[1:], abscissae)
    nodes = spring.centre_line(turns)
    chord = np.diff(nodes, axis=0)
    stretch = length / np.linalg.norm(chord, axis=1)[:, None]
    on_chord = nodes[:-1, None] + chord[:, None] * np.asarray(abscissae)[:, None]
    offset = np.einsum("nki,ngk->ngi", triads, position - on_chord)
    Q = _least_turn(np.einsum("nki,ngk->ngi", triads, tangent))
    curvature, torsion = np.zeros_like(stretch), np.zeros_like(stretch)
    turn = turns[:-1, None] + np.diff(turns)[:, None] * np.asarray(abscissae)
    if curved:
        normal = np.einsum("ngik,nji,ngj->ngk", Q, triads, spring.curvature_vector(turn))[..., 1:]
        curvature, torsion = np.linalg.norm(normal, axis=-1), spring.torsion(turn)
        Q = Q @ _to_normal(normal, curvature)

    o = np.moveaxis(offset, -1, 0)
    zero = np.zeros_like(o[0])
    K_cross_o = np.moveaxis(np.array([[zero, o[2], -o[1]], [-o[2], zero, o[0]], [o[1], -o[0], zero]]), (0, 1), (-2, -1))
    P = np.zeros((*stretch.shape, 6, 6))
    P[..., :3, :3] = P[..., 3:, 3:] = np.swapaxes(Q, -1, -2)
    P[..., :3, 3:] = np.swapaxes(Q, -1, -2) @ K_cross_o
    flat = _flats(spring, turn, np.einsum("nki,ngij->ngkj", triads, Q)[..., 2, 1:])
    return Placement(P / stretch[..., None, None], stretch, curvature, torsion, flat)


def chord_placement(spring: Spring, turns: np.ndarray, triads: np.ndarray, abscissae: np.ndarray) -> Placement:
    """The placement of sections on the chords themselves, cut as the true sections are; arguments as above."""
    return straight(len(triads), len(abscissae))._replace(flat=section_placement(spring, turns, triads, abscissae).flat)


def _flats(spring: Spring, turn: np.ndarray, upwards: np.ndarray) -> np.ndarray:
    """`Placement.flat` of sections whose axes y and z rise by `upwards` along the spring's axis, shape (n, g, 2)."""
    steepness = np.linalg.norm(upwards, axis=-1)
    normal, found = upwards / steepness[..., None], round_wire(turn)
    for end, side in (("bottom", 1.0), ("top", -1.0)):
        if getattr(spring, end).tip_thickness < 1.0:
            away = 2.0 * spring.seat_level_distance(turn, end) / spring.wire_diameter(turn) / steepness
            cut = away < np.minimum(found[..., 0], 1.0)
            found[cut] = np.concatenate([away[..., None], side * normal], axis=-1)[cut]
    return found


def refuse_sharp_bends(placement: Placement, radius: np.ndarray, turns: np.ndarray) -> None:
    """Reject a wire bent to a radius below its own: no length is left at the inside, where 1 − κ y is negative.

    Args:
        placement: of the sections.
        radius: wire radius of each element, mm, shape (n,).
        turns: of the nodes, shape (n + 1,).

    Raises:
        InputError: if there is such a place.
    """
    bent = placement.curvature * radius[:, None]
    if bent.size and bent.max() >= 1.0:
        i, g = np.unravel_index(np.argmax(bent), bent.shape)
        raise InputError(
            f"the wire of radius {radius[i]:.4g} mm is bent to a radius of {1 / placement.curvature[i, g]:.4g} mm near "
            f"turn {turns[i]:.4g}; give smoother points, their noise (spring.noise), or mesh.section.kind: plane",
            "spring",
        )


def _least_turn(t: np.ndarray) -> np.ndarray:
    """The smallest rotation that takes the first axis to the unit vectors `t`, shape (..., 3) → (..., 3, 3)."""
    Q = np.zeros((*t.shape, 3))
    Q[..., :, 0] = t
    Q[..., 0, 1:] = -t[..., 1:]
    Q[..., 1:, 1:] = np.eye(2) - t[..., 1:, None] * t[..., None, 1:] / (1 + t[..., 0])[..., None, None]
    return Q


def _to_normal(normal: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """The rotation about the first axis that takes the second to κ n = `normal`, shape (..., 2) → (..., 3, 3)."""
    straight = curvature < STRAIGHT
    cos, sin = np.moveaxis(normal, -1, 0) / np.where(straight, np.inf, curvature)
    cos = np.where(straight, 1.0, cos)
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    return np.moveaxis(np.array([[one, zero, zero], [zero, cos, -sin], [zero, sin, cos]]), (0, 1), (-2, -1))
