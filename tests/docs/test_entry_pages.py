"""No entry of an input file lacks its row in the reference, and no row lacks what the entry means, or its unit."""

import importlib
import importlib.util
import pkgutil
import re
from dataclasses import fields
from pathlib import Path

import pytest

from coilset import meshes, model
from coilset.model.core.base.strict_entries import Strict
from coilset.model.core.case import reference
from coilset.model.core.equilibrium.settings import NewtonControl, StepControl

DOCS = Path(__file__).resolve().parents[2] / "docs"


def load(name):
    spec = importlib.util.spec_from_file_location(name, DOCS / "generators" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


pages = load("entry_pages")
MODELS = {name: model for name, (_, _, model) in pages.FILES.items()}


def by_schema(model):
    """Names of the entries of every group, by pydantic's own JSON schema: another way through the models."""
    schema = model.model_json_schema()
    found = {name: set(part["properties"]) for name, part in schema.get("$defs", {}).items() if "properties" in part}
    return found | {model.__name__: set(schema["properties"])}


def on_the_page(folder, name):
    """Names of the entries in every table of a page, by the label above it; the whole file's has none."""
    pages.write(folder)
    found, group = {}, ""
    for line in (folder / f"{name}.md").read_text(encoding="utf-8").splitlines():
        if label := re.fullmatch(rf"\({name}-(\w+)\)=", line):
            group = label[1]
        if cells := re.match(r"\| `(\w+)` \|", line):
            found.setdefault(group, set()).add(cells[1])
    return found


@pytest.mark.parametrize("name", MODELS)
def test_every_entry_has_its_row(tmp_path, name):
    wanted = {
        ("" if group == MODELS[name].__name__ else group.lower()): names
        for group, names in by_schema(MODELS[name]).items()
    }
    assert on_the_page(tmp_path, name) == wanted


def test_every_model_of_a_file_is_on_a_page():
    """A model of entries that no page reaches belongs to a file without a page; those of wires are the program's."""
    for room in (meshes, model):
        for module in pkgutil.walk_packages(room.__path__, f"{room.__name__}."):
            importlib.import_module(module.name)
    pending, known = [Strict], set()
    while pending:
        inherited = pending.pop().__subclasses__()
        pending += inherited
        known |= {kind for kind in inherited if not kind.__subclasses__()}
    known = {kind for kind in known if kind.__module__.startswith(("coilset.model", "coilset.meshes"))}  # none of tests
    inputs = {kind for kind in known if not kind.__module__.startswith("coilset.model.tools.wires")}
    shown = {group.model for root in MODELS.values() for group in reference.groups(root)}
    assert len(inputs) > 40
    assert {kind.__qualname__ for kind in inputs if not shown & {*kind.__mro__}} == set()


@pytest.mark.parametrize("name", MODELS)
def test_every_entry_has_a_meaning_and_every_real_number_a_unit(name):
    for group in reference.groups(MODELS[name]):
        place = f"{group.model.__name__} at {', '.join(group.places)}"
        assert reference.summary(group.model), place
        for row in group.rows:
            assert row.meaning, f"{place}: {row.name} needs Field(description=...)"
            for form in row.forms:
                assert form.unit or not form.is_real, f'{place}: {row.name} needs Unit("mm") or Unit("1"), or another'


def test_links_lead_to_tables(tmp_path):
    pages.write(tmp_path)
    for name in MODELS:
        text = (tmp_path / f"{name}.md").read_text(encoding="utf-8")
        targets = set(re.findall(rf"\(#({name}-\w+)\)", text))
        assert targets
        assert all(f"({target})=" in text for target in targets)


def test_a_row_lists_what_the_entry_takes():
    """Against the entries as their file declares them, one of each kind."""
    rows = {(group.model.__name__, row.name): row for group in reference.groups(MODELS["case"]) for row in group.rows}
    wire = rows["SpringSpec", "wire_diameter"]
    assert (wire.unit, wire.default, wire.range) == ("mm", "none", "0.001 to 100,000")
    radial = rows["SectionSpec", "radial"]
    assert (radial.forms[0].kind, radial.default, radial.range) == ("whole number", "`8`", "≥ 1, ≤ 64")
    coils = rows["FrictionSpec", "coils"]
    assert (coils.unit, coils.default, coils.range) == ("1", "`0`", "≥ 0, < 2")
    tilt = rows["SeatSpec", "tilt"]
    assert [form.kind for form in tilt.forms] == ["`held`, `free`", "number"]
    assert (tilt.unit, tilt.default) == ("N mm/rad", "`held`")
    assert rows["ContactSpec", "bedding"].default == "none"
    assert rows["Case", "rates_at"].default == "`[]`"
    assert rows["SeatSpec", "angle"].range == "> −60, < 60"


@pytest.mark.parametrize("control", [NewtonControl, StepControl])
def test_attributes_of_a_dataclass_are_read_off_its_docstring(control):
    meanings = reference.attributes(control)
    assert set(meanings) == {item.name for item in fields(control)}
    assert all(meanings.values())
