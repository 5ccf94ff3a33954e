"""Ten designs of springs of different kinds: what `coilset design` finds, solved forward from its file

Cylinders with open, closed and clamped ends, a cone, a barrel, an hourglass, springs of variable pitch and wire, a wire
of a standard, small meshes of eight rods per turn; one to three unknowns among pitch, free length, wire, turns, a value
of a table and preset height; lengths, sets, forces, rates and stresses as conditions. The solution is not known
beforehand: the check is the forward solve of the case that was written, read as a file.

Tolerance: 1e-6 of each condition. The table says how many runs each design took, and how long: by the clock, and by the
processor, whatever else the machine does.
"""

import tempfile
import time
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import yaml
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import read_case
from coilset.model.tools.design.design import find, make_search
from coilset.model.tools.design.file import read_design_file
from coilset.model.tools.design.output import found_data
from coilset.model.tools.design.search import Search
from coilset.verification.study import Study

MESH = {"elements_per_turn": 8, "section": {"radial": 3, "angular": 10}}
OPEN = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
CLOSED = {
    "wire_diameter": 4.0,
    "mean_diameter": 32.0,
    "turns": 5.5,
    "free_length": 55.0,
    "end_coils": "closed and ground",
    "hand": "left",
}
SHAPED = {"wire_diameter": 4.0, "mean_diameter": 36.0, "turns": 3.5, "pitch": 12.0}
WIDE = {"wire_diameter": 4.0, "mean_diameter": 30.0, "turns": 3.5, "pitch": 11.0}
RELEASE = {"to": {"force": 0}}
DESIGNS: dict[str, dict[str, Any]] = {
    "preset height": {
        "spring": OPEN,
        "loading": [{"to": {"height": 20.0}}, RELEASE],
        "find": {"loading.0.to.height": [18, 34]},
        "such_that": {"free_length_after_mm": 25.0},
    },
    "preset height and wire": {
        "spring": OPEN,
        "loading": [{"to": {"height": 20.0}}, RELEASE],
        "find": {"loading.0.to.height": [18, 24], "spring.wire_diameter": [4, 5.5]},
        "such_that": {"free_length_after_mm": 25.0, "force_at": {"height": 21.0, "N": 160.0}},
    },
    "clamped, pitch": {
        "spring": OPEN,
        "ends": "clamped",
        "loading": [{"to": {"height": 25.0}}, RELEASE],
        "find": {"spring.pitch": [9, 15]},
        "such_that": {"free_length_after_mm": 29.0},
    },
    "closed and ground, force in use": {
        "spring": CLOSED,
        "loading": [{"to": {"height": 30.0}}],
        "find": {"spring.free_length": [40, 70]},
        "such_that": {"force_at": {"height": 30.0, "N": 125.0}},
    },
    "wire of EN 10270-1, length and rate": {
        "spring": WIDE,
        "material": {"wire": "EN 10270-1 SH"},
        "loading": [{"to": "block"}, RELEASE],
        "find": {"spring.pitch": [8, 16], "spring.turns": [3, 5]},
        "such_that": {"free_length_after_mm": 42.0, "rate_N_per_mm": 25.0},
    },
    "cone, set": {
        "spring": {**SHAPED, "mean_diameter": {"shape": "cone", "bottom": 46.0, "top": 30.0}},
        "loading": [{"to": {"height": 22.0}}, RELEASE],
        "find": {"loading.0.to.height": [20, 36]},
        "such_that": {"set_mm": 8.0},
    },
    "barrel, middle diameter": {
        "spring": {**SHAPED, "mean_diameter": {"shape": "barrel", "ends": 30.0, "middle": 40.0}},
        "loading": [{"to": {"height": 30.0}}],
        "find": {"spring.mean_diameter.middle": [34, 50]},
        "such_that": {"force_at": {"height": 30.0, "N": 90.0}},
    },
    "hourglass, wire and preset height": {
        "spring": {**SHAPED, "mean_diameter": {"shape": "hourglass", "ends": 42.0, "middle": 30.0}},
        "loading": [{"to": {"height": 26.0}}, RELEASE],
        "find": {"spring.wire_diameter": [3.5, 4.5], "loading.0.to.height": [24, 32]},
        "such_that": {"free_length_after_mm": 35.0, "force_at": {"height": 32.0, "N": 50.0}},
    },
    "variable pitch, one value": {
        "spring": {**SHAPED, "pitch": {"turns": [0, 1.75, 3.5], "values": [8.0, 13.0, 8.0], "interpolation": "linear"}},
        "loading": [{"to": {"height": 25.0}}, RELEASE],
        "find": {"spring.pitch.values.1": [10, 18]},
        "such_that": {"force_max_N": 104.0},
    },
    "variable wire, residual stress": {
        "spring": {
            **SHAPED,
            "wire_diameter": {"turns": [0, 1.75, 3.5], "values": [3.5, 4.5, 3.5], "interpolation": "monotone"},
        },
        "loading": [{"to": {"height": 24.0}}, RELEASE],
        "find": {"loading.0.to.height": [20, 36]},
        "such_that": {"residual_shear_inside_MPa": -45.0},
    },
}
CLOSE = 1e-6


def run(study: Study) -> None:
    """All designs."""
    rows, ways = [], {}
    for name in ("preset height", "closed and ground, force in use"):
        designed(None, name, DESIGNS[name])  # loads what is compiled, so that the times are those of searches
    for name, entries in DESIGNS.items():
        found = designed(study, name, entries)
        rows.append([name, *found[:4]])
        ways[name] = found[4]
    columns = ["design", "unknowns", "runs", "s", "s of the processor"]
    study.table("Runs and time of each design, trade-offs not counted", columns, rows)
    study.figure("design_round_trip", draw(ways))


def designed(study: Study | None, name: str, entries: dict[str, Any]) -> tuple[int, int, float, float, list[float]]:
    """One design: number of unknowns and runs, seconds of the clock and of the processor, and how far off each run was;
    judged if there is a study."""
    with tempfile.TemporaryDirectory() as folder:
        path, written = Path(folder) / "design.yaml", Path(folder) / "found.yaml"
        path.write_text(yaml.safe_dump({"material": "ck15", "mesh": MESH, **entries}), encoding="utf-8")
        began, worked = time.perf_counter(), time.process_time()
        search = make_search(read_design_file(path))
        found = find(search)
        seconds, worked = time.perf_counter() - began, time.process_time() - worked
        written.write_text(yaml.safe_dump(found_data(found)), encoding="utf-8")
        if study is not None:
            for condition, value in zip(search.conditions, forward(search, written), strict=True):
                quantity = f"{name}: {condition.words}, {condition.unit}"
                study.check(quantity, value, condition.target, "the target", CLOSE)
    off = [float(np.abs(search.off(one.values)).max()) for one in search.evaluations if not one.failed]
    return len(search.width), search.evaluator.count, round(seconds, 1), round(worked, 1), off


def forward(search: Search, path: Path) -> list[float]:
    """Values of the conditions after a solve of a case file."""
    analysis = Analysis(read_case(path), MPI.COMM_SELF)
    steps = analysis.run().steps
    summary, forces = summarise(analysis.setup, analysis.result), {step.phase: step.force_N for step in steps}
    return [summary[one.short_name] if one.phase is None else forces[one.phase] for one in search.conditions]


def draw(ways: dict[str, list[float]]) -> Figure:
    """How far off each run was."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.0), layout="constrained")
        axes = figure.add_subplot()
        for number, (name, off) in enumerate(ways.items()):
            style = "-" if number < 5 else "--"
            axes.semilogy(
                range(1, len(off) + 1), np.maximum(off, 1e-13), f"C{number % 5}o{style}", ms=3, lw=1, label=name
            )
        axes.axhline(CLOSE, color="0.5", lw=0.8)
        axes.set(xlabel="run", ylabel="largest relative deviation of a condition", title="Ten designs")
        axes.grid(lw=0.3)
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    return figure
