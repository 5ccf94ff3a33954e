"""The page of a nest: total force, share of each spring, and the clearance between them."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError, reading
from coilset.model.core.base.style import round_end
from coilset.model.core.case import Case, check
from coilset.model.core.results.files.folder import subfolder
from coilset.model.core.results.files.opened import Run, open_run
from coilset.model.core.results.quantities import greatest_force, quantity
from coilset.model.tools.checks.check import sentence
from coilset.model.tools.checks.nested import nested
from coilset.model.tools.figures.panels.panel import Panel, Trace, axis, curve, with_unit
from coilset.model.tools.figures.panels.spring_view import scene_of, shown_surface, surface_trace
from coilset.model.tools.figures.wire_surface import closed, frames, tubes
from coilset.model.tools.nest.file import NAMES
from coilset.model.tools.nest.output import STEPS, characteristic
from coilset.model.tools.report.answer import Number, number
from coilset.model.tools.report.render import NAME, write_page
from coilset.model.tools.report.run_page import made_with, write_report
from coilset.model.tools.sheet import from_results
from coilset.model.tools.sheet.from_results import Found

FILE = STEPS  # by which the folder of a nest is known
STRESSES = ("shear_inside_max_MPa", "residual_shear_inside_MPa")
RINGS = 320  # of a spring, at each moment
STATES = ("free", "pressed the most", "released")


def write_nest_report(folder: str | Path) -> Path:
    """Write report.html into the folder of a nest and into those of its springs.

    Returns:
        The file of the nest.

    Raises:
        InputError: if a file cannot be read. CoilsetError: if a page cannot be written.
    """
    folder = Path(folder)
    with reading(folder / "summary.json"):
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        springs = {name: summary[name] for name in NAMES}
        summary["clearance_min_mm"], summary["warnings"]
    with reading(folder / FILE):
        read = read_columns(folder / FILE)
        columns = {name: read.numbers(name) for name in read.names}
    runs = {name: open_run(folder / name) for name, one in springs.items() if one is not None}
    if not runs:
        raise InputError("neither spring was reached by the seats", "", folder)
    for name, run in runs.items():
        subfolder(folder, name)
        write_report(run)
    made = nested(summary, {name: _checked(run) for name, run in runs.items()})
    top = int(np.argmax(np.abs(columns["force_N"])))
    shares = {name: columns[f"{name}_force_N"][top] / (columns["force_N"][top] or 1.0) for name in NAMES}
    warnings = [one["message"] for one in summary["warnings"]]
    warnings += [f"{name} spring: {one['message']}" for name in runs for one in springs[name]["warnings"]]
    return write_page(
        folder,
        "nest",
        [
            ("Force and travel", [characteristic(columns, summary), clearance(columns, summary)]),
            ("The springs", [view(runs)]),
        ],
        {},
        title=f"{folder.resolve().name}: set {number(quantity(summary, 'set_mm')).value}",
        subtitle=f"two springs between the same seats, pressed to {columns['seat_height_mm'].min():.4g} mm, released",
        answer=[
            replace(
                number(quantity(summary, "set_mm")), remark="of the height at which the seats touch the first spring"
            ),
            number(quantity(summary, "free_length_after_mm")),
            replace(
                number(quantity(summary, greatest_force(summary))),
                remark=", ".join(f"{name} {100.0 * share:.0f} %" for name, share in shares.items()),
            ),
            Number(
                "block height",
                _length(summary["block_height_mm"], 2),
                "of the spring that is solid first",
            ),
            Number(
                "minimum clearance",
                _length(summary["clearance_min_mm"], 3),
                f"between the springs, at a height of {summary['clearance_min_height_mm']:.4g} mm",
            ),
        ],
        checks=made,
        verdict=sentence(made),
        springs=[_spring(name, one, shares[name], columns[f"{name}_force_N"][top]) for name, one in springs.items()],
        warnings=warnings,
        made_with=made_with(next(iter(runs.values())).summary["origin"]),
    )


def _checked(run: Run) -> tuple[Case, Spring, Found]:
    case = check(run.case)
    return case, case.spring.build(), from_results.read(run.folder)


def _length(value: float | None, digits: int) -> str:
    return with_unit(value, "mm", digits, "not released")


def _spring(name: str, summary: Mapping[str, Any] | None, share: float, force: float) -> dict[str, Any]:
    """A row of the table of both springs, and the link to its page; of a spring that was not reached only its name."""
    if summary is None:
        return {"name": name, "link": "", "cells": ["not reached by the seats"] + [""] * 6}
    own = (quantity(summary, one) for one in ("free_length_before_mm", "set_mm", *STRESSES))
    return {
        "name": name,
        "link": f"{name}/{NAME}",
        "cells": [
            summary["material"],
            number(replace(quantity(summary, "force_max_N"), value=force)).value,
            f"{100.0 * share:.1f} %",
            *(number(one).value for one in own),
        ],
    }


def clearance(columns: Mapping[str, np.ndarray], summary: Mapping[str, Any]) -> Panel:
    """Clearance between the springs over the travel of the seats."""
    travel = columns["seat_height_mm"][0] - columns["seat_height_mm"]
    finding = f"The clearance between the springs is {_length(summary['clearance_min_mm'], 2)} or more"
    return Panel(
        "clearance",
        finding,
        f"{finding}. Smallest radial clearance between outer and inner wire over the travel of the seats.",
        [curve(travel, columns["clearance_mm"], 2, marker=5, showlegend=False)],
        {"xaxis": axis("travel of the seats, mm"), "yaxis": axis("clearance, mm", rangemode="tozero")},
        height=440,
    )


def view(runs: Mapping[str, Run]) -> Panel:
    """Both springs in 3D, free, pressed the most and released, on one scale of stress."""
    shapes = [_surfaces(run) for run in runs.values()]
    greatest = max(float(np.abs(stress).max()) for _, stress in shapes)
    end = round_end(greatest)
    traces: list[Trace] = []
    for places, stress in shapes:
        for state in range(len(STATES)):
            traces.append(
                {
                    **surface_trace(end),
                    **shown_surface(places[state], stress[state]),
                    "showscale": not traces,
                    "meta": {"choice": state},
                }
            )
    for state in range(len(STATES)):  # one scale for each state, of the outer spring, or of the only one
        traces[state]["showscale"] = True
    corners = np.concatenate([places.reshape(-1, 3) for places, _ in shapes])
    low, high = corners.min(axis=0), corners.max(axis=0)
    return Panel(
        "springs",
        f"The shear stress on the wires' surfaces reaches {with_unit(greatest, 'MPa')}",
        f"Both springs in three dimensions, free, pressed the most and released, coloured by the shear stress about "
        f"the wire's axis on the surface from {-end:g} to {end:g} MPa.",
        traces,
        scene_of(np.stack([low, high])),
        choices=STATES,
        choice="state",
        height=520,
        note="Red is sheared with the load, blue against it. Drag to rotate, scroll or pinch to zoom.",
    )


def _surfaces(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Surface and stress of a spring in the three states, its lowest point at height 0."""
    shown = frames(run)
    pressed = int(np.argmin([np.ptp(x[:, 2]) for x in shown.x]))
    rings = min(2 * (run.data.sizes["station"] - 1), RINGS) + 1
    places, stress = closed(*tubes(run, shown, rings))
    kept = [0, pressed, len(shown.labels) - 1]
    places = places[kept].copy()
    places[..., 2] -= places[..., 2].min(axis=(1, 2))[:, None, None]
    return places, stress[kept]
