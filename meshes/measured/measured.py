"""A spring from a measured centre line: points along the wire, from a table or a mesh."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from annotated_types import Unit
from pydantic import Field, ValidationInfo, field_validator

from coilset.meshes.measured.axis import Axis
from coilset.meshes.springs import functions
from coilset.meshes.springs.checks import refuse
from coilset.meshes.springs.ends import OPEN, Ends, bottom_and_top
from coilset.meshes.springs.geometry import Spring
from coilset.meshes.springs.shapes import Length
from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.strict_entries import Strict

if TYPE_CHECKING:  # imported at run time only when a mesh is read
    import meshio

LEAST_POINTS = 5
WIDEST_STEP = 1 / 3  # maximum turn between neighbouring points
WIRE_DIAMETER = "wire_diameter"
# A point is an outlier if it lies farther than these wire diameters off the curve through its neighbours, and so many
# times farther than the points usually do; a wire diameter, if it differs by more than THICKER of it from that at both
# neighbours, which differ by less than half as much.
OFF, TIMES, THICKER = 0.2, 20.0, 0.1


class MeasuredSpec(Strict):
    """A spring whose centre line was measured; the file's z axis runs through its coils; lengths are in mm.

    The points are moved so that the axis fitted to them is the z axis, if they have two turns or more and eight points
    a turn; otherwise the file's z axis is the spring's. They become mean radius and height over the
    polar angle, interpolated by a cubic spline: a helix remains exactly a helix. The wire diameter is interpolated
    without overshoot.
    """

    file: Annotated[str, Field(description="CSV with the columns x, y, z, wire_diameter, or a mesh that meshio reads")]
    wire_diameter: Annotated[Length | None, Field(description="wire diameter, mm, if the file has none")] = None
    noise: Annotated[
        float,
        Unit("mm"),
        Field(ge=0, allow_inf_nan=False, strict=True, description="standard deviation of the measured points, mm"),
    ] = 0.0
    end_coils: Ends = OPEN

    @field_validator("file")
    @classmethod
    def _from_folder(cls, file: str, info: ValidationInfo) -> str:
        """The path is relative to the folder of the case file if the validation context has one."""
        return str(Path((info.context or {}).get("folder", "")) / file)

    def build(self) -> Spring:
        """The geometry.

        Returns:
            `Spring`.

        Raises:
            InputError: a file that cannot be read or does not describe a spring, with the file and the point.
        """
        path = Path(self.file)
        points, wire = read_centre_line(path)
        if wire is None and self.wire_diameter is None:
            raise InputError(f"has no {WIRE_DIAMETER}; give spring.wire_diameter", "", path)
        if wire is not None and self.wire_diameter is not None:
            raise InputError(f"the file {path} has wire diameters too; leave this entry out", "spring.wire_diameter")
        wire = np.full(len(points), self.wire_diameter) if wire is None else wire
        numbers = np.arange(1, len(points) + 1)
        if points[-1, 2] < points[0, 2]:  # the bottom end comes first
            points, wire, numbers = points[::-1], wire[::-1], numbers[::-1]
        turn, hand, phase = _turns(points, numbers, path)
        places = _places(points)
        _refuse_outlier(turn, places, np.full(len(wire), np.median(places[:, 0])), numbers, path)  # of which none is
        axis = Axis.of(points, turn[-1])
        if axis is not None:
            points = axis.moved(points)
            turn, hand, phase = _turns(points, numbers, path)
            places = _places(points)
        _refuse_outlier(turn, places, OFF * wire, numbers, path)
        _refuse_odd_wire(wire, numbers, path)
        # radius and height have the same noise as a coordinate
        fit = functions.smoothed if self.noise > 0 else lambda t, y, noise: functions.tabulated(t, y, "spline")
        radius, height = (fit(turn, values, self.noise) for values in places.T)
        bottom, top = bottom_and_top(self.end_coils)
        closed = bottom.end_turns + top.end_turns
        if closed >= turn[-1]:
            raise InputError(
                f"{closed:g} end turns, but the centre line has only {turn[-1]:.4g} turns", "spring.end_coils"
            )
        wires = functions.tabulated(turn, wire, "monotone")
        spring = Spring(radius, height, wires, hand, bottom, top, phase, axis)
        return refuse(spring, "", str(path))


def read_centre_line(path: str | Path) -> tuple[np.ndarray, np.ndarray | None]:
    """Points along a wire and its diameters, from a CSV file or by meshio.

    Args:
        path: the file.

    Returns:
        Points in their order along the wire, shape (n, 3), and wire diameters, shape (n,) or None, mm.

    Raises:
        InputError: a file that cannot be read, is not one wire, or has too few or wrong numbers.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError("is a folder; give a file" if path.is_dir() else "there is no such file", "", path)
    points, wire = _read_csv(path) if path.suffix.lower() in (".csv", ".txt") else _read_mesh(path)
    if len(points) < LEAST_POINTS:
        raise InputError(f"has {len(points)} points; a centre line needs {LEAST_POINTS} or more", "", path)
    bad = ~np.isfinite(points).all(axis=1) | (np.zeros(len(points), bool) if wire is None else ~(wire > 0))
    if bad.any():
        i = int(np.argmax(bad))
        numbers = [*points[i], *([] if wire is None else [wire[i]])]
        raise InputError(
            f"{', '.join(f'{n:g}' for n in numbers)}: must be finite numbers and a wire diameter above 0",
            f"point {i + 1}",
            path,
        )
    return points, wire


def _read_csv(path: Path) -> tuple[np.ndarray, np.ndarray | None]:
    """Columns x, y, z and perhaps wire_diameter."""
    table = read_columns(path).named(dict.fromkeys(("x", "y", "z", WIRE_DIAMETER), "mm"))
    if table.names not in (("x", "y", "z"), ("x", "y", "z", WIRE_DIAMETER)):
        problem = f"the columns must be x,y,z or x,y,z,{WIRE_DIAMETER}, not {','.join(table.names)!r}"
        raise InputError(problem, f"line {table.head}", path)
    points = np.column_stack([table.numbers(name) for name in table.names]).reshape(-1, len(table.names))
    return points[:, :3], points[:, 3] if points.shape[1] > 3 else None


def _read_mesh(path: Path) -> tuple[np.ndarray, np.ndarray | None]:
    """The only chain of line elements in a mesh; points of other elements and loose points are ignored."""
    import meshio

    try:
        mesh = meshio.read(path)
    except (meshio.ReadError, KeyError, ValueError, IndexError, OSError, SystemExit) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"meshio cannot read it: {reason}", "", path) from None
    lines = [_straight(block) for block in mesh.cells if block.type in ("line", "line3")]
    if not lines:
        raise InputError("has no line elements; the wire must be a chain of them", "", path)
    order = _chain(np.concatenate(lines), path)
    points = np.zeros((len(order), 3))
    points[:, : mesh.points.shape[1]] = mesh.points[order]
    wire = mesh.point_data.get(WIRE_DIAMETER)
    return points, None if wire is None else np.asarray(wire, dtype=float).reshape(-1)[order]


def _straight(block: "meshio.CellBlock") -> np.ndarray:
    """Two-node line elements; three-node ones are split at their middle node."""
    return block.data if block.type == "line" else np.concatenate([block.data[:, [0, 2]], block.data[:, [2, 1]]])


def _chain(lines: np.ndarray, path: str | Path) -> np.ndarray:
    """Nodes in their order along a chain of line elements, from the end with the smaller number."""
    lines = np.unique(np.sort(np.asarray(lines, dtype=int), axis=1), axis=0)
    nodes, uses = np.unique(lines, return_counts=True)
    if np.sum(uses == 1) != 2 or uses.max() > 2:
        raise InputError(
            f"its line elements are not one open chain: {np.sum(uses == 1)} ends, {np.sum(uses > 2)} branches", "", path
        )
    neighbours: dict[int, list[int]] = {int(node): [] for node in nodes}
    for a, b in lines.tolist():
        neighbours[a].append(b)
        neighbours[b].append(a)
    order = [int(nodes[uses == 1][0])]
    previous = None
    while following := [node for node in neighbours[order[-1]] if node != previous]:
        previous = order[-1]
        order.append(following[0])
    if len(order) != len(nodes):
        raise InputError("its line elements are an open chain and closed ones; there must be one wire", "", path)
    return np.array(order)


def _turns(points: np.ndarray, numbers: np.ndarray, path: str | Path) -> tuple[np.ndarray, int, float]:
    """Turns of the points from the first, hand, and polar angle of the first, rad; the file has their numbers."""
    angle = np.arctan2(points[:, 1], points[:, 0])
    step = (np.diff(angle) + np.pi) % (2 * np.pi) - np.pi
    hand = 1 if step.sum() > 0 else -1
    back = step * hand <= 0
    if back.any():
        i = int(np.argmax(back))
        raise InputError(
            "the wire does not continue around the z axis here; the axis of the spring must be the z axis, "
            "and no point may occur twice",
            f"point {numbers[i + 1]}",
            path,
        )
    wide = np.abs(step) > 2 * np.pi * WIDEST_STEP
    if wide.any():
        i = int(np.argmax(wide))
        raise InputError(
            f"is {np.degrees(abs(step[i])):.0f}° away from point {numbers[i]}; must be at most "
            f"{360 * WIDEST_STEP:.0f}°",
            f"point {numbers[i + 1]}",
            path,
        )
    return np.concatenate([[0.0], np.cumsum(np.abs(step))]) / (2 * np.pi), hand, float(angle[0])


def _places(points: np.ndarray) -> np.ndarray:
    """Radius and height of points, shape (n, 2), mm."""
    return np.column_stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]])


def _refuse_outlier(turn: np.ndarray, places: np.ndarray, far: np.ndarray, numbers: np.ndarray, path: Path) -> None:
    """Refuse a point that is far off the cubic through its four neighbours in radius or height, as a misprint is.

    Args:
        turn: of the points, shape (n,).
        places: radius and height, mm, shape (n, 2).
        far: of each point, how far off it may lie even if the others do not, mm.
        numbers: of the points in the file.
        path: the file.
    """
    others = np.array([-2, -1, 1, 2])
    inner = np.arange(2, len(turn) - 2)
    at = turn[inner[:, None] + others] - turn[inner, None]  # of the four, from the point on
    weights = np.stack([np.prod(np.delete(at, k, 1) / (np.delete(at, k, 1) - at[:, [k]]), axis=1) for k in range(4)], 1)
    fitted = np.einsum("ik,ikj->ij", weights, places[inner[:, None] + others])
    off = np.abs(places[inner] - fitted).max(axis=1)
    worst = int(np.argmax(off))
    i = inner[worst]
    if off[worst] > max(far[i], TIMES * float(np.median(off))):
        raise InputError(
            f"lies {off[worst]:.2g} mm off the curve through its neighbours, the others {np.median(off):.1g} mm; "
            "correct it or leave it out",
            f"point {numbers[i]}",
            path,
        )


def _refuse_odd_wire(wire: np.ndarray, numbers: np.ndarray, path: Path) -> None:
    """Refuse a wire diameter, mm, that differs from both of its neighbours, which agree; other arguments as above."""
    before, here, after = wire[:-2], wire[1:-1], wire[2:]
    differs = np.minimum(np.abs(here - before), np.abs(here - after))
    odd = np.flatnonzero((differs > THICKER * here) & (np.abs(after - before) < 0.5 * differs))
    if len(odd):
        k = int(odd[0])
        raise InputError(
            f"the wire has a diameter of {here[k]:g} mm, and {before[k]:g} and {after[k]:g} mm at the points beside "
            "it; correct it or leave the point out",
            f"point {numbers[k + 1]}",
            path,
        )
