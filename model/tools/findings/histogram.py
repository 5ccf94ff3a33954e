"""Histogram of a limited result, with its limits."""

import numpy as np

from coilset.model.tools.figures.panels.panel import COLOURS, Panel, axis, upright
from coilset.model.tools.findings.capability import Capability


def histogram(found: Capability) -> Panel:
    """Number of cases over the result, limits as dashed lines."""
    limit = found.limit
    count, edges = np.histogram(found.values, bins="auto")
    lines = [upright(value, f"{value:.5g}") for value in (limit.low, limit.high)]
    trace = {
        "type": "scatter",
        "mode": "lines",
        "x": np.repeat(edges, 2),
        "y": np.pad(np.repeat(count, 2).astype(float), 1),
        "line": {"color": COLOURS[0], "width": 1.5},
        "showlegend": False,
    }
    title = f"{limit.words}: {100 * found.outside[0]:.2g} % outside, Cpk {found.cpk[0]:.2f}"
    return Panel(
        f"limits_{limit.name}",
        title,
        f"{title}. Number of cases over the result.",
        [trace],
        {
            "xaxis": axis(limit.words),
            "yaxis": axis("cases", rangemode="tozero"),
            "shapes": [shape for line in lines for shape in line["shapes"]],
            "annotations": [note for line in lines for note in line["annotations"]],
        },
        note=f"{found.advice}; from {found.by}.",
    )
