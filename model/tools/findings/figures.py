"""Figures of a sweep: responses over inputs, a family of characteristics, scatter, sensitivity, convergence."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from coilset.model.core.base.errors import InputError
from coilset.model.core.base.style import STYLE
from coilset.model.tools.figures.png import add_title, save
from coilset.model.tools.findings import findings
from coilset.model.tools.findings.sensitivity import rank_correlation, sobol_indices
from coilset.model.tools.sweep import spec as sp
from coilset.model.tools.sweep.plan import Plan

LINE_LIMIT = 5000  # curves drawn in a family; of more, an even selection
COLOURS = "viridis"
NOTHING = 1e-9  # in any unit of a response


def chosen(plan: Plan) -> list[Any]:
    """The figures that the sweep file requests, or the defaults of its design."""
    spec, names = plan.spec, plan.names
    if spec.figures is not None:
        return spec.figures
    if spec.design == "one_at_a_time":
        return [sp.Convergence(kind="convergence")]
    if spec.model == "uniform_rod":  # without characteristics
        return [sp.Scatter(kind="scatter"), sp.Sensitivity(kind="sensitivity")]
    family = sp.Family(kind="characteristics", colour=names[0])
    if spec.design not in sp.SAMPLES and len(names) <= 3:
        roles = dict(zip(("x", "colour", "panels"), names, strict=False))
        return [sp.Lines(kind="lines", **roles), family]
    return [sp.Family(kind="characteristics"), sp.Scatter(kind="scatter"), sp.Sensitivity(kind="sensitivity")]


def draw(folder: Path, plan: Plan, data: xr.Dataset) -> tuple[list[str], list[InputError]]:
    """Draw the figures of a sweep.

    Args:
        folder: Path to write to.
        data: data set of coilset.model.tools.sweep.dataset.collect.

    Returns:
        Names of the files, and an InputError for each figure of a response that the cases do not have; nothing of a
        sweep in which no case is done.
    """
    files: list[str] = []
    problems: list[InputError] = []
    if not (data.status == "done").any():
        return files, problems
    with mpl.rc_context(STYLE):
        for number, figure in enumerate(chosen(plan)):
            try:
                drawn = DRAW[figure.kind](figure, plan, data, f"figures.{number}")
            except InputError as error:
                problems.append(InputError(error.problem, error.place, plan.path))
                continue
            if drawn is None:
                continue
            cases = f"{plan.path.stem}: {int((data.status == 'done').sum())} of {len(plan)} cases"
            add_title(drawn, cases)
            files.append(f"{number + 1:02d}_{figure.kind}.png")
            save(drawn, folder / files[-1])
    return files, problems


def _axis(data: xr.Dataset, name: str) -> str:
    """Label of an axis: description and unit of a variable."""
    attributes = data[name].attrs
    return attributes["long_name"] + (f" in {attributes['units']}" if attributes["units"] else "")


def _response(data: xr.Dataset, name: str, place: Any) -> np.ndarray:
    """Values of a response, shape (cases,)."""
    known = [key for key in data.data_vars if data[key].dims == ("case",) and data[key].dtype.kind == "f"]
    if name not in known:
        raise InputError(f"'{name}' is not a response of these cases ({', '.join(sorted(known))})", f"{place}.of")
    return data[name].to_numpy()


def _varies(values: np.ndarray) -> bool:
    """Whether a response differs between cases by more than rounding, as that of a set of springs that stay elastic."""
    known = values[np.isfinite(values)]
    return len(known) > 0 and float(np.ptp(known)) > max(findings.FLAT * float(np.abs(known).max()), NOTHING)


def _levels(data: xr.Dataset, name: str) -> list[tuple[Any, np.ndarray]]:
    """Distinct values of an input in order, and for each the cases that have it; one level if `name` is None."""
    if name is None:
        return [(None, np.ones(data.sizes["case"], dtype=bool))]
    column = data[name].to_numpy()
    return [(value, column == value) for value in np.unique(column)]


def _text(data: xr.Dataset, name: str, value: Any) -> str:
    unit = data[name].attrs["units"]
    shown = value if isinstance(value, str) else f"{value:.5g}"
    return f"{data[name].attrs['long_name']} {shown}" + (f" {unit}" if unit else "")


def lines(figure: Figure, plan: Plan, data: xr.Dataset, place: Any) -> Any:
    """A response over one input; lines for a second, panels for a third."""
    values, panels = _response(data, figure.of, place), _levels(data, figure.panels)
    colours = _levels(data, figure.colour)
    shades = mpl.colormaps[COLOURS](np.linspace(0.0, 0.9, len(colours)))
    drawn = Figure(figsize=(1.6 + 3.4 * min(len(panels), 3), 0.8 + 3.2 * -(-len(panels) // 3)), layout="constrained")
    axes = drawn.subplots(-(-len(panels) // 3), min(len(panels), 3), sharex=True, sharey=True, squeeze=False).ravel()
    along = []
    for panel, (panel_value, in_panel) in zip(axes, panels, strict=False):
        for shade, (value, in_line) in zip(shades, colours, strict=True):
            x, y = data[figure.x].to_numpy()[in_panel & in_line], values[in_panel & in_line]
            order = np.argsort(x)
            label = None if figure.colour is None else _text(data, figure.colour, value)
            panel.plot(x[order], y[order], "o-", ms=3, lw=1.2, color=shade, label=label)
            along.append(y[order])
        panel.set(xlabel=_axis(data, figure.x), ylabel=_axis(data, figure.of))
        if figure.panels is not None:
            panel.set_title(_text(data, figure.panels, panel_value), fontsize=9)
        panel.label_outer()
        panel.grid(lw=0.3)
    for spare in axes[len(panels) :]:
        spare.remove()
    if figure.colour is not None:
        axes[0].legend(fontsize=7)
    if np.isfinite(values).any():
        drawn.suptitle(findings.trend(data, figure.of, figure.x, along))
    return drawn


def contours(figure: Figure, plan: Plan, data: xr.Dataset, place: Any) -> Any:
    """A response over two inputs; dots mark the cases."""
    values = _response(data, figure.of, place)
    good = np.isfinite(values)
    x, y = (data[name].to_numpy() for name in (figure.x, figure.y))
    if good.sum() < 4 or min(len(np.unique(x[good])), len(np.unique(y[good]))) < 2:
        return None
    if _on_a_line(x[good], y[good]):
        raise InputError("the cases lie on one line, and a map needs an area; give kind: lines, or design: grid", place)
    drawn = Figure(figsize=(5.6, 4.4), layout="constrained")
    axes = drawn.add_subplot()
    shown = axes.tricontourf(x[good], y[good], values[good], levels=16, cmap=COLOURS)
    isolines = axes.tricontour(x[good], y[good], values[good], levels=8, colors="k", linewidths=0.5)
    axes.clabel(isolines, fontsize=7)
    axes.plot(x[good], y[good], "k.", ms=2)
    if not good.all():
        axes.plot(x[~good], y[~good], "rx", ms=4, label="failed or missing")
        axes.legend(fontsize=7)
    drawn.colorbar(shown, label=_axis(data, figure.of))
    axes.set(xlabel=_axis(data, figure.x), ylabel=_axis(data, figure.y))
    drawn.suptitle(findings.extent(data, figure.of))
    return drawn


def _on_a_line(x: np.ndarray, y: np.ndarray) -> bool:
    """Whether places, neither of whose coordinates is constant, lie on one line, which encloses no triangle."""
    across = np.stack([(one - one.mean()) / np.ptp(one) for one in (x, y)])
    return bool(np.linalg.matrix_rank(across, tol=1e-9 * len(x)) < 2)


def characteristics(figure: Figure, plan: Plan, data: xr.Dataset, place: Any) -> Any:
    """Force over travel of all cases, coloured by an input or a response."""
    travel, force = data["curve_travel_mm"].to_numpy(), data["curve_force_N"].to_numpy()
    words = None
    if figure.colour not in plan.names:
        shade = _response(data, figure.colour, place)
    elif data[figure.colour].dtype.kind == "f":
        shade = data[figure.colour].to_numpy()
    else:
        words, shade = np.unique(data[figure.colour].to_numpy(), return_inverse=True)
    some = np.flatnonzero(np.isfinite(force).any(axis=1) & np.isfinite(shade))
    if not len(some):
        return None
    some = some[:: -(-len(some) // LINE_LIMIT)]
    start = np.zeros((len(some), 1))
    curves = np.stack([np.hstack([start, part[some]]) for part in (travel, force)], axis=-1)
    drawn = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = drawn.add_subplot()
    width = float(np.clip(30.0 / len(some), 0.25, 1.2))
    family = LineCollection([curve[np.isfinite(curve[:, 1])] for curve in curves], cmap=COLOURS, lw=width)
    family.set_array(shade[some])
    axes.add_collection(family)
    axes.autoscale()
    bar = drawn.colorbar(family, label=_axis(data, figure.colour))
    if words is not None:
        bar.set_ticks(range(len(words)), labels=list(words))
    axes.set(xlabel="travel in mm", ylabel="axial force in N")
    axes.grid(lw=0.3)
    if "force_max_N" in data:
        drawn.suptitle(findings.extent(data, "force_max_N"))
    return drawn


def scatter(figure: Figure, plan: Plan, data: xr.Dataset, place: Any) -> Any:
    """A response over each input in turn, and its distribution."""
    values = _response(data, figure.of, place)
    good = np.isfinite(values)
    if not _varies(values):
        return None
    names, count = plan.names, len(plan.names) + 1
    drawn = Figure(figsize=(1.4 + 2.9 * min(count, 3), 0.6 + 2.8 * -(-count // 3)), layout="constrained")
    axes = drawn.subplots(-(-count // 3), min(count, 3), squeeze=False).ravel()
    for panel, name in zip(axes, names, strict=False):
        panel.plot(data[name].to_numpy()[good], values[good], ".", ms=3, alpha=0.6)
        panel.set(xlabel=_axis(data, name), ylabel=_axis(data, figure.of))
        panel.grid(lw=0.3)
    mean, deviation = values[good].mean(), values[good].std(ddof=1) if good.sum() > 1 else 0.0
    last = axes[count - 1]
    last.hist(values[good], bins="auto", color="0.6")
    last.axvline(mean, color="k", lw=1)
    low, high = np.quantile(values[good], [0.05, 0.95])
    last.axvspan(low, high, color="C0", alpha=0.15)
    last.set(xlabel=_axis(data, figure.of), ylabel="cases")
    last.set_title(f"mean {mean:.5g}, standard deviation {deviation:.3g}\nshaded: 5 % to 95 % of the cases", fontsize=8)
    drawn.suptitle(findings.middle(data, figure.of))
    for spare in axes[count:]:
        spare.remove()
    return drawn


def sensitivity(figure: Figure, plan: Plan, data: xr.Dataset, place: Any) -> Any:
    """Bars of the Sobol indices (design sobol_indices) or of the rank correlations, with their 95 % intervals."""
    numeric = [name for name in plan.names if data[name].dtype.kind == "f"]
    sobol = plan.spec.design == "sobol_indices"
    names = plan.names if sobol else numeric
    if not names:
        return None
    words = [findings.words(data, name) for name in names]
    drawn = Figure(figsize=(6.4, 0.9 + 0.45 * len(names) * len(figure.of) + 0.8 * len(figure.of)), layout="constrained")
    panels = drawn.subplots(len(figure.of), 1, squeeze=False).ravel()
    for panel, of in zip(panels, figure.of, strict=True):
        values = _response(data, of, place)
        place_y = np.arange(len(names))
        if not _varies(values):
            panel.set_title(f"The {findings.words(data, of)} is the same in all cases", fontsize=9)
            panel.set_axis_off()
            continue
        if sobol:
            assert plan.spec.samples is not None
            found = sobol_indices(values, len(names), plan.spec.samples, plan.spec.seed)
            if found is None:
                panel.set_title(f"No indices of the {findings.words(data, of)} are known")
                continue
            _bars(panel, place_y - 0.2, 0.38, found.first, found.first_interval, "C0", "first order: the input alone")
            _bars(panel, place_y + 0.2, 0.38, found.total, found.total_interval, "C1", "total: with its interactions")
            panel.set(xlabel=f"share of the variance of {data[of].attrs['long_name']} ({found.samples} base samples)")
            panel.set_title(findings.share(findings.words(data, of), words, found.total), fontsize=9)
            panel.set_xlim(left=min(0.0, panel.get_xlim()[0]))
        else:
            x = np.stack([data[name].to_numpy() for name in names], axis=1)
            correlation, interval = rank_correlation(x, values)
            _bars(panel, place_y, 0.6, correlation, interval, "C0", "Spearman, 95 % interval")
            panel.set(xlabel=f"rank correlation with {data[of].attrs['long_name']}", xlim=(-1.05, 1.05))
            panel.set_title(findings.strongest(findings.words(data, of), words, correlation, interval), fontsize=9)
        panel.axvline(0.0, color="k", lw=0.6)
        panel.set_yticks(place_y, words)
        panel.invert_yaxis()
    drawn_one = next((panel for panel in panels if panel.patches), None)
    if drawn_one is None:
        return None
    drawn_one.legend(fontsize=7)
    return drawn


def _bars(
    axes: Axes, y: np.ndarray, height: float, values: np.ndarray, interval: np.ndarray, colour: str, label: str
) -> None:
    reach = np.abs(interval.T - values)
    thin = {"lw": 0.8, "capsize": 2}
    # lists: of an array with one column matplotlib takes a row for a number
    axes.barh(y, values, height, xerr=np.nan_to_num(reach).tolist(), color=colour, label=label, error_kw=thin)


def convergence(figure: Figure, plan: Plan, data: xr.Dataset, place: Any) -> Any:
    """Relative distance of each response from its value at the maximum value of the input, over that input."""
    names = [name for name in plan.names if data[name].dtype.kind == "f"]
    if not names:
        return None
    drawn = Figure(figsize=(1.2 + 2.9 * len(names), 3.6), layout="constrained")
    panels = drawn.subplots(1, len(names), sharey=True, squeeze=False).ravel()
    inputs, last = np.array(plan.rows, dtype=object), []
    for panel, name in zip(panels, names, strict=True):
        others = [k for k, other in enumerate(plan.names) if other != name]
        ray = (inputs[:, others] == inputs[0, others]).all(axis=1)  # only this input differs from the base case
        x = data[name].to_numpy()[ray]
        order = np.argsort(x)
        for k, of in enumerate(figure.of):
            values = _response(data, of, place)[ray][order]
            error = np.abs(values[:-1] / values[-1] - 1.0)
            last += [error[-1]] if k == 0 and len(error) else []
            panel.loglog(x[order][:-1], error, "o-", ms=3, lw=1.2, color=f"C{k}", label=data[of].attrs["long_name"])
        panel.set(xlabel=_axis(data, name), ylabel="relative distance from the finest")
        panel.set_title(f"base {inputs[0, plan.names.index(name)]}, finest {x.max():g}", fontsize=9)
        panel.xaxis.set_minor_locator(NullLocator())
        panel.set_xticks(np.unique(x)[:-1], [f"{value:g}" for value in np.unique(x)[:-1]])
        panel.label_outer()
        panel.grid(lw=0.3, which="both")
    panels[0].legend(fontsize=7)
    if last and np.isfinite(last).all():
        drawn.suptitle(findings.refinement(data, figure.of[0], last))
    return drawn


DRAW = {
    "lines": lines,
    "map": contours,
    "characteristics": characteristics,
    "scatter": scatter,
    "sensitivity": sensitivity,
    "convergence": convergence,
}
FILES = tuple(f"[0-9][0-9]_{kind}.png" for kind in DRAW)
"""Patterns of their names."""
