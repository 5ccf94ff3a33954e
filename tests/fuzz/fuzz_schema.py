"""Do plain data keep what the reference says? A reader of JSON schemas, so that pydantic is not its own judge."""

import math
import re
from datetime import date
from operator import ge, gt, le, lt
from typing import Any

IN_SHORT = {"EndCoils": (str, "form"), "Values": (list, "values")}  # groups that one of their entries may stand for


def breaches(data: Any, schema: dict, defs: dict, place: str = "") -> list[str]:
    """Where data break a schema, one line for each; empty if nowhere."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        kind, entry = IN_SHORT.get(name, (None, ""))
        return breaches({entry: data} if kind and isinstance(data, kind) else data, defs[name], defs, place)
    for words in ("anyOf", "oneOf"):
        if words in schema:
            tries = [breaches(data, one, defs, place) for one in schema[words]]
            return [] if [] in tries else min(tries, key=len)
    if "const" in schema and (data != schema["const"] or isinstance(data, bool) != isinstance(schema["const"], bool)):
        return [f"{place}: {data!r} is not {schema['const']!r}"]
    if "enum" in schema and (data not in schema["enum"] or isinstance(data, bool)):
        return [f"{place}: {data!r} is none of {schema['enum']}"]
    if (kind := schema.get("type")) and not KINDS[kind](data):
        return [f"{place}: {data!r} is no {kind}"]
    found = [] if schema.get("type") not in ("number", "integer") else _number(data, schema, place)
    if isinstance(data, dict):
        found += _group(data, schema, defs, place)
    if isinstance(data, list):
        found += [f"{place}: too few"] if len(data) < schema.get("minItems", 0) else []
        for number, (value, one) in enumerate(zip(data, _items(schema, len(data)), strict=False)):
            found += breaches(value, one, defs, f"{place}.{number}")
    if isinstance(data, str) and "pattern" in schema and not re.search(schema["pattern"], data):
        found.append(f"{place}: {data!r} does not match")
    return found


def _is_number(data: Any) -> bool:
    return isinstance(data, int | float) and not isinstance(data, bool) and math.isfinite(data)


KINDS = {
    "number": _is_number,
    "integer": lambda data: _is_number(data) and data == int(data),
    "string": lambda data: isinstance(data, str | date),  # YAML reads a date from its text
    "boolean": lambda data: isinstance(data, bool),
    "null": lambda data: data is None,
    "array": lambda data: isinstance(data, list),
    "object": lambda data: isinstance(data, dict),
}


BOUNDS = {"minimum": ge, "maximum": le, "exclusiveMinimum": gt, "exclusiveMaximum": lt}


def _number(data: float, schema: dict, place: str) -> list[str]:
    return [
        f"{place}: {data!r} breaks {name} {schema[name]}"
        for name, keeps in BOUNDS.items()
        if name in schema and not keeps(data, schema[name])
    ]


def _group(data: dict, schema: dict, defs: dict, place: str) -> list[str]:
    entries, more = schema.get("properties", {}), schema.get("additionalProperties", True)
    found = [f"{place}: {name} is missing" for name in schema.get("required", ()) if name not in data]
    for name, value in data.items():
        if name in entries:
            found += breaches(value, entries[name], defs, f"{place}.{name}")
        elif more is False and "properties" in schema:
            found.append(f"{place}: {name} is unknown")
        elif isinstance(more, dict):
            found += breaches(value, more, defs, f"{place}.{name}")
    return found


def _items(schema: dict, count: int) -> list[dict]:
    first = schema.get("prefixItems", [])
    return [*first, *[schema.get("items", {})] * (count - len(first))]
