"""The only YAML reader: every message has line and column, and every file has exactly one meaning.

Words and numbers are read as by the core schema of YAML 1.2: `1e6` is a number, `yes` and `12:30:00` are words, `010`
is ten. Names of entries are always words.
"""

import re
from pathlib import Path
from typing import Any

import yaml

from coilset.model.core.base.entry import shortened
from coilset.model.core.base.errors import InputError

MAX_NESTING = 40  # levels of nesting; a case has six
LARGEST = 1_000_000  # values of a file; those repeated by aliases count each time

TAG = "tag:yaml.org,2002:"
SCALARS = (  # of the core schema of YAML 1.2.2, 10.3.2
    ("null", r"(?:~|null|Null|NULL|)", [*"~nN", ""]),
    ("bool", r"(?:true|True|TRUE|false|False|FALSE)", list("tTfF")),
    ("int", r"(?:[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)", list("-+0123456789")),
    (
        "float",
        r"(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))",
        list("-+0123456789."),
    ),
)
LONGEST_FILE = 2_000_000  # bytes; reading takes some 6 s a million
# Not allowed in file names, or orders to a terminal: all controls but tab and the ends of lines.
UNFIT = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff]")


class _Loader(yaml.loader.BaseLoader):
    """Nodes of a document, nested at most `MAX_NESTING` levels deep."""

    depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        """PyYAML's method, with a count of levels: it is recursive, and Python's stack is limited."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            problem = f"nested deeper than {MAX_NESTING} levels"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=self.peek_event().start_mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


for _tag, _pattern, _first in SCALARS:
    _Loader.add_implicit_resolver(TAG + _tag, re.compile(f"^{_pattern}$"), _first)


class _Values:
    """Plain data of nodes. An alias becomes a copy, so that changing it does not change the original."""

    def __init__(self) -> None:
        self.count = 0

    def of(self, node: yaml.Node, depth: int = 0) -> Any:
        """The value of a node."""
        self.count += 1
        if self.count > LARGEST:
            raise _problem(node, f"more than {LARGEST:,} values; are aliases repeated by aliases?")
        if depth > MAX_NESTING:  # deeper than its text: through aliases
            raise _problem(node, f"nested deeper than {MAX_NESTING} levels; does an alias refer to what contains it?")
        kind = node.tag.removeprefix(TAG)
        if isinstance(node, yaml.MappingNode) and kind == "map":
            return self._mapping(node, depth)
        if isinstance(node, yaml.SequenceNode) and kind == "seq":
            return [self.of(child, depth + 1) for child in node.value]
        if isinstance(node, yaml.ScalarNode):
            return _scalar(node, kind)
        raise _problem(node, f"the tag {shortened(node.tag)} is not supported")

    def _mapping(self, node: yaml.MappingNode, depth: int) -> dict[str, Any]:
        entries: dict[str, Any] = {}
        for name, value in node.value:
            if not isinstance(name, yaml.ScalarNode):
                raise _problem(name, "an entry's name must be a word")
            if _word(name) in entries:
                raise _problem(name, f"the entry '{shortened(name.value)}' is given twice")
            entries[name.value] = self.of(value, depth + 1)
        return entries


def _scalar(node: yaml.ScalarNode, kind: str) -> str | int | float | bool | None:
    text = node.value
    try:
        if kind == "null":
            return None
        if kind == "bool":
            return {"true": True, "false": False}[text.lower()]
        if kind == "int":
            base = {"0o": 8, "0x": 16}.get(text[:2], 10)
            return int(text if base == 10 else text[2:], base)
        if kind == "float":
            return float(re.sub(r"\.(inf|nan)$", r"\1", text.lower()))
    except (ValueError, KeyError):
        raise _problem(node, f"'{shortened(text)}' cannot be read as the number or truth value it should be") from None
    if kind == "str":
        return _word(node)
    raise _problem(node, f"the tag {shortened(node.tag)} is not supported")


def _word(node: yaml.ScalarNode) -> str:
    if UNFIT.search(node.value):
        raise _problem(node, "there is a character in this text that is none, such as NUL or ESC")
    return node.value


def _problem(node: yaml.Node, problem: str) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


def load_yaml(text: str, file: str | Path = "") -> Any:
    """Plain data of a YAML document: dicts, lists, words, numbers, truth values and None.

    Raises:
        InputError: with line and column.
    """
    try:
        node = yaml.compose(text, Loader=_Loader)
        return None if node is None else _Values().of(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = ", ".join(filter(None, [error.context, error.problem]))
        if r"'\t'" in problem:
            problem = "there is a tab at the start; indent with spaces"
        raise InputError(f"not readable as YAML: {shortened(problem, 200)}", place, file) from None
    except yaml.YAMLError as error:
        raise InputError(f"not readable as YAML: {shortened(str(error), 200)}", "", file) from None


def read_data(path: str | Path, kind: str = "") -> dict[str, Any]:
    """Read a YAML file of entries, unchecked.

    Args:
        path: the YAML file.
        kind: what such a file holds, for the message about a file that is not a mapping.

    Raises:
        InputError: if it cannot be read.
    """
    if not str(path):  # otherwise Path would turn it into the current folder
        raise InputError("the name of the file is empty")
    path = Path(path)
    try:
        with open(path, "rb") as file:
            data = file.read(LONGEST_FILE + 1)
        text = "" if len(data) > LONGEST_FILE else data.decode("utf-8-sig")
    except (OSError, ValueError) as error:  # a path with NUL, or a text in another encoding, is a ValueError
        reason = getattr(error, "strerror", None) or "it is not a text file in UTF-8"
        raise InputError(f"the file cannot be read: {reason}", "", path) from None
    if len(data) > LONGEST_FILE:
        raise InputError(f"is longer than {LONGEST_FILE / 1e6:g} MB; a file of entries is not", "", path)
    entries = load_yaml(text, path)
    if not isinstance(entries, dict):
        raise InputError(kind or "must hold entries, as in name: value", "", path)
    return entries
