"""Figures of the seats: path of the force centre, pressure along the end coils, active turns."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from coilset.meshes.springs.ends import ENDS
from coilset.model.base.style import STYLE
from coilset.model.figures.figures import save
from coilset.model.results.records.labels import decimals, in_legend, named_phases, plain, unnamed
from coilset.model.results.records.record import ContactRecord, Result, Setup

COLOURS = {"bottom": "C0", "top": "C1"}
DRAWN = {  # both curves of a symmetric spring stay visible
    "bottom": {"color": "C0", "lw": 3.0, "alpha": 0.45, "ms": 5.0},
    "top": {"color": "C1", "lw": 1.0, "ms": 2.5},
}
LINES = ("-", "--", ":", "-.")  # of the phases' targets
TURNS = (  # what is drawn of them: name in the records, words, line
    ("active_turns", "active", {"color": "C2", "lw": 1.0, "ms": 2.5}),
    ("free_turns", "without contact", {"color": "0.5", "lw": 1.0, "ms": 2.5}),
)
OVER_LINES: dict[str, Any] = {"frameon": True, "framealpha": 0.8, "edgecolor": "none"}  # legends where there is no room
NAMED_STEPS = 12  # at most; of more, the places of nine are named
FAINT = 0.02  # part of the maximum force below which a force centre says little and is not drawn
REACH = 1.3  # of the picture, in coil radii
CENTRED = 0.002  # of the coil radius: a force that passes nearer to the axis is centred
NEAREST = 0.05  # of the coil radius: what a picture of force centres near the axis shows at least
DECADES = 3  # of the pressure's colours
LEAST_TURNS = 0.2  # shown from the tip on, even without contact


def phases(result: Result) -> dict[int, list[int]]:
    """Numbers of the steps of each phase, a dict by the phase's number."""
    found: dict[int, list[int]] = {}
    for number, step in enumerate(result.steps):
        found.setdefault(step.phase, []).append(number)
    return found


def phase_styles(setup: Setup) -> list[str]:
    """Line of each phase, the same where the target is."""
    return [LINES[number % len(LINES)] for number, _ in named_phases(setup.phases, len(LINES))]


def name_styles(axes: Axes, setup: Setup) -> None:
    """Name the line of each target in the legend."""
    for number, name in named_phases(setup.phases, len(LINES)):
        if name is not None:
            axes.plot([], [], LINES[number], lw=1.0, color="k", label=in_legend(name))
    if more := unnamed(setup.phases, len(LINES)):
        axes.plot([], [], " ", label=more)


def column(result: Result, end: str, name: str) -> np.ndarray:
    """One entry of an end's SeatReactions over the steps."""
    return np.array([getattr(getattr(one, end), name) for one in result.seats])


def force_centre(path: str | Path, setup: Setup, result: Result) -> None:
    """Path of the force centre on both seats, seen along the axis, and its distance from the axis over travel."""
    travel = np.array([step.travel_mm for step in result.steps])
    force = np.abs([step.force_N for step in result.steps])
    strong = force > FAINT * force.max()
    styles = phase_styles(setup)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 4.3), layout="constrained")
        plan, over = figure.subplots(1, 2, width_ratios=(1, 1.15))
        for end in ENDS:
            turns = np.linspace(0.0, min(1.0, setup.spring.turns), 121)
            turns = turns if end == "bottom" else setup.spring.turns - turns
            coil = setup.spring.centre_line(turns)
            plan.plot(*coil[:, :2].T, color=COLOURS[end], lw=0.6, alpha=0.6)
            plan.plot(*coil[0, :2], "s", color=COLOURS[end], ms=5, label=f"wire's tip at the {end}")
            x, y, distance, px, py = (
                np.where(strong, column(result, end, f"{name}_mm"), np.nan)
                for name in ("centre_x", "centre_y", "eccentricity", "pressure_x", "pressure_y")
            )
            plan.plot(px, py, "-", color=COLOURS[end], lw=3.5, alpha=0.25, label=f"centre of pressure, {end}")
            for index, steps in phases(result).items():
                joined = steps if index == 0 or steps[0] == 0 else [steps[0] - 1, *steps]
                style = styles[index]
                plan.plot(x[joined], y[joined], style, marker="o", ms=2.5, lw=1.0, color=COLOURS[end])
                over.plot(travel[joined], distance[joined], style, marker="o", **DRAWN[end])
        radius = float(np.hypot(*setup.spring.centre_line(np.array([0.0, setup.spring.turns]))[:, :2].T).max())
        plan.plot(0, 0, "k+", ms=9)
        plan.set(
            aspect="equal",
            xlabel="x in mm",
            ylabel="y in mm",
            title=_at_greatest(result, force, radius),
            xlim=(-REACH * radius, REACH * radius),
            ylim=(-REACH * radius, REACH * radius),
        )
        plan.legend(fontsize=6.5, loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)  # clear of the ring
        for end in ENDS:
            over.plot([], [], "-", marker="o", **DRAWN[end], label=f"{end} seat")
        name_styles(over, setup)
        if _reach(result, strong, radius) > radius:
            over.axhline(radius, color="0.6", lw=0.8, ls="--", label="coil radius at the tip")
        over.set(
            xlabel="travel in mm",
            ylabel="distance of the force centre from the axis in mm",
            ylim=(0.0, _reach(result, strong, radius)),
            title=_farthest(result, strong),
        )
        over.legend(fontsize=7, **OVER_LINES)
        for axes in (plan, over):
            axes.grid(lw=0.3)
        save(figure, path)


def _at_greatest(result: Result, force: np.ndarray, setup_radius: float) -> str:
    """Where the greatest force passes; the coil's radius, mm, says what is centred."""
    step = int(np.argmax(force))
    if not force[step]:
        return "No force acts on the seats"
    away = max(getattr(result.seats[step], end).eccentricity_mm for end in ENDS)
    if away < CENTRED * setup_radius:
        return f"At {plain(float(force[step]))} N the force is centred within {_roughly(max(away, 0.001))} mm"
    return f"At {plain(float(force[step]))} N the force passes {_roughly(away)} mm beside the axis"


def _farthest(result: Result, strong: np.ndarray) -> str:
    """How far from the axis the force passes in the `strong` steps; nothing of an unloaded spring."""
    if not strong.any():
        return ""
    away = max((column(result, end, "eccentricity_mm")[strong].max(initial=0.0) for end in ENDS), default=0.0)
    return f"It passes up to {_roughly(away)} mm beside the axis"


def _reach(result: Result, strong: np.ndarray, radius: float) -> float:
    """How far from the axis the curves are shown, mm: as far as they go, up to REACH coil radii."""
    away = max((column(result, end, "eccentricity_mm")[strong].max(initial=0.0) for end in ENDS), default=0.0)
    return float(np.clip(1.15 * away, NEAREST * radius, REACH * radius))


def _roughly(distance: float) -> str:
    """Two figures of it, without an exponent."""
    return f"{float(f'{distance:.2g}'):g}"


def seat_pressure(path: str | Path, setup: Setup, result: Result) -> None:
    """Pressure along both end coils in every step, length of wire in contact, and active turns; nothing without seats.

    Args:
        path: PNG to write.
        setup, result: of the run.
    """
    seats = {
        contact.end: (kind, contact)
        for kind, contact in enumerate(setup.contacts)
        if contact.end and len(contact.wire_turns)
    }
    if not seats or not result.seats:
        return
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 6.4), layout="constrained")
        (*maps,), (lengths, turns) = figure.subplots(2, 2)
        kinds = [kind for kind, _ in seats.values()]
        rows = np.concatenate([one.pressure for one in result.seats])
        greatest = rows[np.isin(rows[:, 0], kinds), 2].max(initial=1e-9)
        shown = None
        for axes, (end, (kind, contact)) in zip(maps, seats.items(), strict=False):
            shown = draw_pressure(axes, result, kind, contact, greatest) or shown
            there = rows[rows[:, 0] == kind, 2].max(initial=0.0)
            pressure = f"up to {plain(there, 3)} N/mm" if there else "no contact"
            axes.set_title(f"Pressure on the {end} seat: {pressure}")
        if shown is not None:
            figure.colorbar(shown, ax=maps, label="force per length of wire in N/mm", format="{x:g}")
        most = result.seats[int(np.argmax(np.abs([step.force_N for step in result.steps])))]
        _over_travel(
            lengths, setup, result, [(column(result, end, "length_mm"), f"{end} seat", DRAWN[end]) for end in seats]
        )
        bearing = " and ".join(plain(getattr(most, end).length_mm, 3) for end in seats)
        lengths.set(
            xlabel="travel in mm",
            ylabel="wire in contact with the seat in mm",
            title=f"Maximum force: {bearing} mm in contact",
        )
        _over_travel(
            turns,
            setup,
            result,
            [
                (shown_turns(setup, result, name), words + _beyond(setup, result, name), drawn)
                for name, words, drawn in TURNS
            ],
        )
        turns.set(
            xlabel="travel in mm",
            ylabel="turns",
            ylim=(0.0, most_turns(setup)),
            title=_active(most.active_turns, most_turns(setup)),
        )
        save(figure, path)


def _over_travel(
    axes: Axes, setup: Setup, result: Result, curves: Sequence[tuple[np.ndarray, str, dict[str, Any]]]
) -> None:
    """Values of the steps over travel, with their names and styles, in the line of each phase."""
    travel, styles = np.array([step.travel_mm for step in result.steps]), phase_styles(setup)
    for index, steps in phases(result).items():
        for values, _name, drawn in curves:
            axes.plot(travel[steps], values[steps], styles[index], marker="o", **drawn)
    for _values, name, drawn in curves:
        axes.plot([], [], "-", marker="o", **drawn, label=name)
    name_styles(axes, setup)
    axes.legend(fontsize=7, **OVER_LINES)
    axes.grid(lw=0.3)


def _active(turns: float, most: float) -> str:
    """How many turns bear the greatest force; where these are beyond what is shown, or NaN, they say nothing."""
    return f"Maximum force: {turns:.3g} active turns" if turns <= most else "Turns over travel"


def _beyond(setup: Setup, result: Result, name: str) -> str:
    """How many steps have more turns than are shown; empty if none has."""
    beyond = sum(getattr(one, name) > most_turns(setup) for one in result.seats)
    return f" (beyond {most_turns(setup):g} turns: {beyond} of the steps)" if beyond else ""


def most_turns(setup: Setup) -> float:
    """The most active turns that a figure shows: those of a spring that bears on its tips alone."""
    return 1.5 * setup.spring.turns


def shown_turns(setup: Setup, result: Result, name: str) -> np.ndarray:
    """Turns over the steps, NaN beyond what is shown.

    Where coils roll over each other near block, the torque changes while the force hardly does. The turns that bear
    this change are then any number, and lines to them would cover all else.
    """
    values = np.array([getattr(one, name) for one in result.seats])
    return np.where(values <= most_turns(setup), values, np.nan)


def draw_pressure(axes: Axes, result: Result, kind: int, contact: ContactRecord, greatest: float) -> Any:
    """Pressure of one kind of contact as colour over the place along the wire and the step; None if there is none."""
    rows = [one.pressure[one.pressure[:, 0] == kind] for one in result.seats]
    away = contact.turns_from_tip
    bearing = np.unique(np.concatenate(rows)[:, 1].astype(int))
    if not len(bearing):
        return None
    reach = max(LEAST_TURNS, away[bearing].max())
    points = np.flatnonzero(away <= reach + 1e-9)
    points = points[np.argsort(away[points])]
    values = np.zeros((len(rows), len(away)))
    for i, one in enumerate(rows):
        values[i, one[:, 1].astype(int)] = one[:, 2]
    values = np.ma.masked_equal(values[:, points], 0.0)
    norm = LogNorm(10.0**-DECADES * greatest, greatest)
    number = [step.number for step in result.steps]
    shown = axes.pcolormesh(away[points], number, values, norm=norm, cmap="viridis", shading="nearest")
    named = len(number) if len(number) <= NAMED_STEPS else 9
    places = np.unique(np.linspace(0, len(number) - 1, named).astype(int))
    travels = [result.steps[k].travel_mm for k in places]
    forces = [abs(result.steps[k].force_N) for k in places]
    a, b = decimals(max(map(abs, travels))), decimals(max(forces))
    labels = [f"{travel:.{a}f} mm, {force:,.{b}f} N" for travel, force in zip(travels, forces, strict=True)]
    axes.set_yticks([number[k] for k in places], labels, fontsize=7)
    axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.set(xlim=(-0.02 * reach, None), xlabel="turns from the wire's tip", ylabel="step" if kind == 1 else None)
    return shown
