"""Quantities of the formulas as found in a results folder."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coilset.model.core.base.between_steps import UNKNOWN, Between, closed_rate, part
from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError, reading
from coilset.model.core.results.files.netcdf import read_netcdf
from coilset.model.core.results.records.record import Step

if TYPE_CHECKING:
    from xarray import Dataset

MIDDLE = (0.25, 0.75)  # part of the turns that counts as the body, away from the ends
ROUNDING = 1e-9  # of the free length: a height that is nearer to a length is that length


@dataclass(frozen=True)
class Found:
    """Numbers of a run, N, mm, MPa; None where the run did not reach it.

    Attributes:
        summary: summary.json.
        heights, forces: of the seats after each step, shape (steps,).
        residual: shear stress about the wire's axis in the released spring, mean over the outermost ring of section
            points and over the middle half of the turns; negative if it opposes the load's stress.
        ring: radius of that ring over the wire's radius.
        growth: of the mean diameter at the minimum height of a snapshot, over whole turns, about the middle half, mm.
        turns, torques: of the heads after each step, degrees and N mm; None unless they turn.
        contacts: how many are closed after each step; None where that is unknown.
    """

    summary: dict[str, Any]
    heights: np.ndarray
    forces: np.ndarray
    residual: float | None
    ring: float | None
    growth: float | None = None
    turns: np.ndarray | None = None
    torques: np.ndarray | None = None
    contacts: np.ndarray | None = None

    def get(self, name: str) -> float | None:
        """An entry of the summary; None if it is missing."""
        value = self.summary.get(name)
        return None if value is None else float(value)

    def force_at(self, length: float) -> float | None:
        """Force at a length: of the finished spring where it is one of the run's working lengths.

        Else that when the spring last passed it, or stood at it but for rounding; None if it never did.
        """
        finished = self.finished_force_at(length)
        return self._passed(length, -1) if finished is None else finished

    def finished_force_at(self, length: float) -> float | None:
        """Force of the finished spring at one of the run's working lengths; None at any other length."""
        for state in self.summary.get("working") or ():
            if state.get("length_wanted") == length and not state["reason"]:
                return float(state["force_N"])
        return None

    def first_force_at(self, length: float) -> float | None:
        """Force when the spring first came to a length, before it had set there; None if it never did."""
        return self._passed(length, 0)

    def _passed(self, length: float, which: int) -> float | None:
        i = _passed(self.heights, length, ROUNDING * self.heights[0], which)
        if i is None or self.heights[i + 1] == self.heights[i]:
            return None if i is None else float(self.forces[i + 1])  # of a hold, its end
        low, high = sorted(self.heights[i : i + 2])
        return self.way(i).at(self.heights[0] - float(np.clip(length, low, high)))[0]

    def way(self, step: int = -1) -> Between:
        """Force over the travel of the steps around one that go on in its sense; the last one is that of a release."""
        travel = self.heights[0] - self.heights
        senses = np.sign(np.diff(travel))
        first = last = step % len(senses)
        while first > 0 and senses[first - 1] == senses[step]:
            first -= 1
        while last + 1 < len(senses) and senses[last + 1] == senses[step]:
            last += 1
        counts = np.zeros(len(travel)) if self.contacts is None else self.contacts
        case = self.summary.get("origin", {}).get("case", {})
        closed = closed_rate(case, self.summary.get("rate_N_per_mm")) if self.contacts is not None else UNKNOWN
        return part(travel, self.forces, counts, first, last + 1, closed)

    def torque_at(self, turn: float) -> float | None:
        """Torque when the heads last passed a rotation, N mm; positive ones in the sense of the largest, degrees."""
        if self.turns is None or self.torques is None:
            return None
        sense = float(np.sign(self.turns[np.argmax(np.abs(self.turns))]))
        turns, torques = sense * self.turns, sense * self.torques
        i = _passed(turns, turn, ROUNDING * float(np.ptp(turns)), -1)
        if i is None:
            return None
        way = turns[i + 1] - turns[i]
        fraction = np.clip((turn - turns[i]) / way, 0.0, 1.0) if way else 1.0  # of a hold, its end
        return float(torques[i] + fraction * (torques[i + 1] - torques[i]))

    def work_to(self, length: float) -> float | None:
        """Work of the first compression to a length, ∫ F ds, N mm; None if the first compression did not reach it."""
        first = int(np.argmin(self.heights)) + 1
        heights = self.heights[:first]
        if length < heights[-1] - ROUNDING * heights[0] or np.any(np.diff(heights) > 0):
            return None
        travel, force = self.way(0).drawn()
        end = self.heights[0] - max(length, heights[-1])
        grid: np.ndarray = np.append(travel[travel < end], end)
        values = np.interp(grid, travel, force)
        return float(np.trapezoid(values, grid))


def _passed(at: np.ndarray, wanted: float, near: float, which: int) -> int | None:
    """Step that passed, or stood at, what is wanted, the first (`which` is 0) or last one (-1); None if none did."""
    high, low = np.maximum(at[1:], at[:-1]), np.minimum(at[1:], at[:-1])
    passed = np.flatnonzero((low <= wanted + near) & (wanted - near <= high))
    return int(passed[which]) if len(passed) else None


def of_steps(summary: dict[str, Any], steps: Sequence[Step]) -> Found:
    """Of the records of a run, without what its section points show."""
    before = summary["free_length_before_mm"]
    columns = [[float(getattr(step, name)) for step in steps] for name in ("seat_height_mm", "force_N", "contacts")]
    heights, forces = np.array([before, *columns[0]]), np.array([0.0, *columns[1]])
    found = Found(summary, heights, forces, None, None, contacts=np.array([*columns[2][:1], *columns[2]]))
    if summary.get("turn_max_deg") is None:
        return found
    turns, torques = (np.array([0.0, *(getattr(step, name) for step in steps)]) for name in ("turn_deg", "torque_Nmm"))
    return replace(found, turns=turns, torques=torques)


def read(folder: str | Path) -> Found:
    """Read a results folder of `coilset solve`.

    Raises:
        InputError: if it contains no readable summary or history.
    """
    folder = Path(folder)
    for name in ("summary.json", "history.csv"):
        if not (folder / name).is_file():
            raise InputError(f"holds no results of a run: there is no {name}", "", folder)
    with reading(folder / "summary.json"):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    history = read_columns(folder / "history.csv")
    try:
        before = summary["free_length_before_mm"]
    except (KeyError, TypeError) as error:
        raise InputError(f"is not a result of coilset solve ({error})", "", folder) from None
    missing = next((name for name in ("seat_height_mm", "force_N") if name not in history.names), None)
    if missing:
        raise InputError(f"is not a result of coilset solve ({missing!r})", "", folder)
    heights, forces = history.numbers("seat_height_mm"), history.numbers("force_N")
    found = Found(summary, np.append(before, heights), np.append(0.0, forces), *_points(folder / "points.nc"))
    if "contacts" in history.names:
        count = history.numbers("contacts")
        found = replace(found, contacts=np.append(count[:1], count))
    if summary.get("turn_max_deg") is None:
        return found
    turns, torques = (np.append(0.0, history.numbers(name)) for name in ("turn_deg", "torque_Nmm"))
    return replace(found, turns=turns, torques=torques)


def _points(path: Path) -> tuple[float | None, float | None, float | None]:
    """`Found.residual`, `ring` and `growth`; None for each without the file."""
    if not path.exists():
        return None, None, None
    with reading(path):
        data = read_netcdf(path)
        return *_residual(data), _growth(data)


def _growth(data: "Dataset") -> float:
    """Over whole turns, whose mean is their centre wherever the spring has moved."""
    turn, position = data["turn"].values, data["position"].values[..., :2]
    whole = max(1.0, np.floor((MIDDLE[1] - MIDDLE[0]) * turn[-1]))
    first = 0.5 * (turn[-1] - whole)
    body = position[:, (turn >= first) & (turn < first + whole)]
    radius = np.linalg.norm(body - body.mean(axis=1, keepdims=True), axis=-1).mean(axis=1)
    return 2.0 * float(radius[int(np.argmin(data["height"].values))] - radius[0])


def _residual(data: "Dataset") -> tuple[float | None, float | None]:
    """Residual shear about the wire's axis, signed as the load's, and the radius of its ring over the wire's."""
    force = data["force"].values
    loaded = int(np.argmax(np.abs(force)))
    if not force[loaded] or abs(force[-1]) > 1e-6 * abs(force[loaded]):
        return None, None
    turn = data["turn"].values
    middle = 0.5 * (turn[1:] + turn[:-1]) / turn[-1]
    body = (middle > MIDDLE[0]) & (middle < MIDDLE[1])
    y, z = data["y"].values, data["z"].values
    distance = np.hypot(y, z)
    round_one = distance[len(distance) // 2, 0]  # of mid height, which no grinding has touched
    outer = round_one > (1 - 1e-6) * round_one.max()
    points = data["point_state" if "point_state" in data else "history"]  # its earlier name
    t12, t13 = (points.sel(component=name).values[[loaded, -1]] for name in ("t12", "t13"))
    weight = data["weight"].values[len(distance) // 2, 0]
    across = (t13 * y - t12 * z) / np.maximum(distance, 1e-300)
    at_load, released = across[:, body][..., outer].mean(axis=(1, 2, 3))
    # the rule's points on the unit disk: Σ w r² = ½ for a wire of radius 1
    radius = np.sqrt(2 * float((weight * round_one**2).sum()))
    return float(released * np.sign(at_load)), float(round_one.max() / radius)
