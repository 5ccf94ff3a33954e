"""The wire of a spring as one solid body in a STEP file: B-spline surfaces along its centre line, ground ends cut.

Rings of control points about the centre line are the section's outline, an exact circle of round wire; cubic splines
through the rings run along the wire. OpenCASCADE, through gmsh, joins the surfaces to a body and cuts it at the seats.
"""

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import gmsh
import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline, make_interp_spline

from coilset.meshes.sections.boundary import Boundary
from coilset.meshes.springs.functions import gauss
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import CoilsetError

RINGS = 32  # a turn; a helix of radius R is met within R (2π/32)⁴/384 = 4e-6 R
PATCH = 16  # rings along a surface; OpenCASCADE integrates the volume of longer ones too coarsely (0.1 %)
ACROSS = 9  # points on a quarter of a turn of an outline
ALONG = 4  # Gauss's points between two rings, for the volume
WRONG = 1e-3  # deviation of a body's volume that is an error


class Strip(NamedTuple):
    """A piece of an outline as a B-spline: control points, shape (n, 2), weights, degree, knots, multiplicities."""

    points: np.ndarray
    weights: np.ndarray
    degree: int
    knots: np.ndarray
    multiplicities: np.ndarray

    def curve(self, points: np.ndarray) -> int:
        """The curve of control points in space, shape (n, 3), for gmsh."""
        tags = [gmsh.model.occ.addPoint(*point) for point in points]
        return gmsh.model.occ.addBSpline(
            tags, degree=self.degree, weights=self.weights, knots=self.knots, multiplicities=self.multiplicities
        )

    def surface(self, t: np.ndarray, rings: np.ndarray, ends: np.ndarray) -> int:
        """The surface through rings of control points, shape (m, n, 3), at t, with its slopes at both ends."""
        along = make_interp_spline(t, rings, k=3, bc_type=([(1, ends[0])], [(1, ends[1])]))
        tags = [gmsh.model.occ.addPoint(*point) for ring in along.c for point in ring]
        knots, multiplicities = np.unique(along.t, return_counts=True)
        return gmsh.model.occ.addBSplineSurface(
            tags,
            len(self.points),
            degreeU=self.degree,
            degreeV=3,
            weights=np.tile(self.weights, len(along.c)),
            knotsU=self.knots,
            knotsV=knots,
            multiplicitiesU=self.multiplicities,
            multiplicitiesV=multiplicities,
        )


class Frames(NamedTuple):
    """Sections of the wire: turns, (n,), centres, axes y and z, (n, 3), and half the wire's height, (n,)."""

    turn: np.ndarray
    centre: np.ndarray
    y: np.ndarray
    z: np.ndarray
    half: np.ndarray

    def rings(self, points: np.ndarray) -> np.ndarray:
        """Points of the section, in half its height, in space, shape (n, points, 3)."""
        size = self.half[:, None, None]
        ring: np.ndarray = size * (points[:, :1] * self.y[:, None] + points[:, 1:] * self.z[:, None])
        return self.centre[:, None] + ring


def step(spring: Spring) -> tuple[bytes, float]:
    """A spring as a solid body, mm: the content of the file, and the volume of the body in it, opened again, mm³.

    Raises:
        CoilsetError: if OpenCASCADE makes another body than the wire: its volume deviates by more than WRONG.
    """
    exact = wire_volume(spring)
    gmsh.initialize(["coilset", "-v", "0"], readConfigFiles=False, interruptible=False)
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "spring.step"
            gmsh.model.add("spring")
            _body(spring)
            with _silent():
                gmsh.write(str(path))
            gmsh.model.add("opened again")
            bodies = gmsh.model.occ.importShapes(str(path))
            volume = sum(gmsh.model.occ.getMass(*body) for body in bodies)
            content = path.read_bytes()
    except Exception as error:
        if type(error) is not Exception:  # that of gmsh
            raise
        raise CoilsetError(f"OpenCASCADE makes no body of this spring: {error}") from None
    finally:
        gmsh.finalize()
    if not abs(volume / exact - 1.0) <= WRONG:
        raise CoilsetError(f"OpenCASCADE makes a body of {volume:.6g} mm³; the wire has {exact:.6g}")
    return content, volume


@contextmanager
def _silent() -> Iterator[None]:
    """Without the standard output of OpenCASCADE, which prints statistics whatever gmsh's options are."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def wire_volume(spring: Spring) -> float:
    """Volume of the wire without what grinding took, ∫∫ (1 − κ·x) dA ds, x from the centre line, mm³."""
    total, (x, w) = 0.0, gauss(ALONG)
    outline = spring.section or circle()
    solid = outline.hole**2, outline.hole**3
    for marks in _pieces(spring):
        turn = (0.5 * (marks[1:] + marks[:-1])[:, None] + 0.5 * np.diff(marks)[:, None] * x).ravel()
        weight = (0.5 * np.diff(marks)[:, None] * w).ravel() * spring.speed(turn)
        frames = _frames(spring, turn)
        towards = np.einsum("ni,kni->kn", spring.curvature_vector(turn), np.stack([frames.y, frames.z]))
        for k, half in enumerate(frames.half):
            cut = _cut(spring, outline, frames, k)
            b, slope, dt = cut.gauss(24)
            area = cut.signed_area * (1.0 - solid[0])
            moments = 0.5 * np.array([dt @ (b[:, 0] ** 2 * slope[:, 1]), -dt @ (b[:, 1] ** 2 * slope[:, 0])])
            moment = float(towards[:, k] @ moments) * (1.0 - solid[1])
            total += weight[k] * (half**2 * area - half**3 * moment)
    return total


def circle() -> Boundary:
    """The unit circle."""
    pieces = []
    for quarter in range(4):
        φ = 0.5 * np.pi * (quarter + np.linspace(0.0, 1.0, 65))
        points = np.stack([np.cos(φ), np.sin(φ)], axis=1)
        slopes = 0.5 * np.pi * np.stack([-np.sin(φ), np.cos(φ)], axis=1)
        pieces.append(CubicHermiteSpline(np.linspace(0.0, 1.0, len(φ)), points, slopes))
    return Boundary(tuple(pieces))


def _cut(spring: Spring, outline: Boundary, frames: Frames, k: int) -> Boundary:
    """The section's outline less what grinding takes of it."""
    for end, side in (("bottom", 1.0), ("top", -1.0)):
        if getattr(spring, end).tip_thickness < 1.0:
            up = np.array([frames.y[k, 2], frames.z[k, 2]])
            steepness = float(np.linalg.norm(up))
            level = float(spring.seat_level_distance(frames.turn[k], end)) / frames.half[k] / steepness
            outline = outline.cut(level, side * up / steepness)
    return outline


def _pieces(spring: Spring) -> Iterator[np.ndarray]:
    """Turns of the rings between corners of the wire, PATCH of them on a surface."""
    for start, end in pairwise(spring.corners):
        surfaces = int(np.ceil((end - start) * RINGS / PATCH))
        yield np.linspace(start, end, surfaces * PATCH + 1)


def _frames(spring: Spring, turn: np.ndarray, before: Frames | None = None) -> Frames:
    """Sections at turns; y of those of a coil is towards its axis and z upwards.

    The axes of round wire with hooks or arms turn as little as they can, from those of a piece before.
    """
    centre, tangent = spring.centre_line(turn), spring.tangent(turn)
    angle = spring.angle(turn)
    y = -np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
    if spring.has_tails:
        last = y[0] if before is None else before.y[-1]
        for k, t in enumerate(tangent):
            last = last - (last @ t) * t
            y[k] = last = last / np.linalg.norm(last)
    y = y - np.sum(y * tangent, axis=1, keepdims=True) * tangent
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    z = spring.hand * np.cross(y, tangent)
    return Frames(turn, centre, y, z, 0.5 * spring.wire_diameter(turn))


def _strips(spring: Spring) -> list[list[Strip]]:
    """The outline, and that of a tube's hole."""
    if spring.section is None:
        corners = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]], float)
        weights, ends = np.array([1.0, 0.5**0.5, 1.0]), np.array([0.0, 1.0])
        return [[Strip(corners[q : q + 3], weights, 2, ends, np.array([3, 3])) for q in (0, 2, 4, 6)]]
    outer = [strip for piece in spring.section.pieces for strip in _parts(piece)]
    hole = spring.section.hole
    return [outer, [one._replace(points=hole * one.points) for one in outer]] if hole else [outer]


def _parts(piece: CubicHermiteSpline) -> Iterator[Strip]:
    """A straight piece by its ends, a curved one as cubic splines with its slopes, one for each quarter of a turn."""
    if len(piece.x) == 2:
        yield Strip(piece(piece.x), np.ones(2), 1, np.array([0.0, 1.0]), np.array([2, 2]))
        return
    for start, end in pairwise(np.linspace(0.0, 1.0, 1 + max(1, round(4.0 * _turned(piece))))):
        t = np.linspace(start, end, ACROSS)
        spline = make_interp_spline(t, piece(t), k=3, bc_type=([(1, piece(start, 1))], [(1, piece(end, 1))]))
        knots, multiplicities = np.unique(spline.t, return_counts=True)
        yield Strip(spline.c, np.ones(len(spline.c)), 3, knots, multiplicities)


def _turned(piece: CubicHermiteSpline) -> float:
    """Full turns that the tangent makes along a piece."""
    slopes = piece(piece.x, 1)
    angle = np.unwrap(np.arctan2(slopes[:, 1], slopes[:, 0]))
    return float(np.abs(np.diff(angle)).sum() / (2.0 * np.pi))


def _body(spring: Spring) -> None:
    """The wire in gmsh's present model, and nothing else."""
    occ, outlines = gmsh.model.occ, _strips(spring)
    faces, sections, frames = [], [], None
    for marks in _pieces(spring):
        frames = _frames(spring, marks, frames)
        sections.append(frames)
        for strip in (one for outline in outlines for one in outline):
            rings = frames.rings(strip.points)
            slopes = CubicSpline(marks, rings)(marks, 1)
            for a in range(0, len(marks) - 1, PATCH):
                b = a + PATCH
                faces.append(strip.surface(marks[a : b + 1], rings[a : b + 1], slopes[[a, b]]))
    for frames, at in ((sections[0], 0), (sections[-1], -1)):
        curves = [[one.curve(frames.rings(one.points)[at]) for one in outline] for outline in outlines]
        faces.append(occ.addPlaneSurface([occ.addWire(one) for one in curves]))
    body = [(3, occ.addVolume([occ.addSurfaceLoop(faces, sewing=True)]))]
    reach = 4.0 * float(np.abs(np.concatenate([one.centre for one in sections])).max())
    cuts = {"bottom": -reach, "top": spring.body_length}
    boxes = [
        (3, occ.addBox(-0.5 * reach, -0.5 * reach, low, reach, reach, reach))
        for end, low in cuts.items()
        if getattr(spring, end).tip_thickness < 1.0
    ]
    if boxes:
        body, _ = occ.cut(body, boxes)
    occ.synchronize()
    occ.remove([(d, tag) for d, tag in occ.getEntities() if d < 3])  # those that the body does not consist of
    occ.synchronize()
