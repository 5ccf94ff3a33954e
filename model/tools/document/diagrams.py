"""Diagrams of the data sheet: force over travel or torque over rotation with working points and limits; Goodman."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from coilset.model.core.base.between_steps import Between
from coilset.model.core.results.records.record import Limit
from coilset.model.physics.working.working import number_name
from coilset.model.tools.figures.panels.goodman import goodman
from coilset.model.tools.figures.panels.panel import GREY, Panel, Trace, axis, curve
from coilset.model.tools.sheet.sheet import Sheet

POINTS = 200  # of the formula's curve
MARK: Trace = {"size": 8, "symbol": "square", "color": "#009e73"}


def diagrams(sheet: Sheet, limits: Mapping[str, Limit]) -> Iterator[Panel]:
    """Those of a sheet; `limits` by the names of their results."""
    if sheet.turned:
        if sheet.turns_to and not sheet.spring.wire:  # EN 13906-3 is for round wire
            yield _torque(sheet, limits)
        return
    yield _force(sheet, limits)
    if sheet.wire and sheet.endured and sheet.cycle:
        made = goodman(f"{sheet.wire.name}", sheet.endured, sheet.cycle, sheet.residual)
        yield replace(made, title="Goodman diagram")


def _force(sheet: Sheet, limits: Mapping[str, Limit]) -> Panel:
    """Force over the travel of the spring as it is drawn: the finished one of a run."""
    s, sign = sheet.spring, -1.0 if sheet.pulled else 1.0
    far = max(sheet.lengths, default=s.length) if sheet.pulled else s.solid
    lengths = np.linspace(s.length, far, POINTS)
    forces = [sheet.force(length) for length in lengths]
    after = sheet.at_run("free_length_after_mm") or s.length
    traces = [curve(sign * (s.length - lengths), sign * np.array(forces), GREY, dash="dash", name="by the formula")]
    if sheet.found:
        way = sheet.found.way()
        moved = after - sheet.found.heights[0]
        drawn = Between(sign * (way.travel + moved), sign * way.force, way.contacts, way.before, way.behind)
        traces.append(curve(*_opening(sheet, drawn), 0, name="by the run"))
    points = []
    for length in sheet.lengths:
        force = sheet.found.force_at(length) if sheet.found else None
        travel = sign * ((s.length if force is None else after) - length)
        points.append((travel, sign * (sheet.force(length) if force is None else force)))
        if limit := limits.get(number_name("force", length)):
            first = not any(trace.get("name") == "limits" for trace in traces)
            traces.append(_between(travel, sign * limit.low, sign * limit.high, first))
    return Panel(
        "force",
        "Force over travel",
        "Force over travel",
        [*traces, *_marked(points)],
        {"xaxis": axis("travel, mm"), "yaxis": axis("force, N", rangemode="tozero")},
    )


def _opening(sheet: Sheet, way: Between) -> tuple[np.ndarray, np.ndarray]:
    """The curve of a run through its steps; wound coils open at F0 on the line through the first two beyond it."""
    held = sheet.at_run("initial_tension_after_N") or sheet.at_run("initial_tension_N")
    if not (sheet.pulled and held):
        return way.drawn()
    order = np.argsort(way.travel)
    x, y = way.travel[order], way.force[order]
    x, y = x[y > held], y[y > held]
    if len(x) < 2 or y[1] <= y[0]:
        return way.drawn()
    opens = x[0] - (y[0] - held) * (x[1] - x[0]) / (y[1] - y[0])
    x, y = Between.through(np.append(opens, x), np.append(held, y)).drawn()
    return np.append(0.0, x), np.append(0.0, y)


def _torque(sheet: Sheet, limits: Mapping[str, Limit]) -> Panel:
    """Torque over the rotation from the position as coiled, in the sense of the largest one."""
    most, found = max(sheet.turns_to, key=abs), sheet.found
    turns = np.linspace(0.0, abs(most), POINTS)
    traces = [curve(turns, sheet.turn_rate * turns, GREY, dash="dash", name="by the formula")]
    points = [(abs(turn), sheet.turn_rate * abs(turn)) for turn in sheet.turns_to if turn * most > 0.0]
    if found and found.turns is not None and found.torques is not None:
        sense = np.sign(found.turns[np.argmax(np.abs(found.turns))])
        x, y = _last_way(sense * found.turns, sense * found.torques)
        traces.append(curve(*Between.through(x, y).drawn(), 0, name="by the run"))
        passed = ((turn, found.torque_at(turn)) for turn, _ in points)
        points = [(turn, torque) for turn, torque in passed if torque is not None]
    if limit := limits.get("torque_max_Nmm"):
        low, high = sorted((abs(limit.low), abs(limit.high)))
        traces.append(_between(abs(most), low, high, True))
    return Panel(
        "torque",
        "Torque over rotation",
        "Torque over rotation",
        [*traces, *_marked(points)],
        {"xaxis": axis("rotation, °"), "yaxis": axis("torque, N mm", rangemode="tozero")},
    )


def _between(x: float, low: float, high: float, named: bool) -> Trace:
    """A limit at an abscissa."""
    return curve([x] * 2, [low, high], 1, marker=7, name="limits", showlegend=named)


def _marked(points: Sequence[tuple[float, float]]) -> list[Trace]:
    """The working points, if there are any."""
    if not points:
        return []
    x, y = np.array(points).T
    return [{"type": "scatter", "mode": "markers", "x": x, "y": y, "marker": MARK, "name": "working points"}]


def _last_way(at: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights and forces of the last monotone part of the history, the last release of a spring that was released."""
    ways = np.sign(np.diff(at))
    turned = np.flatnonzero(ways[1:] * ways[:-1] < 0.0)
    start = turned[-1] + 1 if len(turned) else 0
    kept = np.isfinite(values[start:])
    return at[start:][kept], values[start:][kept]
