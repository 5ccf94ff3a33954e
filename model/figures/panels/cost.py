"""The cost of the run, and the accuracy of its steps."""

import numpy as np

from coilset.model.figures.panels.panel import COLOURS, Panel, axis, curve
from coilset.model.results.files.opened import Run


def cost(run: Run) -> Panel:
    """Iterations and evaluated states of each step."""
    step, summary = run.data["step"].values, run.summary
    traces = [
        {"type": "bar", "name": name, "x": step, "y": run.data[column].values, "marker": {"color": COLOURS[number]}}
        for number, (name, column) in enumerate((("iterations", "iterations"), ("states evaluated", "evaluations")))
    ]
    cuts = int(np.nansum(run.data["cuts"].values))
    finding = f"{summary['steps']} steps took {summary['evaluations']} evaluations" + (
        f" and {cuts} cuts" if cuts else ""
    )
    return Panel(
        "cost",
        finding,
        f"{finding}. Iterations and evaluated states of each step.",
        traces,
        {"xaxis": axis("step"), "yaxis": axis("count"), "barmode": "group"},
        height=320,
    )


def step_error(run: Run) -> Panel | None:
    """Estimated error of the force due to the step size; None if unknown."""
    error = run.data["estimated_force_error_N"].values
    if not np.isfinite(error).any():
        return None
    last = run.summary["estimated_force_error_N"]
    finding = (
        "Error of the force due to the step size"
        if last is None
        else f"The step size causes an error of about {abs(last):.2g} N in the maximum force"
    )
    return Panel(
        "step_error",
        finding,
        f"{finding}. Estimated error over the steps.",
        [curve(run.data["step"].values, error, 1, marker=5, showlegend=False)],
        {"xaxis": axis("step"), "yaxis": axis("error of the force, N")},
        height=320,
    )
