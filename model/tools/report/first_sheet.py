"""The first sheet of a printed page: the maker's data, the drawing, the characteristic and the verdict, on one side."""

import base64
import io
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np

from coilset.meshes.drawings.drawing import drawing
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.quantities import quantity
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.checks.check import Check, sentence
from coilset.model.tools.checks.table import checks
from coilset.model.tools.report.answer import answer
from coilset.model.tools.sheet import from_results

DPI = 110  # of the drawing


@dataclass(frozen=True)
class FirstSheet:
    """Content of the sheet.

    Attributes:
        rows: name and value of each number.
        drawing: PNG as base64; empty if the spring cannot be built any more.
        checks: of the spring; none if it cannot be built any more, or a file of its material has gone.
        verdict: what they say together.
    """

    rows: list[tuple[str, str]]
    drawing: str
    checks: list[Check]
    verdict: str


def first_sheet(run: Run) -> FirstSheet:
    """The sheet of a run."""
    made: list[Check] = []
    try:
        case = check(run.case)
        spring = case.spring.build()
        made = checks(case, spring, from_results.read(run.folder))
    except InputError:  # a file of the case that has gone
        spring = None
    rows = [] if spring is None else _geometry(spring)
    drawn = "" if spring is None else _drawn(spring)
    return FirstSheet(rows + results(run.summary), drawn, made, sentence(made))


def _geometry(spring: Spring) -> list[tuple[str, str]]:
    t = np.linspace(0.0, spring.turns, 257)
    wire, mean = spring.wire_diameter(t), 2.0 * spring.mean_radius(t)
    return [
        ("wire diameter d" if spring.section is None else "wire height d", _span(wire)),
        ("mean diameter D", _span(mean)),
        ("outer diameter De", _span(mean + spring.width * wire)),
        ("inner diameter Di", _span(mean - spring.width * wire)),
        ("turns, total and active", f"{spring.turns:g}, {spring.active_turns:.4g}"),
        ("direction of winding", "right" if spring.hand > 0 else "left"),
        ("length of the wire", f"{plain(spring.wire_length, 5)} mm"),
    ]


def _span(values: np.ndarray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{plain(low, 5)} mm" if high - low < 1e-6 * high else f"{plain(low, 4)} to {plain(high, 4)} mm"


def results(summary: dict[str, Any]) -> list[tuple[str, str]]:
    """Names and values of the results of a run, of summary.json."""
    wound = quantity(summary, "free_length_before_mm")
    rows = [
        ("material", summary["material"]),
        (wound.words, wound.text),
    ]
    return rows + [(one.term, one.value) for one in answer(summary)]


def _drawn(spring: Spring) -> str:
    with mpl.rc_context(STYLE):
        file = io.BytesIO()
        drawing(spring).savefig(file, format="png", dpi=DPI)
    return base64.b64encode(file.getvalue()).decode("ascii")
