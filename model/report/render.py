"""A page from its template: one file that opens from disk without a network."""

import base64
import gzip
import json
from collections.abc import Iterable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from coilset.model.base.errors import InputError
from coilset.model.figures.panels.panel import Panel
from coilset.model.report.glossary import GLOSSARY
from coilset.model.report.packed import packed
from coilset.model.results.files.folder import whole

NAME = "report.html"
SCRIPTS = {"sweep": "sweep.js", "nest": "nest.js"}  # of kinds of pages; run.js of the others
Chapters = Sequence[tuple[str, Sequence[Panel]]]


def write_page(folder: Path, kind: str, chapters: Chapters, data: dict[str, Any], **parts: Any) -> Path:
    """Write report.html.

    Args:
        folder: to write to.
        kind: of the page, `run`, `design`, `nest` or `sweep`: its template.
        chapters: titles with their figures.
        data: what the scripts of the page take besides; arrays are packed.
        parts: what the template asks for.

    Returns:
        The file.

    Raises:
        InputError: if plotly is missing. CoilsetError: if the file cannot be written.
    """
    environment = Environment(
        loader=PackageLoader("coilset.model.report", "template"),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["glossary"] = GLOSSARY
    environment.filters["compressed"] = compressed
    text = environment.get_template(f"{kind}.html").render(
        name=folder.resolve().name,
        chapters=chapters,
        style=_part("style.css"),
        scripts=[_part("common.js"), _part(SCRIPTS.get(kind, "run.js"))],
        plotly=_plotly(),
        data={"figures": _figures(chapters), **packed(data)},
        **parts,
    )
    path = folder / NAME
    with whole(path) as partial:
        partial.write_text(text, encoding="utf-8")
    return path


def compressed(value: Any) -> str:
    """Plain data as JSON, compressed, as base64."""
    text = value if isinstance(value, str) else json.dumps(value, allow_nan=False, separators=(",", ":"))
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")


def _figures(chapters: Chapters) -> dict[str, Any]:
    panels: Iterable[Panel] = (panel for _, panels in chapters for panel in panels)
    return {
        panel.name: packed({"data": panel.traces, "layout": panel.layout, "frames": panel.frames}) for panel in panels
    }


def _part(name: str) -> str:
    return (files("coilset.model.report") / "template" / name).read_text(encoding="utf-8")


def _plotly() -> str:
    """The library that draws, compressed."""
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        raise InputError(
            "is not installed; the report draws with it: install python3-plotly, or pip install plotly", "", "plotly"
        ) from None
    return compressed(get_plotlyjs())
