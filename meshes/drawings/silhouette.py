"""Visible outlines of a spring seen from the side or from above, as lines: what a drawing and a DXF file show."""

import numpy as np

from coilset.meshes.springs.geometry import Spring

PER_TURN = 160
TINY = 0.02  # of the wire's radius: what a surface must be nearer to hide a point
BLOCK = 4096  # points whose visibility is found at once

Lines = list[np.ndarray]


def silhouette(spring: Spring, from_above: bool = False) -> Lines:
    """Visible parts of the wire's outlines, each of shape (n, 2), mm: x and z, seen along y, or x and y from above.

    A tube is the union of the spheres about its centre line, so that a point of an outline is hidden exactly where the
    front of one of them is nearer to the eye. A wire that is not round is drawn with its height. What grinding took
    away is left out, and the ground faces are lines, but not from above. Hooks and arms are part of the wire.
    """
    first, last = spring.corners[[0, -1]]
    t = np.linspace(first, last, int(PER_TURN * (last - first)) + 1)
    centre, radius = spring.centre_line(t), 0.5 * spring.wire_diameter(t)
    tangent = spring.tangent(t)
    if from_above:  # turned about x, so that the eye is at y = −∞
        centre, tangent = (points[:, [0, 2, 1]] * [1.0, -1.0, 1.0] for points in (centre, tangent))
    flat = tangent[:, [2, 0]] * [1.0, -1.0]  # ⟂ the tangent, in the plane of the drawing
    size = np.linalg.norm(flat, axis=1, keepdims=True)
    side = np.where(size > 1e-9, flat / np.maximum(size, 1e-300), [1.0, 0.0])
    edges = [centre + sign * radius[:, None] * np.insert(side, 1, 0.0, axis=1) for sign in (1.0, -1.0)]
    edges += [_face(centre[i], tangent[i], radius[i]) for i in (0, -1)]
    found: Lines = []
    for edge in edges:
        seen = _visible(edge, centre, radius)
        if not (from_above or spring.has_tails):
            seen &= (edge[:, 2] >= -TINY * radius[0]) & (edge[:, 2] <= spring.free_length + TINY * radius[0])
        found += _runs(edge[:, [0, 2]], seen)
    if from_above:
        return found
    return found + [face for end in ("bottom", "top") if (face := _ground(spring, end)) is not None]


def _face(centre: np.ndarray, tangent: np.ndarray, radius: float) -> np.ndarray:
    """The circle of a wire's cut end, shape (n, 3)."""
    first = np.cross(tangent, np.eye(3)[np.argmin(np.abs(tangent))])
    first /= np.linalg.norm(first)
    angle = np.linspace(0.0, 2 * np.pi, 49)[:, None]
    circle: np.ndarray = centre + radius * (np.cos(angle) * first + np.sin(angle) * np.cross(tangent, first))
    return circle


def _visible(points: np.ndarray, centre: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Which points no sphere about the centre line hides, seen from y = −∞; shape (points,)."""
    seen = np.empty(len(points), bool)
    for start in range(0, len(points), BLOCK):
        part = points[start : start + BLOCK]
        square = (part[:, None, 0] - centre[:, 0]) ** 2 + (part[:, None, 2] - centre[:, 2]) ** 2
        inside = radius**2 * (1.0 - TINY) - square
        front = centre[:, 1] - np.sqrt(np.maximum(inside, 0.0))
        hidden = (inside > 0.0) & (front < part[:, None, 1] - TINY * radius)
        seen[start : start + BLOCK] = ~hidden.any(axis=1)
    return seen


def _runs(points: np.ndarray, seen: np.ndarray) -> Lines:
    """Consecutive points that are seen."""
    cuts = np.flatnonzero(np.diff(seen.astype(int))) + 1
    parts = np.split(np.arange(len(points)), cuts)
    return [points[part] for part in parts if seen[part[0]] and len(part) > 1]


def _ground(spring: Spring, end: str) -> np.ndarray | None:
    """The line of a ground face; None of an end that is not ground."""
    turns = spring.flat_turns(end)
    if not turns:
        return None
    t = np.linspace(0.0, turns, 129)
    t = t if end == "bottom" else spring.turns - t
    half = np.sqrt(np.maximum((0.5 * spring.wire_diameter(t)) ** 2 - spring.seat_distance(t, end) ** 2, 0.0))
    r, cos, level = spring.mean_radius(t), np.cos(spring.angle(t)), 0.0 if end == "bottom" else spring.free_length
    x = np.concatenate([(r + half) * cos, (r - half) * cos])
    return np.array([[x.min(), level], [x.max(), level]])
