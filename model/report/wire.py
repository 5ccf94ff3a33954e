"""The wire as a tube: its surface in space, and the stress on it."""

import numpy as np
from scipy.interpolate import CubicSpline

from coilset.model.results.opened import Run
from coilset.model.section.surface import Inside, component

RINGS = 3000  # of all tubes of a page together, at most
PER_ELEMENT = 4
GAUSS = 0.5 / np.sqrt(3.0)  # from the middle of an element to its sections, over its length


def inside(run: Run) -> Inside:
    """Where the inside of the coil is on the surface."""
    hand = 1 if run.case["spring"].get("hand", "right") == "right" else -1
    return Inside.of(run.summary["section_kind"] != "plane", hand)


def shear_around(run: Run) -> np.ndarray:
    """Shear stress about the wire's axis on its surface, positive as in a compressed spring, MPa.

    Returns:
        Shape (snapshots, elements, 2, angles); the angles are those of the data.
    """
    names, angle = tuple(map(str, run.data["component"].values)), np.radians(run.data["angle"].values)
    state = run.data["surface"].values
    t12, t13 = (component(state, names, name) for name in ("t12", "t13"))
    here = inside(run)
    return here.sign * np.cos(here.angle) * (t13 * np.cos(angle) - t12 * np.sin(angle))


def section_turns(run: Run) -> np.ndarray:
    """Turns of the sections at which stress is known, shape (elements, 2)."""
    turn = run.data["turn"].values
    middle, length = 0.5 * (turn[1:] + turn[:-1]), np.diff(turn)
    return middle[:, None] + length[:, None] * np.array([-GAUSS, GAUSS])


def tubes(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Surface of the wire at all snapshots, and the stress there.

    The angle about the wire is counted from the inside of the coil towards the binormal of the centre line, as in
    sections that know of the curvature; both directions are taken from the line as it lies in space.

    Returns:
        Places, shape (snapshots, rings, angles + 1, 3), mm, and `shear_around` there.
    """
    x, shear, turn = run.data["position"].values, shear_around(run), run.data["turn"].values
    snapshots, elements = len(x), len(turn) - 1
    rings = min(PER_ELEMENT * elements, RINGS // snapshots) + 1
    at = np.linspace(turn[0], turn[-1], rings)
    radius = np.interp(at, 0.5 * (turn[1:] + turn[:-1]), run.data["wire_radius"].values)
    angle = np.radians(np.append(run.data["angle"].values, 360.0)) + inside(run).angle
    sections = section_turns(run).ravel()
    places = np.empty((snapshots, rings, len(angle), 3))
    stress = np.empty((snapshots, rings, len(angle)))
    for number in range(snapshots):
        line = CubicSpline(turn, x[number], axis=0)
        centre, along = line(at), line(at, 1)
        along /= np.linalg.norm(along, axis=1)[:, None]
        inwards = -centre * [1.0, 1.0, 0.0]
        inwards -= np.sum(inwards * along, axis=1)[:, None] * along
        inwards /= np.linalg.norm(inwards, axis=1)[:, None]
        binormal = np.cross(along, inwards)
        ring = np.cos(angle)[:, None] * inwards[:, None] + np.sin(angle)[:, None] * binormal[:, None]
        places[number] = centre[:, None] + radius[:, None, None] * ring
        flat = shear[number].reshape(-1, shear.shape[-1])
        values = np.stack([np.interp(at, sections, column) for column in flat.T], axis=-1)
        stress[number] = np.column_stack([values, values[:, 0]])
    return places, stress
