"""Reference pages of the input files, made from their models: one table for each group of entries."""

import re
from pathlib import Path

from coilset.model.core.case import reference
from coilset.model.core.case.case import Case
from coilset.model.core.case.reference import Form, Group, Row
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.tools.design.file import DesignFile
from coilset.model.tools.identification.programs import Program
from coilset.model.tools.nest.file import NestFile
from coilset.model.tools.sweep.spec import SweepSpec

FILES = {  # name of the page: its title, what the file is for, its model
    "case": (
        "The case file",
        "A spring, its material, its ends, its mesh and its load program: the file of "
        "`coilset solve`, `coilset slice`, `coilset mesh` and `coilset sheet`.",
        Case,
    ),
    "material": (
        "The material file",
        "The constants of a law, at one temperature or more: the file of "
        "`coilset material`, and of the entry `material` of a case. [Material](../../material.md) has a whole "
        "one with remarks.",
        MaterialFile,
    ),
    "program": (
        "The program file",
        "Targets of strain and stress for one point: the file of `coilset material test`.",
        Program,
    ),
    "design": (
        "The design file",
        "A case, unknowns in it, and conditions: the file of `coilset design`. "
        "[Find dimensions](../../how-to/design.md) shows examples.",
        DesignFile,
    ),
    "nest": (
        "The nest file",
        "Two springs between the same seats: the file of `coilset nest`. "
        "[Nested springs](../../how-to/nested.md) shows one.",
        NestFile,
    ),
    "sweep": ("The sweep file", "A base case, and entries that vary: the file of `coilset sweep`.", SweepSpec),
}
NAMES = {  # of groups, where the name of the class alone would not do
    "Chaboche": "Chaboche",
    "HeatSpec": "heat flow",
    "NonNormality": "non-normality",
    "RambergOsgood": "Ramberg-Osgood",
    "Swift": "Swift",
    "Voce": "Voce",
}
COLUMNS = ("entry", "takes", "unit", "default", "range", "meaning")


def write(folder: Path) -> None:
    """Write the page of every file into a folder."""
    for name, (title, purpose, model) in FILES.items():
        sections = [section(name, group) for group in reference.groups(model)]
        head = f"# {title}\n\n{purpose} Units are N, mm, MPa = N/mm², K. A range is that of the numbers in the entry.\n"
        replace(folder / f"{name}.md", "\n".join([head, *sections]))


def section(page: str, group: Group) -> str:
    """One group: where it stands, what it is, and its table."""
    places = ", ".join(f"`{place}`" for place in group.places if place)
    label = f"({label_of(page, group.model)})=\n" if places else ""
    name = name_of(group.model)
    heading = f"## {name[0].upper()}{name[1:]}\n\nAt {places}." if places else "## The whole file"
    lines = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|", *(line(page, row) for row in group.rows)]
    return f"{label}{heading}\n\n{reference.summary(group.model)}\n\n" + "\n".join(lines) + "\n"


def line(page: str, row: Row) -> str:
    """One entry as a row of its table."""
    takes = ", ".join(dict.fromkeys(kind_of(page, form) for form in row.forms))
    cells = (f"`{row.name}`", takes, row.unit, row.default, row.range, row.meaning)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def kind_of(page: str, form: Form) -> str:
    """What an entry takes in one of its forms, with links to groups."""
    links = " or ".join(f"[{name_of(group)}](#{label_of(page, group)})" for group in form.groups)
    return re.sub(r"group( or group)*", links, form.kind) if links else form.kind


def name_of(model: type) -> str:
    """A group's name in words: `EndCoils` is `end coils`."""
    if model.__name__ in NAMES:
        return NAMES[model.__name__]
    words = "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in model.__name__).strip()
    return words.removesuffix(" spec").removesuffix(" file")


def label_of(page: str, model: type) -> str:
    """Target of links to a group."""
    return f"{page}-{model.__name__.lower()}"


def replace(path: Path, text: str) -> None:
    """Write a page if it has changed, so that an unchanged one is not built again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
