"""Files of a nest: summary.json, nest.csv and characteristic.png; each spring has a folder of its own beside them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.compose.run_files import write_run
from coilset.model.compose.summary import summarise
from coilset.model.core.results.files.folder import RESULTS, clear, prepare, subfolder, write_summary, write_table
from coilset.model.core.results.quantities import greatest_force, quantity
from coilset.model.core.results.records.provenance import origin
from coilset.model.tools.figures.panels.panel import GREY, Panel, axis, curve, upright
from coilset.model.tools.figures.png import write_png
from coilset.model.tools.nest.file import NAMES
from coilset.model.tools.nest.nest import Pressed

STEPS = "nest.csv"
COLUMNS = ("step", "seat_height_mm", "force_N", "outer_force_N", "inner_force_N", "clearance_mm")


def summary(pressed: Pressed) -> dict[str, Any]:
    """The content of summary.json, as plain data; of a spring that was not reached the summary is None."""
    plan, after = pressed.plan, pressed.free_length_after
    tight = int(np.argmin(pressed.clearance))
    height, force, error = pressed.closing()
    return {
        "free_length_before_mm": plan.free_length,
        "free_length_after_mm": after,
        "set_mm": None if after is None else plan.free_length - after,
        "estimated_set_error_mm": pressed.set_error,
        "block_height_mm": plan.block,
        "force_max_N": float(pressed.force.max()),
        "estimated_force_error_N": pressed.force_error,
        "closing_force_N": force,
        "closing_height_mm": height,
        "estimated_closing_force_error_N": error,
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


def write(folder: Path, pressed: Pressed, force: bool = False, pictures: bool = True) -> dict[str, Any]:
    """Write all files into a folder, and the summary, which is returned.

    Args:
        folder: made if need be.
        pressed: the nest after its run.
        force: replace results that the folder holds.
        pictures: draw characteristic.png, too.
    """
    prepare(folder, force)
    members = [folder / name for name in NAMES]  # of a spring that the seats no longer reach, too
    for one in (folder, *(member for member in members if not member.is_symlink())):
        clear(one, (*RESULTS, STEPS, "report.html"))
    found = summary(pressed)
    for member in pressed.members:
        if member.result is not None:
            subfolder(folder, member.name)
            own = {name: value for name, value in found[member.name].items() if name != "origin"}
            write_run(folder / member.name, member.setup, member.result, own, found[member.name]["origin"])
    values = pressed.plan.heights, pressed.force, *pressed.forces, pressed.clearance
    rows = enumerate(zip(*(column.tolist() for column in values), strict=True))
    write_table(folder / STEPS, COLUMNS, ([number, *row] for number, row in rows))
    if pictures:
        columns = dict(zip(COLUMNS[1:], values, strict=True))
        write_png(folder / "characteristic.png", [characteristic(columns, found)])
    write_summary(folder, found)
    return found


def headline(found: Mapping[str, Any]) -> str:
    """Maximum force and set of a nest, of its summary."""
    lost = "" if found["set_mm"] is None else f", set {quantity(found, 'set_mm').text}"
    force = quantity(found, greatest_force(found))
    return f"{force.words[0].upper()}{force.words[1:]} {force.text}{lost}".replace("-", "−")


def characteristic(columns: Mapping[str, np.ndarray], found: Mapping[str, Any]) -> Panel:
    """Force over the travel of the common seats, of each spring and of both.

    Args:
        columns: of nest.csv.
        found: `summary`.
    """
    travel = columns["seat_height_mm"][0] - columns["seat_height_mm"]
    block = found["free_length_before_mm"] - found["block_height_mm"]
    finding = headline(found)
    return Panel(
        "characteristic",
        finding,
        f"{finding}. Axial force of the outer spring, of the inner spring and of both over the travel of the seats. "
        f"Block is at {block:.4g} mm of travel.",
        [
            curve(travel, columns["force_N"], GREY, marker=5, width=3.0, name="both"),
            *(curve(travel, columns[f"{name}_force_N"], k, marker=5, name=name) for k, name in enumerate(NAMES)),
        ],
        {
            "xaxis": axis("travel of the seats, mm"),
            "yaxis": axis("axial force, N"),
            **upright(block, f"block, {found['block_height_mm']:.4g} mm high"),
        },
        height=440,
        note="Both springs are then released, each on its own; their pages show it.",
    )
