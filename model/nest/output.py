"""Files of a nest: summary.json, nest.csv and characteristic.png; each spring has a folder of its own beside them."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.base.style import STYLE
from coilset.model.figures.figures import save
from coilset.model.nest.nest import Pressed
from coilset.model.results.files.folder import write_table
from coilset.model.results.records.labels import plain
from coilset.model.results.records.provenance import origin
from coilset.model.results.records.summary import summarise

STEPS = "nest.csv"
COLUMNS = ("step", "seat_height_mm", "force_N", "outer_force_N", "inner_force_N", "clearance_mm")


def summary(pressed: Pressed) -> dict[str, Any]:
    """The content of summary.json, as plain data; of a spring that was not reached the summary is None."""
    plan, after = pressed.plan, pressed.free_length_after
    tight = int(np.argmin(pressed.clearance))
    return {
        "free_length_before_mm": plan.free_length,
        "free_length_after_mm": after,
        "set_mm": None if after is None else plan.free_length - after,
        "block_height_mm": plan.block,
        "force_max_N": float(pressed.force.max()),
        "clearance_min_mm": float(pressed.clearance[tight]),
        "clearance_min_height_mm": float(plan.heights[tight]),
        **{
            member.name: None
            if member.result is None
            else {**summarise(member.setup, member.result), "origin": origin(member.case)}
            for member in pressed.members
        },
        "warnings": [vars(warning) for warning in pressed.warnings],
    }


def write_steps(path: Path, pressed: Pressed) -> None:
    """nest.csv: one row a step of the seats, the start first."""
    rows = zip(pressed.plan.heights, pressed.force, *pressed.forces, pressed.clearance, strict=True)
    write_table(path, COLUMNS, ([number, *(float(value) for value in row)] for number, row in enumerate(rows)))


def headline(found: dict[str, Any]) -> str:
    """Maximum force and set of a nest, of its summary."""
    lost = "" if found["set_mm"] is None else f", set {found['set_mm']:z.2f} mm".replace("-", "−")
    return f"Maximum force {plain(found['force_max_N'], 5)} N{lost}"


def draw(path: Path, pressed: Pressed, found: dict[str, Any]) -> None:
    """Force over height, of both and of each."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes, heights = figure.add_subplot(), pressed.plan.heights
        axes.plot(heights, pressed.force, "ko-", ms=3, lw=1.3, label="both")
        for number, (member, force) in enumerate(zip(pressed.members, pressed.forces, strict=True)):
            axes.plot(heights, force, "o-", ms=3, lw=1.0, color=f"C{number}", label=member.name)
        axes.axvline(pressed.plan.block, color="0.6", lw=0.8, ls="--", label=f"block, {pressed.plan.block:.4g} mm high")
        axes.invert_xaxis()
        axes.set(xlabel="height in mm", ylabel="axial force in N", title=headline(found))
        axes.legend(fontsize=8)
        axes.grid(lw=0.3)
        save(figure, path)
