"""Figures of a run: the characteristic, and the residual stress over the wire's cross-section."""

import textwrap
from collections.abc import Mapping
from math import ceil
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from coilset.model.base.style import DIVERGING, STYLE, levels
from coilset.model.figures.curve import compressed, element_at, smooth
from coilset.model.figures.rings import ROUND, FilledSection
from coilset.model.results.files.folder import whole
from coilset.model.results.records.labels import in_legend, named_phases, plain, unnamed
from coilset.model.results.records.record import Result, Setup, Snapshot
from coilset.model.section.rules import rim

NAMED = 6  # targets in a legend, at most: as many as there are colours
REST = "0.55"  # the grey of all others
LETTERS = 14  # of a title, on an inch of a figure
LARGE = 10  # the same in the size of a single diagram's title
COMPRESSION = 3  # of PNG, from 1 to 9: files 8 % larger than by 6, in half of the time
BESIDE = 4  # lines of a legend that fit beside a characteristic
LINE = 0.15  # inches of a figure that a line of the legend below it takes


def save(figure: Figure, path: str | Path) -> None:
    """Write a figure as PNG; its colours `C0`, `C1`, … are looked up only now.

    The same picture as by `savefig`, which finds the layout, draws to be sure of it, and draws once more.
    """
    with whole(path) as partial, mpl.rc_context(STYLE):
        figure.dpi = STYLE["savefig.dpi"]
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        picture = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
        picture.save(partial, "png", dpi=(figure.dpi, figure.dpi), compress_level=COMPRESSION)


def add_title(figure: Figure, text: str) -> None:
    """Put a line below the title that a figure has, all of it broken to the figure's width."""
    figure.suptitle(broken(figure, f"{figure.get_suptitle()}\n{text}", LETTERS), fontsize=9)


def broken(figure: Figure, text: str, letters: int) -> str:
    """Lines of a title that are not wider than the figure, with so many letters on an inch of it."""
    width = int(letters * figure.get_figwidth())
    return "\n".join(part for line in text.split("\n") for part in textwrap.wrap(line, width))


def characteristic(path: str | Path, setup: Setup, result: Result, summary: Mapping[str, Any]) -> None:
    """Force over travel, one line per phase."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes = figure.add_subplot()
        travel, force = [0.0], [0.0]
        for index, (number, name) in enumerate(named_phases(setup.phases, NAMED)):
            steps = [step for step in result.steps if step.phase == index]
            if not steps:
                continue
            travel = [travel[-1]] + [step.travel_mm for step in steps]
            force = [force[-1]] + [step.force_N for step in steps]
            colour = f"C{number}" if number < NAMED else REST
            axes.plot(*smooth(travel, force), lw=1.3, color=colour, label=name and in_legend(name))
            axes.plot(travel, force, "o", ms=2, color=colour)
        if more := unnamed(setup.phases, NAMED):
            axes.plot([], [], "o-", ms=3, lw=1.3, color=REST, label=more)
        greatest = max(abs(summary["force_max_N"]), 1e-300)
        block = summary["free_length_before_mm"] - summary["block_height_mm"]
        if (rate := summary["rate_N_per_mm"]) is not None:
            end = min(greatest / rate, max(abs(step.travel_mm) for step in result.steps) if result.steps else block)
            end = np.copysign(end, summary["force_max_N"])
            axes.plot([0, end], [0, rate * end], "k:", lw=0.9, label=f"initial rate {rate:.4g} N/mm")
        axes.axvline(block, color="0.6", lw=0.8, ls="--", label=f"block, {summary['block_height_mm']:.4g} mm high")
        if summary["set_mm"] is not None:
            set_mm = summary["set_mm"]
            axes.annotate("", (0, 0), (set_mm, 0), arrowprops={"arrowstyle": "<->", "lw": 0.9, "color": "0.3"})
            axes.annotate(
                _changed(set_mm, "set"),
                (0.5 * set_mm, -0.025 * greatest if summary["force_max_N"] > 0.0 else 0.025 * greatest),
                va="top" if summary["force_max_N"] > 0.0 else "bottom",
                ha="center",
                bbox={"fc": "w", "ec": "none", "pad": 0.5, "alpha": 0.8},
            )
        axes.set(xlabel="travel in mm", ylabel="axial force in N", title=broken(figure, _found(summary), LARGE))
        if (lines := len(axes.get_legend_handles_labels()[1])) <= BESIDE:
            axes.legend(fontsize=8)
        else:
            figure.set_figheight(figure.get_figheight() + LINE * ceil(lines / 2))
            figure.legend(fontsize=7, loc="outside lower center", ncols=2)
        axes.grid(lw=0.3)
        save(figure, path)


def _found(summary: Mapping[str, Any]) -> str:
    set_mm = summary["set_mm"]
    lost, sets = summary["load_loss_percent"], ""
    if set_mm is not None:
        sets = f", the spring {_changed(set_mm, 'sets', 'stays ')}"
    elif lost is not None:
        sets = f", the spring loses {plain(lost)} % of its load"
    force = summary["force_max_N"]
    return f"{compressed(force)} with up to {plain(abs(force))} N{sets} ({summary['material']})"


def _changed(set_mm: float, word: str, longer: str = "") -> str:
    """A set with its word, or by how much a spring that was pulled has become longer."""
    said = plain(set_mm)
    return f"{longer}{said[1:]} mm longer" if said.startswith("-") else f"{word} {said} mm"


def cross_section(path: str | Path, setup: Setup, snapshot: Snapshot, turn: float | None) -> None:
    """Stress over the cross-section at a turn, to the wire's surface: circumferential shear and normal stress.

    Args:
        path: PNG to write.
        setup: Setup.
        snapshot: Snapshot.
        turn: that of the residual shear in the summary; None: the middle of the wire.
    """
    element = element_at(setup.turns, turn)
    section, radius = FilledSection(setup.rule.points), setup.wire_radius[element]
    y, z = radius * section.places.T
    edge = np.concatenate([rim(ROUND), rim(1)])

    def stress(name: str) -> np.ndarray:
        column = snapshot.components.index(name)
        states = snapshot.point_state, snapshot.surface_state
        return section.values(*(state[element, ..., column].mean(axis=0) for state in states))

    around = section.shear_around(stress("t12"), stress("t13"), setup.inside)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.2, 3.9), layout="constrained")
        panels = ((around, "shear about the wire's axis,\npositive with the load"), (stress("s11"), "normal stress"))
        for place, (values, name) in enumerate(panels):
            axes = figure.add_subplot(1, 2, place + 1)
            limit = max(float(np.abs(values).max()), 1e-9)
            shown = axes.tricontourf(y, z, values, levels=levels(-limit, limit), cmap=DIVERGING)
            axes.plot(*radius * setup.rule.points.T, "k.", ms=2, alpha=0.5)
            axes.plot(*radius * edge.T, "k-", lw=0.8)
            direction = "towards" if np.cos(setup.inside.angle) > 0 else "away from"
            axes.set(aspect="equal", xlabel=f"{direction} the coil's axis in mm", ylabel="across in mm", title=name)
            figure.colorbar(shown, ax=axes, label="MPa", shrink=0.85)
        low, high = (plain(value, 2).replace("-", "−") for value in (around.min(), around.max()))
        figure.suptitle(
            f"At {snapshot.name} the shear at turn {0.5 * float(setup.turns[element : element + 2].sum()):.2f} runs "
            f"from {low} to {high} MPa; dots: section points"
        )
        save(figure, path)
