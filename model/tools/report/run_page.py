"""The page of a run: the answer first, then the figures, then the case to run it again."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.order_of_warnings import messages_in_order
from coilset.model.tools.figures.panels.along_wire import moments_along_wire, stress_along_wire
from coilset.model.tools.figures.panels.buckling import buckling_axis, buckling_mode
from coilset.model.tools.figures.panels.characteristic import characteristic, rate_curve
from coilset.model.tools.figures.panels.cost import cost, step_error
from coilset.model.tools.figures.panels.fatigue import fatigue_map, fatigue_view
from coilset.model.tools.figures.panels.force_line import (
    side_force,
    side_view_x,
    side_view_y,
    sideways,
    tilt_moments,
    tilts,
    view_along_axis,
)
from coilset.model.tools.figures.panels.material_curves import material_curve
from coilset.model.tools.figures.panels.panel import Panel
from coilset.model.tools.figures.panels.seats import active_turns, contact, contact_length, eccentricity, force_centre
from coilset.model.tools.figures.panels.section_map import normal_map, shear_map
from coilset.model.tools.figures.panels.spring_view import spring_view
from coilset.model.tools.report.answer import answer, lists, subtitle
from coilset.model.tools.report.first_sheet import first_sheet
from coilset.model.tools.report.maker_sheet import maker_sheet
from coilset.model.tools.report.render import write_page

CHAPTERS: tuple[tuple[str, tuple[Callable[[Run], Panel | None], ...]], ...] = (
    ("Force and travel", (characteristic, rate_curve)),
    ("The spring", (spring_view,)),
    ("Stress in the wire", (shear_map, normal_map)),
    ("Along the wire", (stress_along_wire, moments_along_wire)),
    ("Fatigue", (fatigue_map, fatigue_view)),
    ("Seats and coils", (force_centre, eccentricity, contact, contact_length, active_turns)),
    ("Side load", (side_view_x, side_view_y, view_along_axis, side_force, sideways, tilts, tilt_moments)),
    ("Buckling", (buckling_mode, buckling_axis)),
    ("Material", (material_curve,)),
    ("How it was computed", (cost, step_error)),
)  # chapters and the functions that draw their figures


def write_report(run: Run) -> Path:
    """Write report.html into the folder of a run.

    Returns:
        The file.

    Raises:
        InputError: if plotly is missing, or the run has no steps. CoilsetError: if the file cannot be written.
    """
    run.require_steps()
    chapters = [(title, [panel for draw in figures if (panel := draw(run)) is not None]) for title, figures in CHAPTERS]
    if run.is_turned:
        chapters[0] = "Torque and rotation", chapters[0][1]
    found, (case, files) = answer(run.summary), complete(run)
    return write_page(
        run.folder,
        "run",
        chapters,
        {},
        title=f"{run.folder.resolve().name}: set {found[0].value}",
        subtitle=subtitle(run),
        summary=run.summary,
        answer=found,
        sheet=maker_sheet(run),
        first=first_sheet(run),
        warnings=messages_in_order(run.summary),
        lists=lists(run.summary),
        case=_text(case),
        files=files,
        made_with=made_with(run.summary["origin"]),
    )


def complete(run: Run) -> tuple[dict[str, Any], dict[str, str]]:
    """The case without its author's folders, and the texts of the files beside it by their names.

    A material file is written from the constants that the results hold; a measured spring's file is named without its
    folder.
    """
    case, files = given(run.case), {}
    material, scan = case["material"], case["spring"].get("file")
    if isinstance(material, str) and material.endswith((".yaml", ".yml")):
        case["material"] = Path(material).name
        files[case["material"]] = _text(given(run.summary["origin"]["material"]))
    if scan is not None:
        case["spring"] = {**case["spring"], "file": Path(scan).name}
    return case, files


def _text(entries: dict[str, Any]) -> str:
    return yaml.safe_dump(entries, sort_keys=False, allow_unicode=True)


def made_with(origin: dict[str, Any]) -> str:
    """Versions, date and machine, in a line."""
    return f"{origin['versions']}; {origin['date']}; {origin['platform']}"


def given(entries: Any) -> Any:
    """A case without its empty entries."""
    if isinstance(entries, dict):
        return {key: given(value) for key, value in entries.items() if value is not None}
    return [given(value) for value in entries] if isinstance(entries, list) else entries
