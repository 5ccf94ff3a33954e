"""The phases of a run in a figure: names, colours or dashes, and the steps of each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.panels.panel import GREY, Trace, curve, in_legend_only

DASHES = ("solid", "dash", "dot", "dashdot")
TIMES = {1: "first time", 2: "second time", 3: "third time"}


@dataclass(frozen=True)
class Phase:
    """A phase with steps.

    Attributes:
        label: its target, or what is waited for.
        number: of its colour or dash; phases with the same label share it.
        named: whether the legend names it here.
        steps: positions of its steps in the tables.
    """

    label: str
    number: int
    named: bool
    steps: np.ndarray


def phases(run: Run, most: int) -> list[Phase]:
    """The phases with steps.

    Up to `most` phases have a number each, and those with the same target are counted (first, second time). Of more
    phases, as of a program with cycles, those with the same target share a number, and the legend names `most` targets.
    """
    of_phase = run.data["phase"].values.astype(int)
    states = [*run.snapshots[1:], "last equilibrium"]
    numbers = np.unique(of_phase)
    labels = [_words(states[min(number, len(states) - 1)]) for number in numbers]
    if len(labels) <= most:
        labels = [
            f"{label}, {TIMES.get(times := labels[: k + 1].count(label), f'time {times}')}"
            if labels.count(label) > 1
            else label
            for k, label in enumerate(labels)
        ]
    targets = list(dict.fromkeys(labels))
    found = []
    for k, (label, number) in enumerate(zip(labels, numbers, strict=True)):
        target = targets.index(label)
        named = target < most and label not in labels[:k]
        found.append(Phase(label, target, named, np.flatnonzero(of_phase == number)))
    return found


def _words(phase: str) -> str:
    """A phase in a legend: a target with the word that leads to it, a waiting or heating as it is."""
    return phase if phase.startswith(("hold ", "heat ", "last ")) else f"to {phase}"


def unnamed(found: Sequence[Phase], most: int) -> list[Trace]:
    """The entry of the legend for the targets that it does not name."""
    more = len({phase.label for phase in found}) - most
    return [in_legend_only(f"and {more} more", GREY)] if more > 0 else []


def over_travel(run: Run, curves: Sequence[tuple[np.ndarray, Trace]]) -> list[Trace]:
    """Values of the steps over travel, with the dash of each phase.

    Args:
        run: opened results.
        curves: values, shape (steps,), with their name, colour and whatever else `curve` takes.
    """
    found, travel = phases(run, len(DASHES)), run.data["travel_mm"].values
    traces = [
        curve(travel[phase.steps], values[phase.steps], dash=DASHES[phase.number % 4], showlegend=False, **drawn)
        for phase in found
        for values, drawn in curves
    ]
    traces += [in_legend_only(**drawn) for _, drawn in curves if drawn.get("name")]
    if len(found) > 1:
        named = [phase for phase in found if phase.named]
        traces += [in_legend_only(phase.label, GREY, dash=DASHES[phase.number]) for phase in named]
    return traces + unnamed(found, len(DASHES))
