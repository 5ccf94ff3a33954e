"""The finished spring at its working lengths: what summary.json, sweeps and limits name after them.

Entries end with the given length or force: `force_at_37_N` is the force at 37 mm, `length_at_250_mm` the
length under 250 N.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

from coilset.model.core.base.warning import Warning
from coilset.model.core.results import surface
from coilset.model.core.results.records.record import Result, Setup, Snapshot
from coilset.model.core.results.records.releases import NOTICED

LINE = {f"line_{plane}_{axis}": "mm" for plane in ("lower", "upper") for axis in "xy"} | {"side_force": "N"}
"""Numbers of the force line, of cases with `force_line`."""
QUANTITIES = {
    "force": "N",
    "length": "mm",
    "rate": "N_per_mm",
    "shear": "MPa",
    "corrected_shear": "MPa",
    "shear_inside": "MPa",
    "shear_surface": "MPa",
    "safety": "",
    **LINE,
}
"""Numbers of a working state, with the units that their names end with."""
NUMBER = re.compile(
    rf"({'|'.join(QUANTITIES)})_at_(\d+(?:\.\d+)?)(?:_({'|'.join(filter(None, QUANTITIES.values()))}))?"
)


def is_working_number(name: str) -> bool:
    """Whether a name is that of a number of a working state, such as `force_at_37_N`."""
    found = NUMBER.fullmatch(name)
    return found is not None and (found[3] or "") == QUANTITIES[found[1]]


def number_name(quantity: str, value: float) -> str:
    """The name of a number at a working length or force."""
    unit = QUANTITIES[quantity]
    return f"{quantity}_at_{value:g}" + (f"_{unit}" if unit else "")


def names_of(working: Mapping[str, Any]) -> list[str]:
    """Names of all numbers of the working states in raw, checked data of a case's `working`."""
    kinds = (("length", working.get("lengths")), ("force", working.get("forces")))
    return [
        number_name(quantity, value)
        for kind, values in kinds
        for value in values or ()
        for quantity in quantities_at(kind)
    ]


def quantities_at(kind: str, line: bool = False) -> list[str]:
    """The quantities that have a name at a `length`: all others, with those of the force `line` or without; at a
    `force` the length alone, to be unambiguous."""
    others = [name for name in QUANTITIES if name != "length" and (line or name not in LINE)]
    return ["length"] if kind == "force" else others


def place_of(name: str) -> tuple[Literal["length", "force"], float]:
    """What a number of a working state is at: a length, mm, or for a `length_at_…` a force, N."""
    found = NUMBER.fullmatch(name)
    assert found is not None
    return "force" if found[1] == "length" else "length", float(found[2])


def plastic_rise(result: Result, shot: Snapshot) -> float:
    """Largest rise of the plastic work b* on the surface since the end of the load program, N/mm²."""
    before, now = (surface.component(one.surface_state, one.components, "b") for one in (result.snapshots[-1], shot))
    return float((now - before).max(initial=0.0))


def working_numbers(entries: Sequence[Mapping[str, Any]]) -> dict[str, float | None]:
    """Numbers of the entries by names that hold the length or force; None where the spring is not there."""
    found: dict[str, float | None] = {}
    for entry in entries:
        kind = "length" if "length_wanted" in entry else "force"
        for quantity in quantities_at(kind, line="line_lower_x_mm" in entry):
            unit = QUANTITIES[quantity]
            found[number_name(quantity, entry[f"{kind}_wanted"])] = entry.get(
                f"{quantity}_{unit}" if unit else quantity
            )
    return found


def working_warnings(setup: Setup, result: Result) -> Iterator[Warning]:
    """Working states that the finished spring cannot have, and a spring that sets further on the way to them."""
    if result.working is None:
        return
    for state in result.working.states:
        if state.reason:
            yield Warning("working length", f"working, {state.label}", f"{state.label}: {state.reason}")
    more, limit = result.working.set, NOTICED * setup.spring.free_length
    if more is not None and abs(more) > limit:
        rises = [(plastic_rise(result, state.snapshot), state) for state in result.working.reached if state.snapshot]
        worst = max(rises, key=lambda one: one[0], default=None)
        at = "" if worst is None else f"; its plastic work rises most at {worst[1].label}, by {worst[0]:.3g} N/mm²"
        message = (
            f"on the way to its working lengths the spring yields again: they shorten it by another {more:.3g} mm{at}. "
            "Forces are those of the first time there; preset it beyond its working lengths"
        )
        yield Warning("working set", "working", message, more, limit, "mm")
