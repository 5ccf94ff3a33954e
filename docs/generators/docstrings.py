"""Docstrings as they are written here, made reStructuredText: signs in formulas are no markup, indented blocks stay."""

import re
from typing import Annotated, get_origin

from sphinx.application import Sphinx

MARKUP = re.compile(r"(`[^`]*`)|([|*])")  # what stands between backticks is left alone


def process(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    """Rewrite the lines of one docstring in place; called by autodoc before the sections are read."""
    written: list[str] = []
    formula, before = False, 0  # are we in an indented block, and how far is the text before it indented
    for line in lines:
        indent = len(line) - len(line.lstrip())
        starts = bool(line.strip()) and bool(written) and not written[-1].strip()
        if starts and not formula and indent >= before + 4:
            formula = True
            written += [" " * before + "::", ""]
        elif line.strip() and formula and indent <= before:
            if not starts:
                written.append("")
            formula = False
        if line.strip() and not formula:
            before = indent
        written.append(line if formula else MARKUP.sub(lambda sign: sign[1] or "\\" + sign[2], line))
    lines[:] = written


def skip(app: Sphinx, what: str, name: str, thing: object, is_skipped: bool, options: object) -> bool | None:
    """Leave out types of entries, which the pages of the files have in words, and fields of named tuples.

    Python describes such a field as "Alias for field number 0"; the class describes what it is.
    """
    alias = (getattr(thing, "__doc__", None) or "").startswith("Alias for field number")
    return True if alias or get_origin(thing) in (Annotated, dict) else None
