"""The stable interface: every example of its docstrings, and what it refuses."""

import doctest
import pickle
from contextlib import closing

import pytest

import coilset.api
from coilset.api import Case, InputError, Result, SolveError, material, solve
from coilset.model.core.results.files.labelled import labelled


def once(function):
    """The function, called for the first of equal arguments only: many examples begin with the same spring."""
    found = {}

    def call(*given, **named):
        key = repr(([getattr(one, "entries", one) for one in given], named))
        if key not in found:
            found[key] = function(*given, **named)
        return found[key]

    return call


def test_every_example_runs(monkeypatch, example):
    monkeypatch.chdir(example.parent.parent)
    names = vars(coilset.api) | {"solve": once(coilset.api.solve), "design": once(coilset.api.design)}
    found = doctest.testmod(coilset.api, globs=names, optionflags=doctest.ELLIPSIS)
    assert found.attempted > 25
    assert found.failed == 0


PRESSED = Case(
    {
        "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0},
        "material": "ck15",
        "accuracy": "none",
        "mesh": {"elements_per_turn": 8, "section": {"radial": 2, "angular": 6}},
        "loading": [{"to": {"travel": 5}, "steps": 2}],
    }
)


def test_every_public_name_has_an_example():
    finder = doctest.DocTestFinder(exclude_empty=False)
    examples = {test.name.removeprefix("coilset.api."): test.examples for test in finder.find(coilset.api)}
    own = [name for name in coilset.api.__all__ if getattr(coilset.api, name).__module__ == "coilset.api"]
    assert len(own) > 5
    assert [name for name in own if not examples[name]] == []


def test_a_wrong_entry_is_one_line():
    with pytest.raises(InputError, match=r"case: spring\.wire_diametre: .*wire_diameter") as problem:
        Case({"spring": {"wire_diametre": 5.0}, "material": "ck15", "loading": [{"to": "block"}]})
    assert "\n" not in str(problem.value)


def test_what_is_no_case_and_no_law_is_refused():
    case = Case.read("examples/ck15_presetting.yaml")
    with pytest.raises(InputError, match=r"^case: must be a Case, as Case\.read\('case\.yaml'\) gives one, not str$"):
        coilset.api.solve("examples/ck15_presetting.yaml")
    with pytest.raises(InputError, match=r"^case: must be a Case"):
        coilset.api.slice_({})
    with pytest.raises(InputError, match=r"^law: must be a Law, as Law\(update\) makes one of a function, not type$"):
        coilset.api.solve(case, law=dict)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"contacts": [1]}, "contacts: must be a function of the wire's points .*, not list"),
        ({"contacts": lambda points, stations: None}, "contacts: gives a NoneType; it must give a list"),
        ({"contacts": lambda points, stations: [1]}, "contacts: gives a list with 1, which is no kind of Contact"),
        ({"steps": 3}, "steps: must be a class made from StepSizes, not 3"),
        ({"steps": dict}, "steps: must be a class made from StepSizes"),
    ],
)
def test_what_is_no_contact_and_no_class_of_steps_is_refused(given, said):
    case = Case.read("examples/ck15_presetting.yaml", ["mesh.elements_per_turn=8"])
    with pytest.raises(InputError, match=f"^{said}"):
        coilset.api.solve(case, **given)


def test_a_sweep_is_given_by_its_entries(tmp_path):
    """Paths in them count from the working directory, as those of a Case."""
    plan = {"case": "examples/ck15_presetting.yaml", "vary": {"spring.wire_diameter": [4.9, 5.1]}}
    with closing(coilset.api.Study(plan, tmp_path)) as study:
        assert [trial.inputs["spring.wire_diameter"] for trial in study.ask(2)] == [4.9, 5.1]
    with pytest.raises(InputError, match=r"^sweep: spring\.wire_diametre: unknown entry"):
        coilset.api.sweep(plan | {"vary": {"spring.wire_diametre": [1.0]}}, tmp_path / "other")


def test_a_run_without_an_equilibrium_has_its_results_up_to_there():
    case = Case.read("examples/ck15_presetting.yaml").change(
        {
            "ends": "clamped",
            "loading": [{"to": {"travel": 3}, "steps": 2}, {"to": {"force": 1e3}, "steps": 1}],
            "contact.penetration_limit": 1e-4,
            "accuracy": "none",
            "mesh": {"elements_per_turn": 8, "section": {"rule": "abramowitz9"}},
            "solver": {"control": {"steps": {"smallest": 0.05}}},
        }
    )
    with pytest.raises(SolveError, match="no equilibrium") as found:
        coilset.api.solve(case)
    result = found.value.result
    assert not result.summary["complete"]
    assert result.travel[:2] == pytest.approx([1.5, 3.0])


def test_arrays_are_read_when_they_are_used(monkeypatch):
    """They are most of what a long wire's results take; a copy in another process has them although no file is left."""
    read = []
    monkeypatch.setattr(coilset.api, "labelled", lambda folder: read.append(folder) or labelled(folder))
    result = solve(PRESSED)
    assert result.set is None
    assert read == []
    copied = pickle.loads(pickle.dumps(result))
    folder = result.folder
    del result
    assert not folder.exists()
    assert copied.travel[-1] == pytest.approx(5.0)
    assert read == [folder]


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(InputError, match="holds no results"):
        Result.open(tmp_path)


def test_an_unknown_material_is_refused():
    with pytest.raises(InputError, match="neither a material of the library"):
        material("unobtainium")
