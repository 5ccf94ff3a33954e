"""The Goodman diagram of a wire with a spring's working cycle."""

import numpy as np

from coilset.model.tools.figures.panels.panel import GREY, Panel, Trace, axis, curve, with_unit
from coilset.model.tools.standards.goodman import Cycle, Line


def goodman(wire: str, permitted: Line, cycle: Cycle, residual: float | None) -> Panel:
    """Goodman diagram of a wire with the working cycle, and with the residual stress added to it if there is one."""
    low = min(0.0, cycle.lower + (residual or 0.0))
    lower = np.array(sorted({low, 0.0, permitted.knee, permitted.limit}))
    upper = np.array([permitted.upper(x) for x in lower])
    name = f"permitted, {permitted.times} cycles, {permitted.surface}, {permitted.tested}"
    traces = [
        curve(lower, upper, GREY, width=2.5, name=name),
        curve([low, permitted.limit], [low, permitted.limit], GREY, dash="dot", width=1.5, name="at rest, τk2 = τk1"),
        _cycle(cycle, 0, "working cycle, nominal"),
    ]
    if residual is not None:
        traces.append(_cycle(cycle.shifted(residual), 1, f"with the computed residual {with_unit(residual, 'MPa')}"))
    allowed, span = permitted.stress_range(cycle.lower), cycle.upper - cycle.lower
    used = f"{100.0 * span / allowed:.0f} % of the permissible range" if allowed else "above the permissible range"
    finding = f"{wire}: the stress range of {span:.0f} MPa is {used}"
    return Panel(
        "goodman",
        finding,
        f"{finding}. Upper over lower corrected stress.",
        traces,
        {
            "xaxis": axis("lower corrected stress τk1, MPa"),
            "yaxis": axis("upper corrected stress τk2, MPa"),
        },
    )


def _cycle(cycle: Cycle, colour: int, name: str) -> Trace:
    return curve([cycle.lower] * 2, [cycle.lower, cycle.upper], colour, marker=7, name=name)
