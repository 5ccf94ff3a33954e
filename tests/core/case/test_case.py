"""Entries of a case: what is not a number, what is misspelt, paths, earlier names, and messages in words."""

import pytest

from coilset.model.core.base.entry import LONGEST, shown
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.package import package
from coilset.model.core.case import Case, UnloadedCase, check, read_case
from coilset.model.core.case.settings import assign
from coilset.model.core.equilibrium.settings import CONSTANTS

SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
TEXT = "spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 2.5, pitch: 12.0}\nloading: [{to: block}]\n"


def raw(**entries):
    return {"spring": SPRING, "loading": [{"to": "block"}], **entries}


def test_a_run_needs_a_load_program_and_a_drawing_does_not(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(TEXT.partition("loading")[0], encoding="utf-8")
    with pytest.raises(InputError, match=r"^.*case\.yaml: loading: this entry is required; give the load program: .*$"):
        read_case(path)
    assert read_case(path, kind=UnloadedCase).loading == []
    with pytest.raises(InputError, match=r"loading: .*must have at least 1 item"):
        read_case(path, ["loading=[]"], UnloadedCase)


def problem(data):
    with pytest.raises(InputError) as caught:
        check(data)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"solver": {"tolerance": True}}, "solver.tolerance: True: must be a number"),
        ({"solver": {"tolerance": "1e-6"}}, "solver.tolerance: '1e-6': must be a number"),
        ({"temperature": True}, "temperature: True: must be a number"),
        ({"loading": [{"to": {"travel": True}}]}, "loading.0.to.travel: True"),
        ({"mesh": {"section": {"radial": True}}}, "mesh.section.radial: True: must be a whole number"),
        ({"mesh": {"section": {"radial": 2.5}}}, "mesh.section.radial: 2.5: must be a whole number"),
        ({"loading": [{"to": "block", "steps": True}]}, "loading.0.steps: True: must be a whole number"),
        ({"loading": [{"to": "block", "steps": "12"}]}, "loading.0.steps: '12': must be 'auto', or a number"),
        ({"loading": [{"to": "block", "steps": 0}]}, "loading.0.steps: 0: must be greater than 0"),
        (
            {"loading": [{"to": "blok"}]},
            "loading.0.to: 'blok': must be 'block', or a target as in {travel: 5}$",
        ),
        ({"loading": [{"to": 20}]}, "loading.0.to: 20: must be 'block', or a target as in {travel: 5}$"),
        (
            {"loading": [{"to": {"travel": "5 mm"}}]},
            "loading.0.to.travel: '5 mm': must be a number without its unit; units are N, mm, MPa and K everywhere$",
        ),
        (
            {"spring": SPRING | {"pitch": "12,5"}},
            "spring.pitch: '12,5': must be a number with a decimal point, as in 12.5$",
        ),
        ({"accuracy": "0,2"}, "accuracy: '0,2': must be a number with a decimal point, as in 0.2, or none; 0.2 % is"),
        ({"accuracy": "0,2 %"}, "accuracy: '0,2 %': must be a number with a decimal point, as in 0.2 %, or none"),
        ({"spring": SPRING | {"pitch": "12,500,1"}}, "spring.pitch: '12,500,1': must be a number$"),
        ({"temperature": "20°C"}, "temperature: '20°C': must be a number without its unit; units are N, mm, MPa and K"),
        ({"temperature": "warm"}, "temperature: 'warm': must be a number$"),
        ({"mesh": 5}, "mesh: 5: must be a group of entries, as in {name: value}, of elements_per_turn, sagitta, "),
        ({"mesh": [1]}, "mesh: [1]: must be a group of entries"),
        (
            {"contact": {"friction": 0.15}},
            "contact.friction: 0.15: must be a group of entries, as in {name: value}, of seats, coils, guides$",
        ),
        ({"material": {"wire": 1.4310}}, "material.wire: 1.431: must be a word; a number in quotation marks is one$"),
        ({"outer": {"case": "a.yaml"}}, "outer: unknown entry; a file with it is for coilset nest$"),
        ({"loading": {"to": "block"}}, "loading: {'to': 'block'}: must be a list, as in [1, 2]"),
        ({"loading": []}, "loading: []: must have at least 1 item, not 0"),
        ({"seats": {"hold": "groove", "top": {"tilt": "loose"}}}, "seats.top.tilt: 'loose': must be 'held' or 'free'"),
        ({"seats": {"hold": "groove", "top": {"tilt": [1]}}}, "seats.top.tilt: [1]: must be a number"),
        ({"solver": {"options": {"snes_max_it": [1]}}}, "solver.options.snes_max_it: must be a word, a finite number"),
        ({"solver": {"method": "magic"}}, "solver.method: 'magic': must be 'newton', "),
        ({"material": 5}, "material: 5: must be a word"),
        ({"mash": {}}, "mash: unknown entry; is mesh meant?"),
        ({"colour": "red"}, "colour: unknown entry; the entries here are spring, material, "),
    ],
)
def test_wrong_entries_are_described_in_words(entries, message):
    found = problem(raw(**entries))
    assert f"{found}$".startswith(message)
    assert "constrained" not in found
    assert "instance" not in found


def test_a_required_entry_is_described():
    words = "loading: this entry is required; give the load program: targets and waiting times, in order"
    assert problem({"spring": SPRING}) == words


def test_long_values_are_shortened():
    found = problem(raw(mesh={"section": {"rule": "x" * 100_000}}))
    assert len(found) < 200
    assert problem(raw(**{"m" * 100_000: 1})).startswith("mmmm")
    assert len(problem(raw(loading={"to": list(range(100_000))}))) < 200
    assert len(shown({"a": [["b" * 99] * 99] * 99})) <= LONGEST
    with pytest.raises(InputError) as caught:
        assign(raw(), "mesh.elements_per_turn.x" + "=" + "9" * 5000)
    assert len(str(caught.value)) < 300


def test_whole_numbers_may_come_as_floats():
    """A range of a sweep makes 4.0."""
    assert check(raw(mesh={"section": {"radial": 4.0}})).mesh.section.radial == 4
    assert check(raw(solver={"control": {"steps": {"automatic": 4.0}}})).solver.control.steps.automatic == 4


@pytest.mark.parametrize(
    ("name", "value"), [("automatic", True), ("automatic", 4.5), ("probe", True), ("probe", "0.5")]
)
def test_numbers_of_the_control_are_numbers(name, value):
    assert problem(raw(solver={"control": {"steps": {name: value}}})).startswith(f"solver.control.steps.{name}: ")


def test_what_is_a_constant_now_is_refused_with_its_place():
    """Each constant is where the message says, and has a number."""
    assert {name.partition(".")[0] for name in CONSTANTS} == {"newton", "steps"}
    for name, file in CONSTANTS.items():
        group, _, entry = name.partition(".")
        found = problem(raw(solver={"control": {group: {entry: 0.5}}}))
        assert found == (
            f"solver.control.{name}: this is no longer an entry, but the constant {entry.upper()} of model/{file}"
        )
        module = package("coilset.model." + file.removesuffix(".py").replace("/", "."), "the constant")
        assert getattr(module, entry.upper()) > 0.0
    found = problem(raw(solver={"control": {"newton": {"free_penetration": 0.1}}}))
    assert found.startswith("solver.control.newton.free_penetration: this is no longer an entry, but contact.penetrati")


def test_a_material_file_counts_from_the_folder_of_the_case(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "case.yaml").write_text(TEXT + "material: mine.yaml\n")
    monkeypatch.chdir(tmp_path)
    assert read_case("here/case.yaml").material == "here/mine.yaml"
    assert read_case("here/case.yaml", ["material=mine.yaml"]).material == str(tmp_path / "mine.yaml")
    assert read_case("here/case.yaml", ["material=ck15"]).material == "ck15"
    scan = read_case("here/case.yaml", ["spring={file: scan.csv}"]).spring
    assert scan.file == str(tmp_path / "scan.csv")
    assert Case.model_validate(raw(material="mine.yaml")).material == "mine.yaml"


def test_earlier_names_are_taken_with_a_notice():
    case = check(raw(contact={"deepest": 0.05, "penetration": 0.001}))
    assert (case.contact.penetration_limit, case.contact.augmentation_tolerance) == (0.05, 0.001)
    assert list(case.notices()) == [
        "contact.deepest: this entry is now called penetration_limit",
        "contact.penetration: this entry is now called augmentation_tolerance",
    ]
    now = check(raw(contact={"penetration_limit": 0.05, "augmentation_tolerance": 0.001}))
    assert list(now.notices()) == []
    assert now.model_dump() == case.model_dump()
    both = problem(raw(contact={"deepest": 0.05, "penetration_limit": 0.05}))
    assert both == "contact: deepest is the earlier name of penetration_limit; give one of the two"
    assert problem(raw(contact={"deepest": -1})).startswith("contact.penetration_limit: -1: must be greater than 0")


@pytest.mark.parametrize("marks", [[0.5], [0.2, 0.2, 1], [0.0, 1], [0.5, 1, 1.5], []])
def test_recorded_steps_ascend_to_the_end_of_their_phase(marks):
    assert problem(raw(loading=[{"to": "block", "steps": marks}])).startswith("loading.0.steps: ")


def test_a_list_takes_no_index_beyond_its_end():
    for part in ("7", "-1", "x", "9" * 5000, "²"):
        with pytest.raises(InputError, match="give a number from 0 to 0"):
            assign(raw(), f"loading.{part}.steps=3")


def test_letters_that_no_screen_shows_are_escaped():
    """Such as a byte order mark in the middle of a file."""
    for letter in ("\ufeff", "\x85", "\u2028"):
        with pytest.raises(InputError) as caught:
            check(raw(**{f"a{letter}b": 1}))
        assert str(caught.value).isprintable()


def test_a_name_of_a_file_gives_no_orders_to_the_screen(tmp_path):
    with pytest.raises(InputError) as caught:
        read_case(tmp_path / "red\x1b[31m\nline.yaml")
    assert str(caught.value).isprintable()
    assert "red\\x1b[31m\\nline.yaml" in str(caught.value)
