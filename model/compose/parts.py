"""The optional packages that take part in a run without being named in its case, as far as they are installed."""

from functools import cache
from types import ModuleType

from coilset.model.core.base.package import optional
from coilset.model.core.base.warning import Warning
from coilset.model.core.results.records.part import Part

RECORDED = "physics.stability", "tools.limits", "physics.working", "physics.fatigue"
"""Packages that add to the records of a run: each has a PART in its module `part`."""
MISSED = {
    "physics.accuracy": "errors by the steps",
    "physics.reactions": "reactions of the seats",
    "physics.stability": "buckling and snap-through",
    "tools.further_runs": "errors by mesh, section and contact",
    "tools.limits": "checks by the standards",
}
"""What every run is without where a package is missing; all others are missed only by a case that names them."""


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
    missed = {name: words for name, words in MISSED.items() if installed(name) is None}
    if not missed:
        return []
    without, packages = "; ".join(missed.values()), ", ".join(missed)
    return [Warning("packages", "", f"this installation lacks {packages}; the run is without {without}")]
