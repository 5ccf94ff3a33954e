"""The main results in a spring maker's terms; all numbers are those of summary.json."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.quantities import Quantity, quantities
from coilset.model.core.results.records.labels import lives_text, within
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.tools.figures.panels.panel import with_unit


@dataclass(frozen=True)
class Number:
    """One number of the answer.

    Attributes:
        term: its name, explained by the glossary if it has an entry.
        value: with its unit.
        remark: how it relates to other numbers.
    """

    term: str
    value: str
    remark: str = ""


def subtitle(run: Run) -> str:
    """The spring and its load program, in one line."""
    spring, summary = run.case["spring"], run.summary
    size = [
        f"{label} {spring[name]:g} mm"
        for name, label in (("wire_diameter", "wire"), ("mean_diameter", "mean diameter"))
        if isinstance(spring.get(name), int | float)
    ]
    if isinstance(spring.get("turns"), int | float):
        size.append(f"{spring['turns']:g} turns")
    way = ", then ".join(run.snapshots[1:])
    return ", ".join(
        [*size, summary["material"], f"on {summary['ends']}" if summary["ends"] == "seats" else "clamped"]
    ) + (f"; to {way}" if way else "")


def answer(summary: Mapping[str, Any]) -> list[Number]:
    """The numbers of a run, the set first; of summary.json."""
    return [number(one) for one in quantities(summary)]


def number(one: Quantity) -> Number:
    """A quantity as it is printed on a page."""
    return Number(one.words, *(text.replace("-", "−") for text in (one.text, one.remark)))


STRESSES = ("shear_MPa", "corrected_shear_MPa", "shear_inside_MPa")  # of a working state
WORKING_HEADS = (
    "length, mm",
    "force, N",
    "rate, N/mm",
    "τ, MPa",
    "τk, MPa",
    "true, inside, MPa",
    "at turn",
    "safety",
    "force centre, x and y, mm",
)
"""Columns of `working_rows`."""
WORKING_NOTE = (
    "τ = 8 D F/(π d³) and τk after EN 13906-1; the true shear stress at the inside of the coil includes the residual "
    "stress. Safety of a compression spring is the stress allowed for the wire at block over τ or τk, whichever it "
    "limits."
)
LIMIT_HEADS = ("result", "value", "from", "to", "", "by", "source")
FATIGUE_HEADS = ("criterion", "amplitude, MPa", "endured, MPa", "safety", "at turn", "angle", "lives, 10, 50, 90 %")
FATIGUE_NOTE = (
    "Amplitude of a fully reversed test that damages as much as the working cycle, residual stress included, where it "
    "is greatest on the wire's surface; the angle is counted from the inside of the coil. Lives are the cycles that so "
    "many of the springs do not survive; – where they endure, or without a slope."
)


def lists(summary: Mapping[str, Any]) -> list[tuple[str, str, str, tuple[str, ...], list[list[str]]]]:
    """Tables of a run's page: name, title, note, columns and rows; of summary.json."""
    return [
        ("limits", "Limits", "", LIMIT_HEADS, list(map(_limit, summary.get("limits") or ()))),
        ("working", "Working lengths of the finished spring", WORKING_NOTE, WORKING_HEADS, working_rows(summary)),
        ("life", "Safety and life", FATIGUE_NOTE, FATIGUE_HEADS, list(map(_fatigue, summary.get("fatigue") or ()))),
    ]


def _limit(limit: Mapping[str, Any]) -> list[str]:
    words, unit = words_and_unit(limit["name"])
    words, value = f"{words}, {unit}" if unit else words, limit["value"]
    ends = [f"{limit[name]:.6g}" for name in ("low", "high")]
    if value is None:
        return [words, "none", *ends, "not met", "–", limit["source"]]
    met = "met" if limit["met"] else "not met"
    cells = [words, f"{value:.6g}", *ends, met, f"{abs(limit['margin']):.3g}", limit["source"]]
    return [cell.replace("-", "−") if k in (1, 2, 3) else cell for k, cell in enumerate(cells)]


def _fatigue(entry: Mapping[str, Any]) -> list[str]:
    return [
        entry["criterion"],
        with_unit(entry["amplitude_MPa"], ""),
        with_unit(entry["endured_MPa"], ""),
        with_unit(entry["safety"], "", 2),
        with_unit(entry["turn"], "", 2),
        f"{entry['angle_deg']:z.0f}°".replace("-", "−"),
        lives_text(entry["lives"], "–"),
    ]


def working_rows(summary: Mapping[str, Any]) -> list[list[str]]:
    """The finished spring at its working states, of summary.json, a row of texts each; none of earlier versions."""
    return [_working(state) for state in summary.get("working") or ()]


def _working(state: Mapping[str, Any]) -> list[str]:
    if state["reason"]:
        wanted = [f"{state[name]:g}" if name in state else "–" for name in ("length_wanted", "force_wanted")]
        return [*wanted, state["reason"], *[""] * (len(WORKING_HEADS) - 3)]
    is_length, error = "length_wanted" in state, state["estimated_error"]
    x, y = (state[f"bottom_centre_{axis}_mm"] for axis in "xy")
    cells = [
        within(state["length_mm"], None if is_length else error, "", 3),
        within(abs(state["force_N"]), error if is_length else None, "", 2),
        with_unit(state["rate_N_per_mm"], "", 3, "–"),
        *("–" if state[name] is None else with_unit(abs(state[name]), "", 0) for name in STRESSES),
        with_unit(state["shear_inside_turn"], "", 2, "–"),
        with_unit(state["safety"], "", 2, "–"),
        "–" if x is None else f"{x:z.2f}, {y:z.2f}",
    ]
    return [cell.strip().replace("-", "−") for cell in cells]
