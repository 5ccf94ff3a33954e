"""Entries replaced by their path: `--set mesh.elements_per_turn=32`, and the inputs of a sweep."""

from pathlib import Path
from typing import Any

from coilset.model.core.base.entry import shortened, shown
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.yaml import load_yaml

FILES = ("material", "spring.file")  # entries that are paths, or may be


def located(entry: str, value: Any, folder: str | Path) -> Any:
    """The value of an entry; a relative path in it, counted from `folder`, is led there.

    Args:
        entry: the entry's path, such as `spring.file`.
        value: its value, of any kind.
        folder: where the value was written.
    """
    if isinstance(value, dict):
        return {name: located(f"{entry}.{name}", inner, folder) for name, inner in value.items()}
    names_file = entry in FILES and isinstance(value, str)
    if names_file and (entry != "material" or value.endswith((".yaml", ".yml"))):
        return str(Path(folder) / value)
    return value


def assign(data: dict[str, Any], setting: str) -> None:
    """Carry out one `--set key=value` on nested data; the value is read as YAML, a path counts from where we are.

    Raises:
        InputError: if the setting has no `=`, or its path leads through something that has no entries.
    """
    entry, equals, text = setting.partition("=")
    place = f"--set {shortened(setting)}"
    if not equals or not entry:
        raise InputError("give it as key=value, as in mesh.elements_per_turn=32", place)
    put(data, entry, located(entry, load_yaml(text, place), Path.cwd()), place)


def put(data: dict[str, Any], entry: str, value: Any, place: str) -> None:
    """Replace the entry at the path `entry`, such as `loading.0.steps`, in nested data.

    Args:
        data: changed in place.
        entry: where to; groups that are not there are made.
        value: the new value.
        place: source of the setting, for messages.

    Raises:
        InputError: if the path leads through something that has no entries.
    """
    *parents, last = entry.split(".")
    group: Any = data
    for part in parents:
        group = _inside(group, part, place)
    if isinstance(group, list):
        group[_index(group, last, place)] = value
    else:
        group[last] = value


def value_at(data: Any, entry: str, missing: Any = None) -> Any:
    """The value at the path `entry` of nested data, or what is given for one that is missing."""
    for part in entry.split("."):
        try:
            data = data[int(part)] if isinstance(data, list) else data[part]
        except (KeyError, IndexError, ValueError, TypeError):
            return missing
    return data


def _inside(group: Any, part: str, place: str) -> Any:
    if isinstance(group, list):
        child = group[_index(group, part, place)]
    else:
        child = group.setdefault(part, {})
        if child is None:
            child = group[part] = {}
    if not isinstance(child, dict | list):
        raise InputError(f"'{shortened(part)}' is {shown(child)} and has no entries of its own", place)
    return child


def _index(group: list[Any], part: str, place: str) -> int:
    if not (part.isascii() and part.isdigit()) or len(part) > 9 or int(part) >= len(group):
        problem = f"'{shortened(part)}' is not an entry of this list; give a number from 0 to {len(group) - 1}"
        raise InputError(problem if group else f"'{shortened(part)}': this list is empty", place)
    return int(part)
