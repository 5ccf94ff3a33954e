"""The wires that come with coilset, and those in the user's folder, ~/.config/coilset/wires."""

import os
from difflib import get_close_matches
from functools import cache
from pathlib import Path

from coilset.model.core.base.entry import check_entries, shortened
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.yaml import read_data
from coilset.model.tools.wires.wire import Wire
from coilset.model.tools.wires.wire_file import WireFile, with_common

FOLDER = Path(__file__).parent
MANY = 6  # wires that a message names


def own_folder() -> Path:
    """Folder of the user's own wire files, in the form of those beside this module; it need not exist."""
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config", "coilset", "wires")


@cache
def files() -> dict[str, WireFile]:
    """The checked files by the name of their standard.

    Raises:
        InputError: if a file of the user is wrong, or has the name of a standard that is there already.
    """
    read: dict[str, WireFile] = {}
    for path in (*sorted(FOLDER.glob("*.yaml")), *sorted(own_folder().glob("*.yaml"))):
        file = check_entries(with_common(read_data(path, "holds standard, sources and wires")), WireFile, path)
        if file.standard in read:
            raise InputError(f"'{file.standard}' is there already; give another name", "standard", path)
        read[file.standard] = file
    return read


@cache
def _wires() -> dict[str, Wire]:
    known = [(f"{file.standard} {entry.grade}", file, entry) for file in files().values() for entry in file.wires]
    return {name: Wire(name, file.standard, entry, file.sources) for name, file, entry in known}


def names() -> list[str]:
    """Names of all wires, such as `EN 10270-1 SH` or `ASTM A228`."""
    return list(_wires())


def wire(name: str) -> Wire:
    """A wire by its name; case and the number of spaces do not matter.

    Raises:
        InputError: if there is no such wire.
    """
    by_key = {_key(known): known for known in names()}
    if _key(name) not in by_key:
        parts = [key for key in by_key if _key(name) and (key.endswith(_key(name)) or key.startswith(_key(name)))]
        near = [by_key[key] for key in parts or get_close_matches(_key(name), by_key, 1, 0.7)]
        known = f"is {' or '.join(near)} meant?" if 0 < len(near) <= MANY else "`coilset sheet --wires` lists them"
        raise InputError(f"'{shortened(name)}' is not a known wire; {known}", "material.wire")
    return _wires()[by_key[_key(name)]]


def _key(name: object) -> str:
    return "".join(str(name).split()).casefold()
