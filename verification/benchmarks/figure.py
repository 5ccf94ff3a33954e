"""The picture of a bench: where the time goes, what an element costs, and what a second rank brings."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.base.style import STYLE
from coilset.model.figures.png import save
from coilset.verification.benchmarks.measure import STAGES
from coilset.verification.benchmarks.target import FLAT, ITERATION, LARGE, per_element, seconds

YELLOW = "#f0e442"  # Okabe and Ito's seventh colour
COLOURS = dict(zip(STAGES, [*(f"C{k}" for k in range(6)), YELLOW, "0.6"], strict=True))


def draw(path: Path, record: dict[str, Any]) -> None:
    """Write the figure as PNG."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.0, 3.8), layout="constrained")
        example, elements, ranks = figure.subplots(1, 3, width_ratios=(1.1, 1.3, 0.8))
        _stages(example, record["example"])
        _elements(elements, record["elements"])
        _ranks(ranks, record["ranks"])
        machine = record["machine"]
        large = [per_element(run) for run in record["elements"] if run["elements"] >= LARGE]
        found = f"An iteration takes {min(large):.0f} to {max(large):.0f} µs an element" if large else "coilset bench"
        figure.suptitle(
            f"{found}; {machine['processor']}, {machine['cores']} cores, load {machine['load']:.1f} at the start"
        )
        save(figure, path)


def _stages(axes: Axes, example: dict[str, Any]) -> None:
    spent = [1e3 * example["stages"][stage][1] for stage in STAGES]
    axes.barh(STAGES, spent, color=[COLOURS[stage] for stage in STAGES])
    for place, value in enumerate(spent):
        axes.annotate(f" {value:.1f}", (value, place), va="center", fontsize=8)
    axes.invert_yaxis()
    axes.set(
        xlabel="processor time in ms",
        title=f"Example, {example['elements']} elements, {example['steps']} steps, "
        f"{example['iterations']} iterations: {1e3 * example['analysis'][1]:.0f} ms",
    )
    axes.title.set_fontsize(9)
    axes.margins(x=0.15)


def _elements(axes: Axes, runs: list[dict[str, Any]]) -> None:
    n = [run["elements"] for run in runs]
    total = np.array([per_element(run) for run in runs])
    axes.plot(n, total, "ko-", ms=4, label="all")
    for stage in ITERATION:
        axes.plot(n, [per_element(run, stage) for run in runs], "o-", ms=3, lw=1.0, color=COLOURS[stage], label=stage)
    large = total[np.array(n) >= LARGE]
    if len(large):
        middle = np.sqrt(large.min() * large.max())
        half = np.sqrt(1.0 + FLAT)
        axes.fill_between(
            [LARGE, max(n)], middle / half, middle * half, color="0.85", zorder=0, label=f"within {100 * FLAT:.0f} %"
        )
    axes.set(
        xscale="log",
        yscale="log",
        xlabel="elements",
        ylabel="processor time of an element\nin an iteration, µs",
        title="Cost of an element, one plastic step",
    )
    axes.title.set_fontsize(9)
    axes.set_ylim(0.2 * max(axes.get_ylim()[0], 1e-3 * total.min()))  # room for the legend below the lines
    axes.legend(fontsize=7, ncols=2, loc="lower left")
    axes.grid(lw=0.3)


def _ranks(axes: Axes, runs: list[dict[str, Any]]) -> None:
    place, bottom = np.arange(len(runs)), np.zeros(len(runs))
    for stage in STAGES:
        height = np.array([run["stages"][stage][0] for run in runs])
        axes.bar(place, height, 0.6, bottom=bottom, color=COLOURS[stage], label=stage)
        bottom += height
    axes.set_xticks(place, [f"{run['ranks']} rank{'s' if run['ranks'] > 1 else ''}" for run in runs])
    speed = seconds(runs[0]["stages"], 0) / seconds(runs[-1]["stages"], 0)
    axes.set(
        ylabel="time in s (colours as on the left)",
        title=f"{runs[0]['elements']:,} elements: {speed:.2f} times as fast",
    )
    axes.title.set_fontsize(9)
