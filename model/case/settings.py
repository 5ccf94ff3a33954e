"""Entries replaced by their path: `--set mesh.elements_per_turn=32`, and what a sweep varies."""

from coilset.model.case.yaml import load_yaml
from coilset.model.errors import InputError


def assign(data, setting):
    """Carry out one `--set key=value` on nested data; the value is read as YAML.

    Raises:
        InputError: if the setting has no `=`, or its path leads through something that has no entries.
    """
    path, equals, text = setting.partition("=")
    place = f"--set {setting}"
    if not equals or not path:
        raise InputError("give it as key=value, as in mesh.elements_per_turn=32", place)
    put(data, path, load_yaml(text, place), place)


def put(data, path, value, place):
    """Replace the entry at `path`, such as `loading.0.steps`, in nested data; `place` is where the user asked for it.

    Raises:
        InputError: if the path leads through something that has no entries.
    """
    *parents, last = path.split(".")
    for part in parents:
        data = _entry(data, part, place)
    if isinstance(data, list):
        data[_index(data, last, place)] = value
    else:
        data[last] = value


def _entry(data, part, place):
    if isinstance(data, list):
        return data[_index(data, part, place)]
    child = data.setdefault(part, {})
    if child is None:
        child = data[part] = {}
    if not isinstance(child, (dict, list)):
        raise InputError(f"'{part}' is {child!r} and has no entries of its own", place)
    return child


def _index(data, part, place):
    if not part.isdigit() or int(part) >= len(data):
        raise InputError(f"'{part}' is not an entry of this list; give a number from 0 to {len(data) - 1}", place)
    return int(part)
