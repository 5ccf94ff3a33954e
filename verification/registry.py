"""The cases of verification, found as the modules of `coilset.verification.cases`."""

import importlib
import inspect
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches

from coilset.model.core.base.entry import shortened
from coilset.model.core.base.errors import InputError
from coilset.verification import cases
from coilset.verification.study import Study


@dataclass(frozen=True)
class Case:
    """One case: its name, title, text, whether it takes seconds only, the function that fills a Study, and why numbers
    of it are not met, empty where all are."""

    name: str
    title: str
    text: str
    fast: bool
    run: Callable[[Study], None]
    unmet: str = ""


def names() -> list[str]:
    """Names of all cases, in alphabetical order."""
    return sorted(_modules())


def _modules() -> dict[str, str]:
    """Name of each case → its module, in any folder of `cases`."""
    found = pkgutil.walk_packages(cases.__path__, f"{cases.__name__}.")
    return {one.name.rpartition(".")[2].replace("_", "-"): one.name for one in found if not one.ispkg}


def load(name: str) -> Case:
    """The case of a name.

    Raises:
        InputError: if there is none of this name.
    """
    modules = _modules()
    if name not in modules:
        near = get_close_matches(name, modules, 1)
        hint = f"is {near[0]} meant?" if near else "coilset verify --list lists them"
        raise InputError(f"'{shortened(name)}' is not a case; {hint}", "verify")
    module = importlib.import_module(modules[name])
    title, _, text = (inspect.getdoc(module) or "").partition("\n")
    return Case(name, title, text.strip(), getattr(module, "FAST", False), module.run, getattr(module, "UNMET", ""))
