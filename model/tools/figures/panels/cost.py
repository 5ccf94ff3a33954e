"""The cost of the run, and the accuracy of its forces."""

import numpy as np

from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.labels import largest_errors
from coilset.model.tools.figures.panels.panel import COLOURS, Panel, axis, curve


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
    """Estimated error of the force by all causes, and by the steps alone; None if unknown, or of a torsion spring."""
    columns = {"all causes": "estimated_force_error_N", "steps alone, signed": "steps_force_error_N"}
    known = {
        label: run.data[name].values
        for label, name in columns.items()
        if name in run.data and np.isfinite(run.data[name].values).any()
    }
    if not known or run.is_turned:
        return None
    last = run.summary["estimated_force_error_N"]
    finding = (
        "Error of the force"
        if last is None
        else f"The maximum force is estimated to be within {last:.2g} N; the largest part is from "
        f"{largest_errors(run.summary.get('estimated_errors'))}"
    )
    steps = run.data["step"].values
    return Panel(
        "step_error",
        finding,
        f"{finding}. Estimated error of the force at each step.",
        [curve(steps, values, k, marker=5, name=label) for k, (label, values) in enumerate(known.items(), 1)],
        {"xaxis": axis("step"), "yaxis": axis("error of the force, N")},
        height=320,
    )
