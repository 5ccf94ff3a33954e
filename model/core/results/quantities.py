"""The numbers of a run as they are printed, of summary.json: words, value, unit, digits, error and remark of each.

Whatever prints a number reads it here: the terminal, pages, sheets, figures and studies.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from coilset.model.core.base.between_steps import MAKERS
from coilset.model.core.results.loading import Loading, loading_of
from coilset.model.core.results.records.labels import held_matters, largest_errors, last_released, plain, within
from coilset.model.core.results.records.units import unit_of

Summary = Mapping[str, Any]
DECIMALS = {"mm": 4, "N": 2, "N/mm": 4, "MPa": 1, "°": 3, "N mm": 1, "N mm/°": 3, "%": 2}
"""Most decimals of a number in each unit."""
DIGITS = 5  # of a number without an error


@dataclass(frozen=True)
class Quantity:
    """A number of a run.

    Attributes:
        name: its entry in summary.json.
        words: what it is.
        value: None where the run gave none, as of a spring that was not released.
        unit: of value and error.
        error: its size; None where it is not known, or the number was given.
        remark: how it relates to other numbers.
        missing: why there is no value.
    """

    name: str
    words: str
    value: float | None
    unit: str
    error: float | None = None
    remark: str = ""
    missing: str = ""

    @property
    def number(self) -> str:
        """The value in the digits that its error allows, and the error; without a value, why there is none."""
        if self.value is None:
            return self.missing or "none"
        if self.error is not None:
            return within(self.value, self.error, "", DECIMALS[self.unit]).rstrip()
        return plain(round(self.value, DECIMALS[self.unit]), DIGITS).replace(",", "")

    @property
    def text(self) -> str:
        """That, with the unit."""
        return self.number if self.value is None else f"{self.number} {self.unit}"


ENTRIES = {
    "set_mm": ("set", "estimated_set_error_mm"),
    "free_length_after_mm": ("free length", "estimated_set_error_mm"),
    "free_length_before_mm": ("free length as wound", ""),
    "initial_tension_N": ("initial tension", "estimated_initial_tension_error_N"),
    "initial_tension_after_N": ("initial tension after release", "estimated_initial_tension_after_error_N"),
    "force_max_N": ("maximum force", "estimated_force_error_N"),
    "closing_force_N": ("force where the coils close", "estimated_closing_force_error_N"),
    "force_max_height_mm": ("height under the maximum force", "estimated_force_max_height_error_mm"),
    "rate_N_per_mm": ("initial rate", "estimated_rate_error_N_per_mm"),
    "open_rate_N_per_mm": ("rate, coils open", ""),
    "rate_30_70_N_per_mm": ("rate, 30 to 70 % of the travel to block", ""),
    "rate_30_70_after_N_per_mm": ("rate of the finished spring, 30 to 70 %", ""),
    "residual_shear_inside_MPa": (
        "residual shear stress, inside of the coil",
        "estimated_residual_shear_inside_error_MPa",
    ),
    "residual_shear_max_MPa": ("maximum residual shear stress", ""),
    "shear_inside_max_MPa": ("maximum shear stress, inside of the coil", ""),
    "tail_stress_max_MPa": ("maximum stress along the wire of the ends", ""),
    "block_height_mm": ("block height", ""),
    "turn_set_deg": ("set", "estimated_turn_set_error_deg"),
    "turn_max_deg": ("maximum rotation", "estimated_turn_error_deg"),
    "torque_max_Nmm": ("maximum torque", "estimated_torque_error_Nmm"),
    "turn_rate_Nmm_per_deg": ("initial rate", ""),
    "turn_rate_after_Nmm_per_deg": ("rate of the finished spring", ""),
    "residual_bending_inside_MPa": ("residual bending stress, inside of the coil", ""),
    "max_bending_inside_MPa": ("maximum bending stress, inside of the coil", ""),
    "inner_diameter_min_mm": ("minimum inner diameter", ""),
}
"""Words of each number, and the entry with its error."""

ALONG = (
    "set_mm",
    "free_length_after_mm",
    "initial_tension_N",
    "initial_tension_after_N",
    "force_max_N",
    "closing_force_N",
    "force_max_height_mm",
    "rate_N_per_mm",
    "open_rate_N_per_mm",
    "rate_30_70_N_per_mm",
    "rate_30_70_after_N_per_mm",
    "rates",
    "load_losses",
    "residual_shear_inside_MPa",
    "residual_shear_max_MPa",
    "shear_inside_max_MPa",
    "tail_stress_max_MPa",
    "block_height_mm",
)
ORDER = {
    Loading.COMPRESSED: ALONG,
    Loading.PULLED: tuple(name for name in ALONG if name not in ("block_height_mm", "rate_30_70_N_per_mm")),
    Loading.TURNED: (
        "turn_set_deg",
        "torque_max_Nmm",
        "turn_max_deg",
        "turn_rate_Nmm_per_deg",
        "turn_rate_after_Nmm_per_deg",
        "residual_bending_inside_MPa",
        "max_bending_inside_MPa",
        "tail_stress_max_MPa",
        "inner_diameter_min_mm",
    ),
}
"""Which numbers are printed of a spring that is loaded so, in their order."""
LOADS = dict.fromkeys(("turn_max_deg", "torque_max_Nmm", "turn_set_deg"), "turn_max_deg") | {
    "force_max_N": "force_max_N"
}
"""Numbers that are positive in the direction of a load, and that load: they are printed without its sign."""
ALWAYS = ("set_mm", "turn_set_deg", "free_length_after_mm", "rate_30_70_N_per_mm")  # also without a value


def quantity(summary: Summary, name: str) -> Quantity:
    """One number of a run, by its entry in the summary."""
    words, of_error = ENTRIES[name]
    value, given = summary.get(name), _is_given(summary, name)
    if value is not None and (load := LOADS.get(name)):
        value = math.copysign(1.0, summary[load]) * value
        words += ", pulled" if name == "force_max_N" and summary[load] < 0.0 else ""
    error = None if given else summary.get(of_error)
    unit = unit_of(name).replace("degrees", "°")
    if value is None:
        return Quantity(name, words, None, unit, missing=MISSING.get(name, _nothing)(summary))
    remark = REMARKS.get(name, _nothing)(summary)
    return Quantity(name, words, value, unit, error, ", ".join(filter(None, ("as given" if given else "", remark))))


def quantities(summary: Summary) -> Iterator[Quantity]:
    """All numbers of a run that are printed, in their order."""
    for name in ORDER[loading_of(summary)]:
        if name in SERIES:
            yield from SERIES[name](summary)
        elif (summary.get(name) is not None or (name in ALWAYS and name in summary)) and not _is_said_otherwise(
            summary, name
        ):
            yield quantity(summary, name)


def _is_given(s: Summary, name: str) -> bool:
    """Whether the load program gives a number, so that it has no error."""
    entry = {"force_max_N": "force_max_is_given", "torque_max_Nmm": "torque_max_is_given"}.get(name)
    if name == "turn_max_deg":  # the rotation is what was computed where the torque is given, else the reverse
        return not s.get("torque_max_is_given")
    return entry is not None and bool(s.get(entry))


def _is_said_otherwise(s: Summary, name: str) -> bool:
    """Whether another number says the same or more: a height that was given, the rate before the spring is finished, a
    force behind the closing of the coils."""
    if name == "force_max_N":
        return greatest_force(s) != name
    if name == "force_max_height_mm":
        return not s.get("force_max_is_given")
    return name == "rate_30_70_N_per_mm" and s.get("rate_30_70_after_N_per_mm") is not None


# ---- how numbers relate to others ----------------------------------------------------------------------------------


def greatest_force(s: Summary) -> str:
    """The entry of the greatest force that means something: that where the coils close, if the run went beyond."""
    return "force_max_N" if s.get("closing_force_N") is None else "closing_force_N"


def _nothing(s: Summary) -> str:
    return ""


def _of_set(s: Summary) -> str:
    before = s.get("free_length_before_mm")
    parts = [] if before is None else [f"{plain(100.0 * s['set_mm'] / before, 3)} % of the free length"]
    if held_matters(s):
        parts.append(f"{plain(s['set_held_mm'], DIGITS)} mm while its ends are held")
    if earlier := last_released(s):
        parts.append(f"at the last release, in step {earlier[0]} of {earlier[1]}")
    return ", ".join(parts)


def _of_length(s: Summary) -> str:
    earlier = [one["free_length_mm"] for one in s.get("releases") or ()][:-1]
    after = [f"{plain(length, DIGITS)} mm after release {number}" for number, length in enumerate(earlier, 1)]
    return ", ".join([f"{plain(s['free_length_before_mm'], DIGITS)} mm before", *after])


def _of_load(s: Summary) -> str:
    """Which cause has the largest part in the errors."""
    turned = loading_of(s) is Loading.TURNED
    if s.get("estimated_torque_error_Nmm" if turned else "estimated_force_error_N") is None:
        return "error not estimated"
    return f"largest part of the errors ±: {largest_errors(s.get('estimated_errors'), turned)}"


def _of_tension(s: Summary) -> str:
    given = s.get("initial_tension_given_N")
    return "" if given is None else f"wound with {plain(given, DIGITS)} N"


def _of_residual(s: Summary) -> str:
    inside, turn, median = (s.get(f"residual_shear_inside{end}") for end in ("_MPa", "_turn", "_median_MPa"))
    parts = [] if turn is None else [f"at turn {turn:.2f}"]
    if inside and round(inside, 1):  # positive as in a compressed spring
        parts.append("against the load" if inside * s["force_max_N"] < 0.0 else "with the load")
    if median is not None:
        parts.append(f"median of the middle turns {median:z.1f} MPa")
    return ", ".join(parts)


def _of_tail(s: Summary) -> str:
    stress, left = s["tail_stress_max_MPa"], s.get("residual_tail_stress_MPa")
    if left is None or abs(left) < 0.5:
        return ""
    return f"{left:.0f} MPa after release, {'with' if left * stress > 0.0 else 'against'} the load"


def _outside(name: str) -> Callable[[Summary], str]:
    def remark(s: Summary) -> str:
        return f"{s[name]:z.1f} MPa outside, positive in tension"

    return remark


def _of_closing(s: Summary) -> str:
    return f"at {plain(s['closing_height_mm'], DIGITS)} mm; the curve is vertical from there to block"


REMARKS: dict[str, Callable[[Summary], str]] = {
    "set_mm": _of_set,
    "free_length_after_mm": _of_length,
    "initial_tension_N": _of_tension,
    "force_max_N": _of_load,
    "closing_force_N": _of_closing,
    "rate_N_per_mm": lambda s: "" if s.get("open_rate_N_per_mm") is None else "coils closed",
    "residual_shear_inside_MPa": _of_residual,
    "tail_stress_max_MPa": _of_tail,
    "turn_set_deg": lambda s: f"of {plain(abs(s['turn_max_deg']), DIGITS)}° of rotation",
    "torque_max_Nmm": _of_load,
    "residual_bending_inside_MPa": _outside("residual_bending_outside_MPa"),
    "max_bending_inside_MPa": _outside("max_bending_outside_MPa"),
}


def _needed(s: Summary) -> str:
    """The travel of a run that has the rate of EN 15800."""
    return f"needs a travel of {MAKERS[1] * (s['free_length_before_mm'] - s['block_height_mm']):.4g} mm"


MISSING: dict[str, Callable[[Summary], str]] = {
    "set_mm": lambda s: "the spring was not released",
    "turn_set_deg": lambda s: "the spring was not released",
    "rate_30_70_N_per_mm": _needed,
}
"""Why a number is not there."""


def _rates(s: Summary) -> Iterator[Quantity]:
    for one in s.get("rates") or ():
        yield Quantity("rates", f"rate at {one['travel_mm']:g} mm", one["rate_N_per_mm"], "N/mm")


def _losses(s: Summary) -> Iterator[Quantity]:
    for one in s.get("load_losses") or ():
        words = f"load lost in time at {one['height_mm']:.5g} mm"
        before, after = (one[f"temperature_{when}_K"] for when in ("before", "after"))
        heat = "" if abs(after - before) < 0.5 else f", from {before:.0f} to {after:.0f} K"
        remark = f"of {plain(one['force_before_N'], DIGITS)} N in {one['hours']:.4g} h{heat}"
        yield Quantity("load_losses", words, one["loss_percent"], "%", None, remark)


SERIES: dict[str, Callable[[Summary], Iterator[Quantity]]] = {"rates": _rates, "load_losses": _losses}
"""Numbers of which a run has several."""
