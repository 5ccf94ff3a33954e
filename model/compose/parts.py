"""The optional packages that take part in a run without being named in its case, as far as they are installed."""

from functools import cache
from types import ModuleType

from coilset.model.core.base.package import missing, optional
from coilset.model.core.base.warning import Warning
from coilset.model.core.results.records.part import Part

RECORDED = "physics.stability", "tools.limits", "physics.working", "physics.fatigue"
"""Packages that add to the records of a run: each has a PART in its module `part`."""
MISSED = {
    "physics.accuracy.step_error": "control of its steps, and errors by them",
    "physics.reactions.seat_reactions": "reactions of the seats",
    "physics.stability.stability": "buckling and snap-through",
    "tools.further_runs.error_estimates": "errors by mesh, section and contact",
    "tools.limits.before_run": "checks by the standards",
}
"""What every run is without where a module is missing; all others are missed only by a case that names them."""


def installed(module: str) -> ModuleType | None:
    """A module of an optional package by its name below `coilset.model`, None if it is not installed."""
    return optional(f"coilset.model.{module}")


@cache
def parts() -> tuple[Part, ...]:
    """What installed packages add to the records."""
    modules = (installed(f"{name}.part") for name in RECORDED)
    return tuple(module.PART for module in modules if module is not None)


def lacking() -> list[Warning]:
    """One warning that names what the run is without, if anything."""
    lacks = {module: missing(f"coilset.model.{module}") for module in MISSED}
    names = [name.removeprefix("coilset.model.") for name in lacks.values() if name]
    if not names:
        return []
    words = "; ".join(MISSED[module] for module, name in lacks.items() if name)
    return [
        Warning(
            "packages", "", f"this installation lacks {', '.join(dict.fromkeys(names))}; the run is without {words}"
        )
    ]
