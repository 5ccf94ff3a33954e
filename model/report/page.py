"""The page: the answer first, then the figures, then the case to run it again."""

import base64
import gzip
import json
from collections.abc import Callable, Iterable
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from coilset.meshes.errors import InputError
from coilset.model.report.along_wire import moments_along_wire, stress_along_wire
from coilset.model.report.answer import answer, subtitle
from coilset.model.report.bearing import contact, force_centre
from coilset.model.report.characteristic import characteristic, rate_curve
from coilset.model.report.cost import cost, step_error
from coilset.model.report.glossary import GLOSSARY
from coilset.model.report.material_curves import material_curve
from coilset.model.report.packed import packed
from coilset.model.report.panel import Panel
from coilset.model.report.section_map import normal_map, shear_map
from coilset.model.report.spring_view import spring_view
from coilset.model.results.folder import whole
from coilset.model.results.opened import Run

NAME = "report.html"
CHAPTERS: tuple[tuple[str, tuple[Callable[[Run], Panel | None], ...]], ...] = (
    ("Force and travel", (characteristic, rate_curve)),
    ("The spring", (spring_view,)),
    ("Stress in the wire", (shear_map, normal_map)),
    ("Along the wire", (stress_along_wire, moments_along_wire)),
    ("Seats and coils", (force_centre, contact)),
    ("Material", (material_curve,)),
    ("How it was computed", (cost, step_error)),
)  # chapters with what draws their figures


def write_report(run: Run) -> Path:
    """Write report.html into the folder of a run.

    Returns:
        The file.

    Raises:
        InputError: if plotly is missing. CoilsetError: if the file cannot be written.
    """
    chapters = [(title, [panel for draw in figures if (panel := draw(run)) is not None]) for title, figures in CHAPTERS]
    text = _page(run, chapters)
    path = run.folder / NAME
    with whole(path) as partial:
        partial.write_text(text, encoding="utf-8")
    return path


def _page(run: Run, chapters: Iterable[tuple[str, list[Panel]]]) -> str:
    environment = Environment(
        loader=PackageLoader("coilset.model.report", "template"),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["embedded"] = embedded
    case = yaml.safe_dump(given(run.case), sort_keys=False, allow_unicode=True)
    part = files("coilset.model.report") / "template"
    return environment.get_template("page.html").render(
        name=run.folder.resolve().name,
        subtitle=subtitle(run),
        summary=run.summary,
        answer=answer(run),
        chapters=list(chapters),
        glossary=GLOSSARY,
        case=case,
        origin=run.summary["origin"],
        style=(part / "style.css").read_text(encoding="utf-8"),
        script=(part / "script.js").read_text(encoding="utf-8"),
        plotly=_plotly(),
        figures={
            panel.name: packed({"data": panel.traces, "layout": panel.layout})
            for _, panels in chapters
            for panel in panels
        },
    )


def given(entries: Any) -> Any:
    """A case without the entries that say nothing."""
    if isinstance(entries, dict):
        return {key: given(value) for key, value in entries.items() if value is not None}
    return [given(value) for value in entries] if isinstance(entries, list) else entries


def embedded(value: Any) -> str:
    """JSON that can stand within a page's script."""
    return json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")


def _plotly() -> str:
    """The library that draws, compressed, as base64."""
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        raise InputError(
            "is not installed; the report draws with it: install python3-plotly, or pip install plotly", "", "plotly"
        ) from None
    return base64.b64encode(gzip.compress(get_plotlyjs().encode(), mtime=0)).decode("ascii")
