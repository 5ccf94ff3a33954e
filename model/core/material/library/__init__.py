"""The material library: one YAML file a material, beside this module; users name their own file instead."""

from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from coilset.model.core.base.entry import shortened
from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.file import read
from coilset.model.core.material.law.law import Law

FOLDER = Path(str(resources.files(__package__)))


@cache
def names() -> tuple[str, ...]:
    """Names of the materials that come with coilset."""
    return tuple(sorted(path.name.removesuffix(".yaml") for path in FOLDER.iterdir() if path.name.endswith(".yaml")))


def load(name: str | Path, **options: Any) -> Law:
    """Load a material.

    Args:
        name: name of a library material, as in `names()`, or path of a material file (.yaml or .yml).
        options: `spin`, see `Law`.

    Returns:
        A `Law`.

    Raises:
        InputError: if there is no such material, or its file is wrong.
    """
    name = str(name)
    if name.endswith((".yaml", ".yml")):
        return Law(read(name), file=name, **options)
    if name not in names():
        known = ", ".join(names())
        raise InputError(
            f"'{shortened(name)}' is neither a material of the library ({known}) nor a .yaml file; a standard wire "
            "is given as in {wire: EN 10270-1 SH}",
            "material",
        )
    path = FOLDER / f"{name}.yaml"
    return Law(read(path), file=path, **options)
