"""All pictures of a run, in parts that can be drawn in parallel; their libraries are loaded when they are needed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coilset.model.results.records.record import Result, Setup, Snapshot

MOST_SPRINGS = 4  # side by side in springs.png


@dataclass(frozen=True)
class Pictured:
    """What the pictures show.

    Attributes:
        setup, result: records of the run.
        summary: see coilset.model.results.records.summary.
    """

    setup: Setup
    result: Result
    summary: Mapping[str, Any]


Draw = Callable[[Path, Pictured], list[str]]


def load_figures() -> tuple[Draw, ...]:
    """Load the libraries of the figures: all but the seats' pressure, and that, which takes as long."""
    from coilset.model.figures import figures, seat_figures

    def pressure(out: Path, run: Pictured) -> list[str]:
        if run.result.steps:
            seat_figures.seat_pressure(out / "seat_pressure.png", run.setup, run.result)
        return []

    def others(out: Path, run: Pictured) -> list[str]:
        figures.characteristic(out / "characteristic.png", run.setup, run.result, run.summary)
        turn = run.summary["residual_shear_inside_turn"]
        figures.cross_section(out / "cross_section.png", run.setup, run.result.snapshots[-1], turn)
        if run.result.steps:
            seat_figures.force_centre(out / "force_centre.png", run.setup, run.result)
        if run.result.mode is not None:
            from coilset.model.figures import buckling_figure

            buckling_figure.buckling_mode(out / "buckling_mode.png", run.setup, run.result, run.summary)
        return []

    return others, pressure


def shown(snapshots: Sequence[Snapshot]) -> list[Snapshot]:
    """The snapshots of springs.png: the start, that of the greatest load, and the last ones, in their order."""
    if len(snapshots) <= MOST_SPRINGS:
        return list(snapshots)
    loaded = max(range(len(snapshots)), key=lambda number: abs(snapshots[number].force))
    chosen = {0, loaded}
    for number in reversed(range(len(snapshots))):
        if len(chosen) < MOST_SPRINGS:
            chosen.add(number)
    return [snapshots[number] for number in sorted(chosen)]


def load_scene() -> tuple[Draw, ...]:
    """Load the libraries for springs.png, and start a virtual display if it needs one."""
    from coilset.model.figures import display, scene

    there = display.ensure()

    def draw(out: Path, run: Pictured) -> list[str]:
        if not there:
            return ["springs.png is not drawn: there is no display and no Xvfb"]
        scene.springs(out / "springs.png", shown(run.result.snapshots), run.setup)
        return []

    return (draw,)


PARTS: dict[str, Callable[[], tuple[Draw, ...]]] = {"figures": load_figures, "scene": load_scene}
"""Names of the parts; each gives functions that draw into a folder and return warnings, one line each."""
