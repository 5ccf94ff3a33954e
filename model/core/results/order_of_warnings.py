"""Warnings of a run as they are printed: each once, the most important one first, without what other numbers say."""

from collections.abc import Mapping
from typing import Any

FIRST = (
    "support",
    "strength",
    "fatigue",
    "buckled",
    "snapped",
    "coils slipped",
    "unstable",
    "working set",
    "working length",
    "plastic work",
    "creep",
    "temperature",
    "negative set",
    "error",
    "step error",
    "unknown error",
)
LAST = ("presetting", "leans", "contact mesh", "not determined", "estimate", "elastic warping", "earlier name")
CHECKED = ("limit",)
"""Kinds that the table of checks has."""
COARSE = "contact mesh"  # what it changes is in the error by the mesh, where that is estimated


def messages_in_order(summary: Mapping[str, Any]) -> list[str]:
    """Messages of the warnings of a summary, in their order."""
    kinds = {name: number for number, name in enumerate(FIRST)}
    kinds |= {name: 2 * len(FIRST) + number for number, name in enumerate(LAST)}
    estimated = summary.get("estimated_force_error_N") is not None
    found = [
        (kinds.get(one["name"], len(FIRST)), one["message"])
        for one in summary["warnings"]
        if one["name"] not in CHECKED and not (one["name"] == COARSE and estimated)
    ]
    return list(dict.fromkeys(message for _, message in sorted(found, key=lambda pair: pair[0])))
