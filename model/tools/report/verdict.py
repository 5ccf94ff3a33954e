"""The verdict on a run: the checks that were made of it, each met, not met, or not made, with the reason."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from coilset.model.core.results.loading import Loading, loading_of

REMARKS = {"elastic warping", "estimate", "not determined", "earlier name", "presetting", "measured axis", "leans"}
"""Warnings that are no failed check."""
COARSE = "contact mesh"
LOAD, FORMULAS, WIRE = "load program", "gaps between the coils", "permissible stress"


@dataclass(frozen=True)
class Check:
    """One check.

    Attributes:
        name: of the check.
        met: None where it could not be made.
        reason: why it is not met or could not be made; empty if it is met.
    """

    name: str
    met: bool | None
    reason: str = ""

    @property
    def result(self) -> str:
        """In a word or two."""
        return "not checked" if self.met is None else "met" if self.met else "not met"


def checks(summary: Mapping[str, Any], has_formulas: bool, is_standard_wire: bool) -> list[Check]:
    """The checks of a run.

    Args:
        summary: of summary.json.
        has_formulas: whether EN 13906-1 applies, as to a cylinder of constant wire.
        is_standard_wire: whether the wire is one of a standard, for which a stress is permitted.
    """
    messages: dict[str, str] = {}
    for one in summary["warnings"]:
        messages.setdefault(one["name"], one["message"])
    loading = loading_of(summary)
    turned = loading is Loading.TURNED
    cylinder = "" if has_formulas else "EN 13906-1 applies to cylinders of constant wire only"
    cylinder = (
        "EN 13906-1 applies to springs that are compressed only" if loading is not Loading.COMPRESSED else cylinder
    )
    unknown = "errors of torque and rotation are not estimated" if turned else ""
    # what a coarse contact curve changes is in the error by the mesh: the companion's is several times as far off
    coarse = messages.pop(COARSE, "")
    if coarse and turned:
        unknown = f"{unknown}; {coarse}"
    elif coarse and summary.get("estimated_force_error_N") is None:
        messages[COARSE] = coarse
    wire = "" if is_standard_wire else f"no permissible stress of {summary['material']} is known"
    complete = Check(LOAD, bool(summary["complete"]), "" if summary["complete"] else "the run ended before it did")
    groups: list[tuple[str, tuple[str, ...], str]] = [
        (FORMULAS, ("gap", "solid coils"), cylinder),
        (WIRE, ("stress", "strength", "endurance"), cylinder or wire),
        ("buckling", ("buckled", "buckling", "snapped"), ""),
        ("material data", ("plastic work",), ""),
        ("accuracy", ("accuracy", "error", "step error", "unknown error", "penetration", "wall"), unknown),
    ]
    if summary.get("limits"):
        groups.insert(0, ("limits", ("limit",), ""))
    found = [complete, *(_check(name, warnings, messages, not_made) for name, warnings, not_made in groups)]
    named = {name for _, warnings, _ in groups for name in warnings}
    others = [one for name, one in messages.items() if name not in named | REMARKS]
    return [*found, Check("other warnings", not others, "; ".join(others))]


def verdict(made: Sequence[Check]) -> str:
    """One sentence about all checks."""
    failed = [one.name for one in made if one.met is False]
    left = [one.name for one in made if one.met is None]
    open_ = f" Not checked: {', '.join(left)}." if left else ""
    return (f"Not met: {', '.join(failed)}." if failed else "All checks made are met.") + open_


def _check(name: str, warnings: Sequence[str], messages: Mapping[str, str], not_made: str) -> Check:
    failed = [messages[one] for one in warnings if one in messages]
    if failed:
        return Check(name, False, "; ".join(failed))
    return Check(name, None if not_made else True, not_made)
