"""The doors to optional packages: what a file names is imported when it is named, and refused where it is missing."""

import importlib
from types import ModuleType

from coilset.model.base.errors import InputError


def package(module: str, purpose: str, place: str = "") -> ModuleType:
    """A module of an optional package.

    Args:
        module: its name, as in `coilset.model.section.warping`.
        purpose: what needs it, in words.
        place: entry of the case that does.

    Raises:
        InputError: if this installation does not have it.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{module}.".startswith(f"{error.name}."):
            raise  # one of its own imports
        raise InputError(f"{purpose} needs the package {module}, which this installation lacks", place) from None
