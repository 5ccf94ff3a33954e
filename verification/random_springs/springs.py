"""Random springs, the same for the same number: what makers wind, from a short cone to a slender spring of fine wire.

Diameters of the wire from 0.3 to 14 mm, D/d from 3 to 20, 2 to 12 turns. The pitch follows from the shear strain that
the torsion of the wire has at block, γ = d (p − d)/(π D²), between 0.3 and 1.6 %: elastic springs and springs that set
strongly. Values are rounded to four digits. What the checks of a case refuse (coils that overlap, say) is drawn again.
"""

import math
import random
from collections.abc import Sequence
from typing import Any, TypeVar

from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check
from coilset.model.core.case.material import case_law
from coilset.model.core.case.targets import check_targets
from coilset.model.core.material import library
from coilset.model.tools.wires import names as wire_names

FAMILIES = ("cylinder", "cone", "barrel", "hourglass", "double cone", "variable pitch", "variable wire")
WIRE, INDEX, TURNS = (0.3, 14.0), (3.0, 20.0), (2.0, 12.0)  # mm, D/d, turns
SHEAR = 0.003, 0.016  # strain at block
SLENDER = 4.0  # greatest free length over the mean diameter
ATTEMPTS = 1000

Value = TypeVar("Value")


def family(number: int) -> str:
    """The family that a number's spring belongs to."""
    return FAMILIES[number % len(FAMILIES)]


def random_spring(number: int) -> dict[str, Any]:
    """The case of a number from 0 on, as data of a case file."""
    for attempt in range(ATTEMPTS):
        case = _case(_Draw(number, attempt), family(number))
        if _is_valid(case):
            return case
    raise AssertionError(f"no valid spring of number {number} in {ATTEMPTS} attempts")


def features(case: dict[str, Any]) -> set[str]:
    """What a random case is made of besides its family, in words."""
    spring, loading = case["spring"], case["loading"]
    past = {"coiled" if "made_by" in spring else "", "peened" if "peening" in spring else ""} - {""}
    wire = "named wire" if isinstance(case["material"], dict) else case["material"]
    return past | {
        spring["hand"],
        spring["end_coils"] if isinstance(spring["end_coils"], str) else "two ends",
        wire,
        "clamped" if case["ends"] == "clamped" else case["seats"]["hold"],
        "friction" if "contact" in case else "no friction",
        case["mesh"]["section"]["kind"],
        "twice" if len(loading) > 2 else "once",
        "block" if loading[0]["to"] == "block" else "travel",
    }


class _Draw:
    """Random values of one spring; `random.Random.random` gives the same ones in all versions of Python."""

    def __init__(self, number: int, attempt: int) -> None:
        self._random = random.Random(number * ATTEMPTS + attempt).random

    def between(self, low: float, high: float) -> float:
        return low + (high - low) * self._random()

    def scaled(self, low: float, high: float) -> float:
        """Uniform in the logarithm."""
        return low * (high / low) ** self._random()

    def chance(self, part: float) -> bool:
        return self._random() < part

    def one(self, values: Sequence[Value]) -> Value:
        return values[int(self._random() * len(values))]


def _rounded(value: float) -> float:
    """To four digits."""
    return float(f"{value:.4g}")


def _case(draw: _Draw, kind: str) -> dict[str, Any]:
    spring = _spring(draw, kind)
    material = _material(draw, kind)
    if material != "elastic" and draw.chance(0.15):
        spring["made_by"] = "coiling"
    if draw.chance(0.1):
        wire = spring["wire_diameter"]
        thin = wire if isinstance(wire, float) else min(wire["values"])
        spring["peening"] = {"depth": [0.0, _rounded(0.06 * thin)], "stress": [-_rounded(draw.between(200, 600)), 0.0]}
    past = "made_by" in spring or "peening" in spring
    case = {
        "spring": spring,
        "material": material,
        **_support(draw, spring),
        "mesh": {"section": {"kind": draw.one(("curved", "curved", "curved", "plane" if past else "warping"))}},
        "loading": _loading(draw, spring),
    }
    if draw.chance(0.4):
        friction = {"coils": round(draw.between(0.05, 0.3), 2)}
        if case["ends"] == "seats":
            friction["seats"] = round(draw.between(0.05, 0.3), 2)
        case["contact"] = {"friction": friction}
    return case


def _spring(draw: _Draw, kind: str) -> dict[str, Any]:
    """The drawing: its pitch gives the shear strain at block at the mean diameter, if it leaves any travel."""
    ends: Any = draw.one(
        ("open", "open", "closed", "closed and ground", {"bottom": "closed and ground", "top": "open"})
    )
    wire, turns = draw.scaled(*WIRE), draw.between(TURNS[0] + _end_turns(ends), TURNS[1])
    diameter = wire * draw.scaled(*INDEX)
    other = diameter * draw.between(0.5, 0.95)
    pitch = wire + draw.scaled(*SHEAR) * math.pi * diameter**2 / wire
    diameter, other, pitch, turns = _rounded(diameter), _rounded(other), _rounded(pitch), round(turns, 2)
    wide_middle = draw.chance(0.5)
    shapes: dict[str, Any] = {
        "cone": {"shape": "cone", "bottom": diameter, "top": other},
        "barrel": {"shape": "barrel", "ends": other, "middle": diameter},
        "hourglass": {"shape": "hourglass", "ends": diameter, "middle": other},
        "double cone": {
            "shape": "double cone",
            "ends": other if wide_middle else diameter,
            "middle": diameter if wide_middle else other,
        },
    }
    if kind == "variable pitch" and draw.chance(0.4):
        shape: Any = shapes["barrel" if wide_middle else "hourglass"]
    else:
        shape = shapes.get(kind, diameter)
    varies = draw.one(("linear", "monotone"))

    def table(mean: float, change: float) -> dict[str, Any]:
        values = [_rounded(mean * draw.between(1.0 - change, 1.0 + change)) for _ in range(3)]
        return {"turns": [0.0, round(0.5 * turns, 2), turns], "values": values, "interpolation": varies}

    return {
        "wire_diameter": table(wire, 0.2) if kind == "variable wire" else _rounded(wire),
        "mean_diameter": shape,
        "turns": turns,
        "pitch": table(pitch, 0.35) if kind == "variable pitch" else pitch,
        "hand": draw.one(("right", "left")),
        "end_coils": ends,
    }


def _end_turns(ends: str | dict[str, str]) -> float:
    """Turns of closed ends and their transitions: 1.5 an end."""
    return 1.5 * sum(form != "open" for form in (ends.values() if isinstance(ends, dict) else [ends, ends]))


def _material(draw: _Draw, kind: str) -> Any:
    """A material of the library or, for wire of one diameter, a wire of a standard."""
    if kind != "variable wire" and draw.chance(0.4):
        return {"wire": draw.one(wire_names())}
    return draw.one(library.names())


def _support(draw: _Draw, spring: dict[str, Any]) -> dict[str, Any]:
    """A support that such ends have: grooves under end coils that are closed, clamps on wire that ends open."""
    ends = spring["end_coils"]
    if ends == "open":
        return {"ends": "clamped"} if draw.chance(0.5) else {"ends": "seats", "seats": {"hold": "tips"}}
    grooves = isinstance(ends, str) and draw.chance(0.5)
    return {"ends": "seats", "seats": {"hold": "groove" if grooves else "tips"}}


def _loading(draw: _Draw, spring: dict[str, Any]) -> list[dict[str, Any]]:
    """Pressed and released, once or twice; to block, or by a part of what the pitch leaves above the wire."""
    target: Any = "block"
    if draw.chance(0.4):
        pitch, wire = spring["pitch"], spring["wire_diameter"]
        lowest = pitch if isinstance(pitch, float) else min(pitch["values"])
        thick = wire if isinstance(wire, float) else max(wire["values"])
        active = spring["turns"] - _end_turns(spring["end_coils"])
        target = {"travel": _rounded(draw.between(0.3, 0.95) * (lowest - thick) * active)}
    cycle: list[dict[str, Any]] = [{"to": target}, {"to": {"force": 0.0}}]
    return cycle * draw.one((1, 1, 2))


def _is_valid(data: dict[str, Any]) -> bool:
    """Whether it passes the checks of a case before its run, and lies within the limits above."""
    try:
        case = check(data)
        spring = case.spring.build()
        check_targets(case, spring, case_law(case, spring).G)
    except InputError:
        return False
    wire, diameter = spring.wire_diameter(spring.breaks), 2.0 * spring.mean_radius(spring.breaks)
    indices = diameter / wire
    return bool(
        spring.free_length <= SLENDER * diameter.max()
        and INDEX[0] <= indices.min()
        and indices.max() <= INDEX[1]
        and WIRE[0] <= wire.min()
        and wire.max() <= WIRE[1]
        and spring.pitch(spring.breaks).max() <= 0.7 * diameter.max()
    )
