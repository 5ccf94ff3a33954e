"""A page from its template: one file that opens from disk without a network."""

import base64
import gzip
import json
import math
from collections.abc import Iterable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from coilset.model.core.results.files.folder import whole
from coilset.model.tools.checks.check import HEADS
from coilset.model.tools.figures.panels.panel import Panel

NAME = "report.html"
SCRIPTS = {"sweep": "sweep.js", "nest": "nest.js"}  # of kinds of pages; run.js of the others
# explained on a page at hover or focus
GLOSSARY = {
    "set": "Loss of length that stays after the load has been taken off; negative of a spring that stays longer. Of a "
    "torsion spring, the rotation that stays.",
    "free length": "Length of the spring without load.",
    "block": "The state in which all coils touch; the spring cannot be compressed further.",
    "block height": "Height of the spring at block, from its geometry.",
    "rate": "Force per millimetre of travel, or torque per degree; the slope of the characteristic.",
    "initial rate": "Rate of the spring before anything yields or touches.",
    "residual shear stress": "Shear stress that remains in the unloaded wire. If it acts against the load, the spring "
    "can carry more, because the load must first overcome it.",
    "maximum shear stress": "Largest shear stress on the wire's surface at the inside of the coil, under load.",
    "inside of the coil": "The side of the wire that faces the spring's axis. The stress is highest there, and springs "
    "break there.",
    "travel": "Distance by which the seats have approached each other since the spring was free.",
    "steps": "Increments of the load program; an equilibrium was found at the end of each.",
    "plastic work": "Work of the plastic deformation per volume of wire; the material's data are valid up to a "
    "given limit.",
}
KEY = "f4"  # of packed arrays, which a page reads without parsing each number
Chapters = Sequence[tuple[str, Sequence[Panel]]]


def write_page(folder: Path, kind: str, chapters: Chapters, data: dict[str, Any], **parts: Any) -> Path:
    """Write report.html.

    Args:
        folder: to write to.
        kind: of the page, `run`, `design`, `nest` or `sweep`: its template.
        chapters: titles with their figures.
        data: further data for the scripts of the page; arrays are packed.
        parts: variables of the template.

    Returns:
        The file.

    Raises:
        InputError: if plotly is missing. CoilsetError: if the file cannot be written.
    """
    environment = Environment(
        loader=PackageLoader("coilset.model.tools.report", "template"),
        autoescape=select_autoescape(["html"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals["glossary"] = GLOSSARY
    environment.globals["check_heads"] = HEADS
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
    return (files("coilset.model.tools.report") / "template" / name).read_text(encoding="utf-8")


def _plotly() -> str:
    """The library that draws, compressed."""
    from plotly.offline import get_plotlyjs

    return compressed(get_plotlyjs())


def packed(value: Any) -> Any:
    """Plain data with every array as single-precision bits, `{"f4": base64, "shape": [...]}`; short ones as lists.

    A number that is not finite becomes None wherever a page reads text, since JSON has none.
    """
    if isinstance(value, np.ndarray):
        if value.dtype.kind != "f" or value.size < 24:
            return packed(value.tolist())
        bits = np.ascontiguousarray(value, dtype="<f4").tobytes()
        return {KEY: base64.b64encode(bits).decode("ascii"), "shape": list(value.shape)}
    if isinstance(value, dict):
        return {key: packed(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [packed(one) for one in value]
    if isinstance(value, np.generic):
        return packed(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
