"""Entries of an input file, read off its models: the rows of the reference, and of the test that compares.

A group is a model of pydantic or a dataclass. Its unit is an `annotated_types.Unit` beside the type, `1` for a real
number without one; its meaning is the description of its Field, its line under Attributes, or what its group is.
"""

import inspect
import re
from collections.abc import Iterator, Sequence
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from annotated_types import Ge, Gt, Le, Lt, MinLen, Unit
from pydantic import AfterValidator, BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from coilset.model.core.base.package import Entry

KINDS = {float: "number", int: "whole number", str: "text", bool: "`true`, `false`", Any: "any value"}
PLURALS = {"number": "numbers", "whole number": "whole numbers", "text": "texts", "any value": "any values"}
UNITLESS = {"1": "", "of the option": "", "turns": ""}  # words of the reference that no axis needs
SIGNS = {Gt: ("gt", ">"), Ge: ("ge", "≥"), Lt: ("lt", "<"), Le: ("le", "≤")}


@dataclass(frozen=True)
class Form:
    """One form that a value may have.

    Attributes:
        kind: in words, such as `number` or `list of numbers`.
        range: its bounds, in signs; empty without bounds.
        unit: of a number; empty where none is given.
        is_real: whether it holds real numbers, which need a unit.
        groups: classes of the groups of entries in it.
    """

    kind: str
    range: str = ""
    unit: str = ""
    is_real: bool = False
    groups: tuple[type, ...] = ()


@dataclass(frozen=True)
class Row:
    """One entry of a group, as the reference shows it."""

    name: str
    default: str
    meaning: str
    forms: tuple[Form, ...]

    @property
    def unit(self) -> str:
        """Units of all forms, the first first."""
        return ", ".join(dict.fromkeys(form.unit for form in self.forms if form.unit))

    @property
    def range(self) -> str:
        """Bounds of a number, in signs."""
        return ", ".join(dict.fromkeys(form.range for form in self.forms if form.range))

    @property
    def groups(self) -> tuple[type, ...]:
        """Classes of the groups that are allowed here."""
        return tuple(group for form in self.forms for group in form.groups)


@dataclass
class Group:
    """A group of entries and its places in the file."""

    model: type
    rows: list[Row]
    places: list[str] = field(default_factory=list)


def groups(model: type) -> list[Group]:
    """The group of a class, of pydantic or a dataclass, and all groups in it, each once, in the order of a reader."""
    found: dict[type, Group] = {}
    _visit(model, "", found)
    return list(found.values())


def _visit(model: type, place: str, found: dict[type, Group]) -> None:
    if model in found:
        if place not in found[model].places:
            found[model].places.append(place)
        return
    found[model] = group = Group(model, rows(model), [place])
    for row in group.rows:
        for inner in row.groups:
            _visit(inner, f"{place}.{row.name}".lstrip("."), found)


def rows(model: type) -> list[Row]:
    """The entries of one group, without those of the groups in it."""
    if issubclass(model, BaseModel):
        return [
            _row(item.alias or name, item.annotation, item.metadata, _default(item), item.description)
            for name, item in model.model_fields.items()
        ]
    assert is_dataclass(model)
    hints, meanings = get_type_hints(model, include_extras=True), attributes(model)
    return [
        _row(
            item.name,
            hints[item.name],
            (),
            _shown(item.default, item.default is MISSING),
            meanings.get(item.name, "").rstrip("."),
        )
        for item in fields(model)
    ]


def entry_unit(model: type, entry: str) -> str:
    """Unit of the number at an entry's path, such as `loading.0.to.travel`; empty where it has none.

    Args:
        model: a model of pydantic, or a dataclass.
        entry: the path; places in a list may be left out.
    """
    places, row = [model], None
    for name in entry.split("."):
        if not name.isdigit():
            row = next((row for place in places for row in rows(place) if row.name == name), None)
            if row is None:
                return ""
            places = list(row.groups)
    return UNITLESS.get(row.unit, row.unit) if row else ""


def attributes(model: type) -> dict[str, str]:
    """Meanings of a class's attributes, from the section `Attributes:` of its docstring."""
    text = (inspect.getdoc(model) or "").partition("Attributes:\n")[2]
    entries = re.findall(r"^ {4}(\w[\w, ]*): (.*(?:\n {8,}.*)*)", text, re.MULTILINE)
    return {name: " ".join(words.split()) for names, words in entries for name in names.split(", ")}


def summary(model: type) -> str:
    """The first paragraph of a class's docstring, in one line."""
    return " ".join((inspect.getdoc(model) or "").partition("\n\n")[0].split())


def _row(name: str, annotation: Any, metadata: Sequence[Any], default: str, meaning: str | None) -> Row:
    forms = tuple(_forms(annotation, tuple(metadata)))
    inner = [group for form in forms for group in form.groups]
    if not meaning and len(forms) == 1 and re.fullmatch("`[^`]+`", forms[0].kind):
        meaning = "the word that selects this group"
    meaning = meaning or next(_descriptions(annotation), "") or (summary(inner[0]).rstrip(".") if inner else "")
    return Row(name, default, meaning, forms)


def _descriptions(annotation: Any) -> Iterator[str]:
    """Descriptions of Fields within a type."""
    for extra in getattr(annotation, "__metadata__", ()):
        if isinstance(extra, FieldInfo) and extra.description:
            yield extra.description
    if get_origin(annotation) in (Annotated, Union, UnionType):
        yield from _descriptions(get_args(annotation)[0])


def _forms(annotation: Any, metadata: tuple[Any, ...]) -> Iterator[Form]:
    """The forms that a type allows; `metadata` belongs to it, that of the innermost first."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    entry = next((extra for extra in metadata if isinstance(extra, Entry)), None)
    if entry:
        yield from _forms(entry.type, tuple(extra for extra in metadata if extra is not entry))
    elif origin is Annotated:
        within: list[Any] = []
        for extra in annotation.__metadata__:
            within += extra.metadata if isinstance(extra, FieldInfo) else [extra]
        yield from _forms(arguments[0], (*within, *metadata))
    elif origin in (Union, UnionType):
        for one in arguments:
            yield from _forms(one, metadata)
    elif origin is Literal:
        yield Form(", ".join(f"`{word}`" for word in arguments))
    elif origin in (list, tuple):
        inner = list(_forms(arguments[0], ()))
        yield _collected("list of ", inner, metadata, _least(metadata))
    elif origin is dict:
        yield _collected("names, each with ", list(_forms(arguments[1], ())), metadata, "")
    elif isinstance(annotation, type) and (issubclass(annotation, BaseModel) or is_dataclass(annotation)):
        yield Form("group", groups=(annotation,))
    elif annotation is not NoneType:
        yield Form(KINDS[annotation], _range(metadata), _unit(metadata), annotation is float)


def _collected(words: str, inner: list[Form], metadata: tuple[Any, ...], least: str) -> Form:
    return Form(
        words + " or ".join(dict.fromkeys(PLURALS.get(form.kind, form.kind) for form in inner)),
        ", ".join(filter(None, [least, *dict.fromkeys(form.range for form in inner)])),
        _unit(metadata) or next((form.unit for form in inner if form.unit), ""),
        any(form.is_real for form in inner),
        tuple(group for form in inner for group in form.groups),
    )


def _unit(metadata: tuple[Any, ...]) -> str:
    """The outermost unit: an entry's own goes before its type's."""
    return next((extra.unit for extra in reversed(metadata) if isinstance(extra, Unit)), "")


def _least(metadata: tuple[Any, ...]) -> str:
    least = next((extra.min_length for extra in metadata if isinstance(extra, MinLen)), 0)
    return f"at least {least}" if least else ""


def _range(metadata: tuple[Any, ...]) -> str:
    """Bounds in signs; a validator with bounds of its own gives them in its docstring."""
    own = [(inspect.getdoc(extra.func) or "").rstrip(".") for extra in metadata if isinstance(extra, AfterValidator)]
    bounds = [
        f"{SIGNS[type(extra)][1]} {_number(getattr(extra, SIGNS[type(extra)][0]))}"
        for extra in metadata
        if type(extra) in SIGNS
    ]
    return ", ".join(own or bounds)


def _number(value: float) -> str:
    size = f"{abs(value):,}" if isinstance(value, int) else f"{abs(value):g}"
    return f"−{size}" if value < 0 else size


def _default(item: FieldInfo) -> str:
    if item.default is PydanticUndefined and item.default_factory is not None:
        return _shown(item.get_default(call_default_factory=True), False)
    return _shown(item.default, item.is_required())


def _shown(default: Any, is_required: bool) -> str:
    if is_required:
        return "required"
    if isinstance(default, BaseModel) or is_dataclass(default):
        return "that of its entries"
    if default is None or default == "":
        return "none"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    return f"`{default:g}`" if isinstance(default, float) else f"`{default}`"
