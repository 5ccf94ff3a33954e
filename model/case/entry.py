"""Entries of input files: their strict base, and what was wrong with them in one line."""

from difflib import get_close_matches

from coilset.meshes.entry import Strict

__all__ = ["Strict", "explain"]


def explain(error):
    """Place and problem of a pydantic error, in one line: the value that was given, and what would be right."""
    found = error.errors()
    # a misspelt entry first: the one that it was meant for is reported as missing besides
    first = next((one for one in found if one["type"] == "extra_forbidden"), found[0])
    # names of the alternatives that pydantic tried are no entries of the file: `target`, `block`, `(number)`
    parts = [str(part) for part in first["loc"]]
    place = ".".join(part for part in parts if part not in ("target", "block") and not part.startswith("("))
    given = "" if first["type"] in ("missing", "value_error") else f"{first['input']!r}: "
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "extra_forbidden":
        missing = [one["loc"][-1] for one in found if one["type"] == "missing" and one["loc"][:-1] == first["loc"][:-1]]
        near = get_close_matches(str(first["loc"][-1]), map(str, missing), 1)
        message, given = f"unknown entry; is {near[0]} meant?" if near else "unknown entry; is it misspelt?", ""
    elif first["type"] == "missing":
        message = "this entry is required"
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return place, f"{given}{message}{more}"
