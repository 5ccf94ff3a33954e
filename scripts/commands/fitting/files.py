"""Files that the commands of `coilset material` write: material files and pictures in a folder of results."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coilset.model.core.base.errors import InputError
from coilset.scripts.terminal.target import UNFIT, results_folder

if TYPE_CHECKING:  # commands load what they need
    from matplotlib.figure import Figure

    from coilset.scripts.terminal.console import Console


def files_to_write(out: str | None, name: str, force: bool, *files: str) -> list[Path]:
    """Files that a command will write, in `out`, by default results/material/NAME: found before it computes any.

    Raises:
        InputError: one is there, and not to be overwritten, or the name would lead to another folder.
    """
    from coilset.model.core.results.files.folder import refuse_to_replace

    if leading := next((file for file in files if UNFIT.search(file)), ""):
        raise InputError(f"'{leading}' is no name of a file; a material's name has no /", "--name")
    folder = results_folder(out, name, "material")
    paths = [folder / file for file in files]
    refuse_to_replace(paths, force)
    return paths


def write_material(file: Path, content: dict[str, Any], console: "Console") -> None:
    """Write a material file."""
    import yaml

    from coilset.model.core.results.files.folder import make, whole

    make(file.parent)
    with whole(file) as path:
        path.write_text(yaml.safe_dump(content, sort_keys=False, allow_unicode=True), encoding="utf-8")
    console.say(f"material file in {file}")


def write_picture(figure: "Figure", path: Path, console: "Console") -> None:
    """Write a figure as PNG."""
    from coilset.model.core.results.files.folder import make
    from coilset.model.tools.figures.png import save

    make(path.parent)
    save(figure, path)
    console.say(f"picture in {path.parent}{os.sep}{path.name}")
