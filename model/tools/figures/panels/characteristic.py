"""Force over travel, and the rate along it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from coilset.model.core.base.between_steps import UNKNOWN, Between, closed_rate, part
from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.quantities import quantity
from coilset.model.core.results.records.labels import MOST_DECIMALS, last_released, plain, within
from coilset.model.physics.working.working import number_name
from coilset.model.tools.figures.panels.panel import COLOURS, GREY, Panel, axis, curve, upright
from coilset.model.tools.figures.panels.phases import Phase, phases, unnamed

HEIGHT = 440  # pixels, the same for both, which stand side by side
NAMED = len(COLOURS)  # targets
SHORT = 0.25  # of the travel to block: an arrow of the set that its text would hide
AGAIN = "For the second loading, add a phase to the load program, such as “- to: {}”, and solve again."


def characteristic(run: Run) -> Panel:
    """Force over travel, one line per phase, with the initial rate, block and set; torque over rotation in torsion."""
    if run.is_turned:
        return torque_curve(run)
    summary, found = run.summary, phases(run, NAMED)
    traces = []
    for phase, between in _curves(run, found):
        colour = phase.number if phase.number < NAMED else GREY
        entry: dict[str, Any] = {"name": phase.label, "legendgroup": phase.label}
        traces.append(curve(*between.drawn(), colour, hoverinfo="skip", showlegend=phase.named, **entry))
        steps = curve(between.travel, between.force, colour, marker=5, showlegend=False, **entry)
        traces.append(steps | {"mode": "markers", "marker": {"size": 5, "color": steps["line"]["color"]}})
    traces += unnamed(found, NAMED)
    greatest, rate, set_mm = summary["force_max_N"], summary["rate_N_per_mm"], summary["set_mm"]
    opened, held = (summary.get(name) for name in ("open_rate_N_per_mm", "initial_tension_N"))
    if opened and held:  # the initial rate is that of coils that touch
        start = -held / rate if rate else 0.0
        x = np.array([float(np.nanmin(run.data["travel_mm"].values)), start])
        name = f"{_held(summary)} + {opened:.4g} N/mm · s from where the coils open"
        traces.append(curve(x, opened * (x - start) - held, GREY, dash="dot", width=1.2, name=name))
    elif rate:
        travels = np.abs(run.data["travel_mm"].values)
        end = min(abs(greatest) / rate, float(np.nanmax(travels, initial=0.0)) or 1.0)
        x, name = np.array([0.0, np.copysign(end, greatest)]), f"initial rate {rate:.4g} N/mm"
        traces.append(curve(x, rate * x, GREY, dash="dot", width=1.2, name=name))
    traces += _working(summary)
    block = summary["free_length_before_mm"] - summary["block_height_mm"]
    closing = summary.get("closing_force_N")
    force = f"up to {plain(abs(greatest))} N" if closing is None else f"{plain(closing)} N where the coils close"
    finding = f"{compressed(greatest)} with {force}{_outcome(summary)}"
    layout = upright(block, f"block, {summary['block_height_mm']:.4g} mm high")
    if greatest < 0.0:
        layout = {"annotations": []}
    if set_mm and not opened:  # an extension spring sets in its initial tension first
        layout["annotations"] += _arrow(summary, block)
    return Panel(
        "characteristic",
        finding,
        f"Axial force over travel. {finding}.{'' if greatest < 0.0 else f' Block is at {block:.4g} mm of travel.'}",
        traces,
        {"xaxis": axis("travel, mm"), "yaxis": axis("axial force, N"), **layout},
        height=HEIGHT,
        note="" if set_mm is None or len(found) > 2 else AGAIN.format(_again(run)),
    )


def _again(run: Run) -> str:
    """A target of a second loading; a spring that is pulled, or has hooks or arms, does not go to block."""
    greatest, spring = run.summary["force_max_N"], run.case["spring"]
    pressed = greatest >= 0.0 and not (spring.get("hooks") or spring.get("arms"))
    return "block" if pressed else f"{{force: {greatest:.5g}}}"


def torque_curve(run: Run) -> Panel:
    """Torque over the rotation of the top head against the bottom one, one line per phase, with rate and set."""
    summary, found, traces = run.summary, phases(run, NAMED), []
    for phase, turned in _curves(run, found, ("turn_deg", "torque_Nmm")):
        colour = phase.number if phase.number < NAMED else GREY
        traces.append(curve(turned.travel, turned.force, colour, marker=5, name=phase.label, showlegend=phase.named))
    traces += unnamed(found, NAMED)
    greatest, rate, most = (summary[name] for name in ("torque_max_Nmm", "turn_rate_Nmm_per_deg", "turn_max_deg"))
    x = np.array([0.0, np.copysign(min(abs(greatest / rate), abs(most)), most)])
    traces.append(curve(x, rate * x, GREY, dash="dot", width=1.2, name=f"rate {rate:.4g} N mm/°"))
    set_deg = summary["turn_set_deg"]
    left = "" if set_deg is None else f", the spring sets {plain(set_deg)}°".replace("-", "−")
    finding = f"Turned by {plain(most)}° with up to {plain(abs(greatest))} N mm{left}".replace("-", "−")
    return Panel(
        "characteristic",
        finding,
        f"Torque over rotation. {finding}.",
        traces,
        {"xaxis": axis("rotation, °"), "yaxis": axis("torque, N mm")},
        height=HEIGHT,
    )


def _working(summary: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Points of the finished spring at its working states."""
    states = [state for state in summary.get("working") or () if not state["reason"]]
    if not states:
        return []
    travel = [summary["free_length_before_mm"] - state["length_mm"] for state in states]
    marker = {"size": 9, "symbol": "square", "color": GREY}
    trace = {"type": "scatter", "mode": "markers", "x": travel, "y": [state["force_N"] for state in states]}
    found = [trace | {"marker": marker, "name": "working lengths"}]
    limits = {limit["name"]: limit for limit in summary.get("limits") or ()}
    for state, at in zip(states, travel, strict=True):
        if limit := limits.get(number_name("force", state.get("length_wanted") or 0.0)):
            ends = [limit["low"], limit["high"]]
            found.append(curve([at] * 2, ends, GREY, 7, name="limits", showlegend=len(found) == 1))
    return found


def _curves(
    run: Run, found: list[Phase], names: tuple[str, str] = ("travel_mm", "force_N")
) -> Iterator[tuple[Phase, Between]]:
    """Force (N) over travel (mm), or other columns, of each phase, from the end of the one before on."""
    travel, force = (np.append(0.0, run.data[name].values) for name in names)
    count = run.data["contacts"].values if names[1] == "force_N" else np.zeros(len(travel) - 1)
    closed = closed_rate(run.case, run.summary["rate_N_per_mm"]) if names[1] == "force_N" else UNKNOWN
    for phase in found:
        first, last = int(phase.steps[0]), int(phase.steps[-1]) + 1
        yield phase, part(travel, force, np.append(count[:1], count), first, last, closed)


def _held(summary: Mapping[str, Any], when: str = "") -> str:
    """The initial tension, before or `_after` the last release, with its error."""
    return quantity(summary, f"initial_tension{when}_N").text


def compressed(force: float) -> str:
    """The word for a load program by its maximum force."""
    return "Pulled" if force < 0.0 else "Compressed"


def _outcome(summary: Mapping[str, Any]) -> str:
    """The set, or the load that was lost; empty if the spring was not released."""
    set_mm, stays, released = summary["set_mm"], summary.get("load_losses") or [], last_released(summary)
    before, after = (summary.get(name) for name in ("initial_tension_N", "initial_tension_after_N"))
    if before and after:
        return f", the initial tension falls from {_held(summary)} to {_held(summary, '_after')}"
    if set_mm is None:
        return f", the spring loses {_lost(stays)}" if len(stays) == 1 else ""
    text = _set(summary)
    left = f", the spring stays {text[1:]} mm longer" if text.startswith("-") else f", the spring sets {text} mm"
    if released is None:
        return left
    later = [one for one in stays if one["step"] > released[0]]
    return f"{left} by its last release{f' and then loses {_lost(later)}' if len(later) == 1 else ''}"


def _lost(stays: Sequence[Mapping[str, Any]]) -> str:
    return f"{plain(stays[0]['loss_percent'])} % of its load at {stays[0]['height_mm']:.4g} mm"


def _set(summary: Mapping[str, Any]) -> str:
    """The set, mm, in at most four digits that its error allows."""
    set_mm, error = summary["set_mm"], summary.get("estimated_set_error_mm")
    return plain(set_mm if error is None else float(within(set_mm, error, "mm", MOST_DECIMALS).split()[0]))


def _arrow(summary: Mapping[str, Any], block: float) -> list[dict[str, Any]]:
    """Annotations of the set; behind the arrow where that is short beside the travel to block."""
    set_mm, text = summary["set_mm"], f"set {_set(summary)} mm".replace("-", "−")
    ends = {"x": set_mm, "ax": 0, "y": 0, "ay": 0, "axref": "x", "ayref": "y", "text": "", "showarrow": True}
    place: dict[str, Any] = {"x": 0.5 * set_mm}
    if abs(set_mm) < SHORT * block:
        place = {"x": max(set_mm, 0.0), "xanchor": "left"}
    return [
        {**ends, "arrowhead": 2, "arrowside": "end+start", "arrowwidth": 1.2},
        place | {"y": 0, "yanchor": "top", "text": text, "showarrow": False},
    ]


def rate_curve(run: Run) -> Panel | None:
    """Slope of the characteristic over travel, phase by phase; None if no phase has three steps, and in torsion."""
    if run.is_turned:
        return None
    traces, found = [], phases(run, NAMED)
    for phase, between in _curves(run, found):
        if len(between.travel) > 2 and between.runs_on:
            colour = phase.number if phase.number < NAMED else GREY
            line = curve(*between.rates_drawn(), colour, name=phase.label, showlegend=phase.named)
            traces.append(line)
    if not traces:
        return None
    rate = run.summary["rate_N_per_mm"]
    first = f"The rate begins at {rate:.4g} N/mm" if rate else "The rate over the travel"
    return Panel(
        "rate",
        first,
        f"{first}. Slope of the characteristic over travel, each phase a line.",
        traces + unnamed(found, NAMED),
        {"xaxis": axis("travel, mm"), "yaxis": axis("rate, N/mm", rangemode="tozero")},
        height=HEIGHT,
    )
