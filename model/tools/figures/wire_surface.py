"""The wire as a tube: its surface in space, and the stress on it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from coilset.model.core.results import surface as surface_values
from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.labels import plain
from coilset.model.core.results.surface import Inside
from coilset.model.core.rotations.triads import chord_triads

STRAIGHT = 0.25  # of the coil's curvature: below it a piece of a hook or arm is straight


def inside(run: Run) -> Inside:
    """Position of the inside of the coil on the surface."""
    return Inside.of(bool(run.data["curvature"].values.any()), hand(run))


def hand(run: Run) -> int:
    """+1 of a right-handed coil, −1 of a left-handed one, by its wire, as a measured one has no such entry."""
    x, y = run.data["position"].values[0, :, :2].T
    return 1 if np.sum(x[:-1] * y[1:] - y[:-1] * x[1:]) > 0.0 else -1  # twice the area swept by the radius


def outline(run: Run) -> np.ndarray | None:
    """Closed outline of a wire that is not round, y and z in wire radii, shape (n + 1, 2); None of a round one."""
    if "outline" not in run.data:
        return None
    corners = run.data["outline"].values
    return np.concatenate([corners, corners[:1]])


def coil_turns(run: Run) -> float:
    """Turns of the coil; hooks and arms are below 0 and above. Earlier runs have none."""
    return float(run.data.attrs.get("coil_turns", np.inf))


def shear_around(run: Run) -> np.ndarray:
    """Shear stress about the wire's axis on its surface, positive as in a compressed spring, MPa.

    Returns:
        Shape (snapshots, elements, sections, angles); the angles are those of the data.
    """
    return inside(run).shear_around(run.data["surface"].values, tuple(map(str, run.data["component"].values)))


def loading_stress(run: Run) -> tuple[str, np.ndarray]:
    """What a load stresses most: the name of a stress on the surface, and its values as of `shear_around`, MPa.

    Torsion springs are bent; hooks are bent and twisted; else the wire is twisted.
    """
    values, components = run.data["surface"].values, tuple(map(str, run.data["component"].values))
    if run.is_turned:
        return "stress along the wire in MPa, red in tension", surface_values.component(values, components, "s11")
    if run.summary.get("tail_stress_max_MPa") is not None:
        return "equivalent (von Mises) stress on the surface in MPa", surface_values.equivalent(values, components)
    return "shear stress on the surface in MPa, red with the load of compression", shear_around(run)


def section_turns(run: Run) -> np.ndarray:
    """Turns of the sections at which stress is known, shape (elements, sections)."""
    turn = run.data["turn"].values
    return turn[:-1, None] + np.diff(turn)[:, None] * run.data["abscissa"].values


@dataclass(frozen=True)
class Frames:
    """The wire at the start and after steps.

    Attributes:
        labels: of the moments.
        x: stations, shape (moments, n + 1, 3), mm.
        shear: `shear_around`, mean of an element's sections, shape (moments, n, angles), MPa.
    """

    labels: tuple[str, ...]
    x: np.ndarray
    shear: np.ndarray


def frames(run: Run, most: int | None = None) -> Frames:
    """The start and every step.

    Args:
        run: opened results.
        most: maximum number, evenly chosen; the ends of all phases are always included.
    """
    data = run.data
    labels, x, shear = ["start"], data["position"].values[:1], shear_around(run)[:1].mean(axis=2)
    steps = data.sizes["step"] if "step_position" in data else 0
    kept = _kept(data["phase"].values, steps if most is None else most - 1) if steps else np.empty(0, int)
    if len(kept):
        x = np.concatenate([x, data["step_position"].values[kept]])
        shear = np.concatenate([shear, data["step_shear"].values[kept]])
    names = [*run.snapshots[1:], "last equilibrium"]
    for k in kept:
        step, phase, travel, force = (float(data[name].values[k]) for name in ("step", "phase", "travel_mm", "force_N"))
        to, carried = names[min(int(phase), len(names) - 1)], round(force, 6) + 0.0
        labels.append(f"step {step:g}, to {to}: {plain(travel)} mm of travel, {plain(carried)} N")
    return Frames(tuple(labels), x, shear)


def bent_frames(run: Run) -> Frames:
    """The snapshots of a torsion spring, with the stress along its wire in place of the shear."""
    return Frames(tuple(run.snapshots), run.data["position"].values, loading_stress(run)[1].mean(axis=2))


def _kept(phase: np.ndarray, most: int) -> np.ndarray:
    """Places of steps: the last one of each phase, and of the others evenly as many as there is room for."""
    ends = np.append(np.flatnonzero(np.diff(phase)), len(phase) - 1)
    others = np.setdiff1d(np.arange(len(phase)), ends)
    room = max(min(most - len(ends), len(others)), 0)
    some = others[np.linspace(0, len(others) - 1, room).round().astype(int)] if room else others[:0]
    return np.union1d(ends, some)


def tubes(run: Run, shown: Frames, rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Surface of the wire at moments, and the stress there.

    The angle about the wire is counted from the inside of the coil towards the binormal of the centre line, as in
    sections that include the curvature; both directions are taken from the deformed centre line.

    Args:
        run: opened results.
        rings: along the wire.

    Returns:
        Places, shape (moments, rings, angles + 1, 3), mm, and `shear_around` there.
    """
    turn, radius = run.data["turn"].values, run.data["wire_radius"].values
    corners = outline(run)
    both = [
        surface(turn, x, radius, shear, inside(run), rings, corners, coil_turns(run))
        for x, shear in zip(shown.x, shown.shear, strict=True)
    ]
    places, stress = (np.stack(one) for one in zip(*both, strict=True))
    return places, stress


def surface(
    turn: np.ndarray,
    x: np.ndarray,
    wire_radius: np.ndarray,
    shear: np.ndarray,
    side: Inside,
    rings: int,
    corners: np.ndarray | None = None,
    coil: float = np.inf,
) -> tuple[np.ndarray, np.ndarray]:
    """Surface of the wire at one moment, and the stress there, as `tubes` gives them for several.

    Args:
        turn: of the stations, shape (n + 1,).
        x: stations, shape (n + 1, 3), mm.
        wire_radius: of the elements, shape (n,), mm.
        shear: about the wire's axis, mean of an element's sections, at evenly spaced angles, shape (n, angles), MPa.
        side: position of the inside of the coil.
        rings: along the wire.
        corners: `outline` of a wire that is not round.
        coil: turns of the coil; what is below 0 or above are hooks or arms.
    """
    at = np.linspace(turn[0], turn[-1], rings)
    middle = 0.5 * (turn[1:] + turn[:-1])
    angle = np.linspace(0.0, 2.0 * np.pi, shear.shape[-1] + 1)
    if corners is None:
        corners = np.stack([np.cos(angle + side.angle), np.sin(angle + side.angle)], axis=1)
    else:
        closed_shear, around = np.column_stack([shear, shear[:, :1]]), np.arctan2(*corners[:-1].T[::-1]) % (2.0 * np.pi)
        shear = np.stack([np.interp(around, angle, row) for row in closed_shear])
    line = CubicSpline(turn, x, axis=0)
    centre, *across = _directions(line, at, coil)
    y, z = corners[..., None].swapaxes(0, 1)
    ring = y * across[0][:, None] + z * across[1][:, None]
    places = centre[:, None] + np.interp(at, middle, wire_radius)[:, None, None] * ring
    if turn[0] < 0.0 or turn[-1] > coil:
        shear = _turned_by(shear, _off_normal(line, middle, at, across, coil))
    along = np.clip(np.searchsorted(middle, at) - 1, 0, len(middle) - 2)
    part = np.clip((at - middle[along]) / (middle[along + 1] - middle[along]), 0.0, 1.0)[:, None]
    stress = (1.0 - part) * shear[along] + part * shear[along + 1]
    return places, np.concatenate([stress, stress[..., :1]], axis=-1)


def closed(places: np.ndarray, stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tubes of `tubes` with a disk over each end: two more rings, of no radius, with the stress of the ring beside."""
    first, last = (
        np.broadcast_to(places[:, [end], :-1].mean(axis=2, keepdims=True), places[:, [end]].shape) for end in (0, -1)
    )
    values = np.concatenate([stress[:, :1], stress, stress[:, -1:]], axis=1)
    return np.concatenate([first, places, last], axis=1), values


def section_points(run: Run, snapshot: int) -> np.ndarray:
    """Positions of the section points in space at a snapshot, shape (elements, sections, points, 3), mm."""
    turn, at = run.data["turn"].values, section_turns(run)
    line = CubicSpline(turn, run.data["position"].values[snapshot], axis=0)
    centre, *across = _directions(line, at.ravel(), coil_turns(run))
    off = _off_normal(line, at.ravel(), at.ravel(), across, coil_turns(run))[:, None]
    inwards, binormal = (
        np.cos(off) * across[0] + np.sin(off) * across[1],
        np.cos(off) * across[1] - np.sin(off) * across[0],
    )
    centre, inwards, binormal = (values.reshape(*at.shape, 1, 3) for values in (centre, inwards, binormal))
    y, z = (run.data[name].values[..., None] for name in "yz")
    turned = np.cos(inside(run).angle)
    return centre + turned * (y * inwards + z * binormal)


def _directions(line: CubicSpline, at: np.ndarray, coil: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places on a centre line, and unit vectors across it: towards the spring's axis, and the binormal.

    Along hooks and arms the direction of the coil's end goes on without twist.
    """
    centre, along = line(at), line(at, 1)
    along /= np.linalg.norm(along, axis=1)[:, None]
    inwards = _across(-centre * [1.0, 1.0, 0.0], along)
    inside = np.flatnonzero((at >= 0.0) & (at <= coil))
    for k in range(inside[0] - 1, -1, -1):
        inwards[k] = _across(inwards[k + 1], along[k])
    for k in range(inside[-1] + 1, len(at)):
        inwards[k] = _across(inwards[k - 1], along[k])
    return centre, inwards, np.cross(along, inwards)


def _across(vectors: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Unit vectors of the parts of vectors across unit vectors `along`, shape (..., 3) each."""
    across: np.ndarray = vectors - np.sum(vectors * along, axis=-1, keepdims=True) * along
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-300)
    return across


def _off_normal(
    line: CubicSpline, turns: np.ndarray, at: np.ndarray, across: Sequence[np.ndarray], coil: float
) -> np.ndarray:
    """Angle about the wire from `_directions` to the y axis of sections, rad; 0 in the coil.

    In bends of hooks and arms y is towards their centre; in straight pieces it is level, see `chord_triads`.

    Args:
        line: the centre line.
        turns: of the sections, shape (n,).
        at: turns of the directions; across: both of them, shape (m, 3) each.
        coil: its turns.
    """
    along = line(turns, 1)
    bend = np.cross(along, np.cross(line(turns, 2), along)) / np.sum(along**2, axis=1)[:, None] ** 2
    along /= np.linalg.norm(along, axis=1)[:, None]
    curvature, beyond = np.linalg.norm(bend, axis=1), (turns < 0.0) | (turns > coil)
    straight = curvature < STRAIGHT * np.median(curvature[~beyond])
    y = np.where(straight[:, None], chord_triads(along)[..., 1], _across(bend, along))
    first, second = (one[np.abs(at[:, None] - turns).argmin(axis=0)] for one in across)
    return np.where(beyond, np.arctan2(np.sum(y * second, axis=1), np.sum(y * first, axis=1)), 0.0)


def _turned_by(stress: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Stress at evenly spaced angles, shape (n, angles), turned about the wire by angles, rad, shape (n,)."""
    places = 2.0 * np.pi * np.arange(stress.shape[-1]) / stress.shape[-1]
    rows = zip(angle, stress, strict=True)
    return np.stack([np.interp(places - by, places, row, period=2.0 * np.pi) for by, row in rows])
