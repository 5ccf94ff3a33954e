"""Entries of input files: their strict base class, their checks, and one-line error messages."""

import re
import reprlib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from coilset.model.core.base.errors import InputError
from coilset.model.core.base.strict_entries import WORD_OR_NUMBER, Strict, Whole

__all__ = ["WORD_OR_NUMBER", "Strict", "Whole", "check_entries", "explain", "shown"]

Group = TypeVar("Group", bound=Strict)

LONGEST = 60  # characters of a value or a name in a message
OWN = ("unknown_entry", "missing_entry", "wrong_option")  # errors that name their entry themselves
TEXTS = {  # what would be right, where pydantic's messages are meant for programmers
    "dict_type": "must be a group of entries, as in {name: value}",
    "list_type": "must be a list, as in [1, 2]",
    "tuple_type": "must be a list, as in [1, 2]",
    "string_type": "must be a word",
    "int_type": "must be a whole number",
    "float_type": "must be a number",
    "bool_type": "must be true or false",
    "string_pattern_mismatch": "must be a name of letters, digits, _ and in a sweep also full stops",
}
ALTERNATIVES = {
    "(word)": ", or a number",
    "(none)": ", or a group of constants",
    "(block)": ", or a target as in {travel: 5}",
    "(part)": ", or none; 0.2 % is 0.002",
}  # to a word, by its tag
_short = reprlib.Repr()
_short.maxlevel, _short.maxdict, _short.maxlist, _short.maxtuple = 3, 4, 6, 6
_short.maxstring = _short.maxlong = _short.maxother = LONGEST


def shown(value: Any) -> str:
    """A value as shown in messages: in one line of at most `LONGEST` characters."""
    text = " ".join(_short.repr(value).split())
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def shortened(text: str, longest: int = LONGEST) -> str:
    """A user's text as shown in messages, without quotation marks."""
    text = " ".join(str(text).split())
    text = "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text[: longest + 1])
    return text if len(text) <= longest else text[: longest - 3] + "..."


def explain(error: ValidationError) -> tuple[str, str]:
    """Place and problem of a pydantic error, in one line: the value given, and what would be right."""
    found = _innermost(error.errors(include_url=False))
    # a misspelt entry first: the entry that was meant is also reported, as missing
    first = next((one for one in found if one["type"] == "unknown_entry"), found[0])
    context = first.get("ctx", {})
    # names in brackets are not entries of the file: tags of alternatives, or a marker for an entry's name
    parts = [shortened(part) for part in first["loc"] if not re.fullmatch(r"\(.*\)|\[key\]", str(part))]
    if first["type"] in OWN:
        parts.append(shortened(context["entry"]))
    given = "" if first["type"] in (*OWN, "value_error") else f"{shown(first['input'])}: "
    problem = TEXTS.get(first["type"]) or _in_words(first["msg"])
    if first["type"] in ("float_type", "int_type") and isinstance(first["input"], str):
        problem += _number_in_words(first["input"])
    problem += ALTERNATIVES.get(first["loc"][-1], "") if first["loc"] else ""
    if first["type"] == "string_type" and isinstance(first["input"], int | float):
        problem += "; a number in quotation marks is one"
    more = f" (the first of {len(found)} errors)" if len(found) > 1 else ""
    return ".".join(parts), f"{given}{problem}{more}"


def _number_in_words(text: str) -> str:
    """The message for a number given as a word, such as `5,0` or `5 mm`."""
    if re.fullmatch(r"\s*[-+]?\d+,\d+\s*%?\s*", text):
        return f" with a decimal point, as in {text.strip().replace(',', '.')}"
    if re.fullmatch(r"\s*[-+]?\d*\.?\d+\s*[^\d\s.,:][^\d]{0,9}", text):
        return " without its unit; units are N, mm, MPa and K everywhere"
    return ""


def _innermost(found: list[Any]) -> list[Any]:
    """Without errors that follow from an inner one: a list whose only value is wrong is also too short."""
    outside = {one["loc"][:depth] for one in found for depth in range(len(one["loc"]))}
    return [one for one in found if one["loc"] not in outside]


def _in_words(message: str) -> str:
    """Pydantic's message as the rest of a sentence."""
    message = message.removeprefix("Value error, ").replace(" after validation", "")
    return re.sub(r"^(Input|String|List|Tuple|Dictionary) should (be|have|match)", r"must \2", message)


def check_entries(data: Any, model: type[Group], file: str | Path = "") -> Group:
    """The checked `model` of raw data.

    Args:
        data: raw data, as `read_data` gives it.
        model: class of the entries.
        file: where they come from; paths in them count from its folder.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    try:
        return model.model_validate(data, context={"folder": Path(file).parent})
    except ValidationError as error:
        place, problem = explain(error)
        raise InputError(problem, place, file) from None
