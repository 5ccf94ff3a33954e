"""The main results in a spring maker's terms; all numbers are those of summary.json."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coilset.model.figures.panels.panel import with_unit
from coilset.model.results.files.opened import Run, is_turned
from coilset.model.results.records.labels import held_matters, largest_errors, last_released, lives_text, within
from coilset.model.results.records.units import quantity


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
    """Set first, then the residual stress, forces and rates; of summary.json."""
    s = summary
    before, after = s["free_length_before_mm"], s["free_length_after_mm"]
    share = (
        f"{with_unit(100.0 * s['set_mm'] / before, '%', 1)} of the free length"
        if s["set_mm"] is not None
        else "the spring was not released"
    )
    if held_matters(s):
        share += f", {with_unit(s['set_held_mm'], 'mm', 3)} while its ends are held"
    if earlier := last_released(s):
        share += f", at the last release, in step {earlier[0]} of {earlier[1]}"
    inside = s["residual_shear_inside_MPa"]
    turn = s.get("residual_shear_inside_turn")
    at = "" if turn is None else f" at turn {turn:.2f}"
    against = ""
    if inside and round(
        inside, 1
    ):  # positive as in a compressed spring, so that it is the load's sign of a spring that is pulled
        against = "against the load" if inside * s["force_max_N"] < 0.0 else "with the load"
    if is_turned(s):
        return _turned(s)
    return [
        Number("set", _within(s["set_mm"], s.get("estimated_set_error_mm"), "mm", 3), share),
        Number("free length", _within(after, s.get("estimated_set_error_mm"), "mm", 3), _lengths(s)),
        Number(
            "residual shear stress",
            _within(inside, s.get("estimated_residual_shear_inside_error_MPa"), "MPa", 1),
            f"inside of the coil{at}{', ' + against if against else ''}",
        ),
        *_greatest(s),
        Number("maximum shear stress", with_unit(s["shear_inside_max_MPa"], "MPa", 0), "at the inside of the coil"),
        *_tension(s),
        Number(
            "initial rate", _within(s["rate_N_per_mm"], s.get("estimated_rate_error_N_per_mm"), "N/mm", 3), _after(s)
        ),
        *([] if is_pulled(s) else [Number("block height", with_unit(s["block_height_mm"], "mm", 2))]),
    ]


def _greatest(s: Mapping[str, Any]) -> list[Number]:
    """The maximum force; where the load program gives it, the height under it, which is what was computed."""
    if not s.get("force_max_is_given"):
        force = _within(s["force_max_N"], s.get("estimated_force_error_N"), "N", 1)
        return [Number("maximum force", force, _errors(s))]
    height = _within(s["force_max_height_mm"], s["estimated_force_max_height_error_mm"], "mm", 3)
    return [
        Number("maximum force", with_unit(s["force_max_N"], "N", 1), "as given"),
        Number("height under the maximum force", height, _errors(s)),
    ]


def is_pulled(s: Mapping[str, Any]) -> bool:
    """Whether its greatest load pulls a spring; of summary.json."""
    return bool(s["force_max_N"] < 0.0)


def _tension(s: Mapping[str, Any]) -> list[Number]:
    """Of a spring whose coils are wound onto each other."""
    if s.get("initial_tension_N") is None:
        return []
    after = s["initial_tension_after_N"]
    of_after = s.get("estimated_initial_tension_after_error_N")
    given = "" if s.get("initial_tension_given_N") is None else f"wound with {s['initial_tension_given_N']:.5g} N"
    left = "" if after is None else f"{_within(after, of_after, 'N', 1)} after the last release"
    rate = with_unit(s["open_rate_N_per_mm"], "N/mm", 3)
    of_first = s.get("estimated_initial_tension_error_N")
    held = Number(
        "initial tension", _within(s["initial_tension_N"], of_first, "N", 1), "; ".join(filter(None, (given, left)))
    )
    return [held, Number("rate, coils open", rate), *_beyond_coil(s, "hooks")]


def _beyond_coil(s: Mapping[str, Any], name: str) -> list[Number]:
    """The stress along the wire of hooks or arms, and what is left of it."""
    stress, left = s.get("tail_stress_max_MPa"), s.get("residual_tail_stress_MPa")
    if stress is None:
        return []
    words = ""
    if left is not None and abs(left) >= 0.5:
        words = f"{with_unit(left, 'MPa', 0)} after release, {'with' if left * stress > 0.0 else 'against'} the load"
    return [Number(f"maximum stress along the wire, {name}", with_unit(stress, "MPa", 0), words)]


def _turned(s: Mapping[str, Any]) -> list[Number]:
    """Of a torsion spring: set in degrees first, then the residual bending stress, torque and rate."""
    inside, outside = (with_unit(s[f"residual_bending_{side}_MPa"], "MPa", 1) for side in ("inside", "outside"))
    rate = with_unit(s["turn_rate_Nmm_per_deg"], "N mm/°", 3)
    after = s["turn_rate_after_Nmm_per_deg"]
    of_set, of_torque = s.get("estimated_turn_set_error_deg"), s.get("estimated_torque_error_Nmm")
    if s.get("torque_max_is_given"):
        of_torque = None
    return [
        Number("set", _within(s["turn_set_deg"], of_set, "°", 2), f"of {s['turn_max_deg']:.4g}° of rotation"),
        Number("residual bending stress", inside, f"inside of the coil; {outside} outside; positive in tension"),
        Number("maximum torque", _within(s["torque_max_Nmm"], of_torque, "N mm", 0), _errors(s)),
        Number(
            "maximum bending stress",
            with_unit(s["max_bending_inside_MPa"], "MPa", 0),
            f"inside of the coil; {with_unit(s['max_bending_outside_MPa'], 'MPa', 0)} outside",
        ),
        Number("rate", rate, "" if after is None else f"{with_unit(after, 'N mm/°', 3)} on release"),
        Number("inner diameter", with_unit(s["inner_diameter_min_mm"], "mm", 2), "smallest, for an arbor"),
        *_beyond_coil(s, "arms"),
    ]


def release_lengths(summary: Mapping[str, Any]) -> list[float]:
    """Free lengths after each release to zero force, mm; none where the summary does not list them."""
    return [one["free_length_mm"] for one in summary.get("releases") or ()]


def _lengths(summary: Mapping[str, Any]) -> str:
    """The free length before, and after the releases before the last one."""
    earlier = [f"{length:.3f} mm after release {k}" for k, length in enumerate(release_lengths(summary)[:-1], 1)]
    between = f", {', '.join(earlier)}" if earlier else ""
    after = "after the last release" if last_released(summary) else "after"
    return f"{after}; {summary['free_length_before_mm']:.3f} mm before{between}"


def _within(value: float | None, error: float | None, unit: str, digits: int) -> str:
    return within(value, error, unit, digits).replace("-", "−")


def _errors(summary: Mapping[str, Any]) -> str:
    """What the errors behind ± are mostly caused by."""
    turned = is_turned(summary)
    if summary.get("estimated_torque_error_Nmm" if turned else "estimated_force_error_N") is None:
        return "error not estimated"
    return f"largest part of the errors ±: {largest_errors(summary.get('estimated_errors'), turned)}"


def _after(summary: Mapping[str, Any]) -> str:
    rate = summary["rate_30_70_after_N_per_mm"]
    return "" if rate is None else f"{rate:.3f} N/mm on release, between 30 and 70 % of the travel"


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
    words, unit = quantity(limit["name"])
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
        within(state["force_N"], error if is_length else None, "", 2),
        with_unit(state["rate_N_per_mm"], "", 3, "–"),
        with_unit(state["shear_MPa"], "", 0, "–"),
        with_unit(state["corrected_shear_MPa"], "", 0, "–"),
        with_unit(state["shear_inside_MPa"], "", 0, "–"),
        with_unit(state["shear_inside_turn"], "", 2, "–"),
        with_unit(state["safety"], "", 2, "–"),
        "–" if x is None else f"{x:z.2f}, {y:z.2f}",
    ]
    return [cell.strip().replace("-", "−") for cell in cells]
