"""The comparison of two checkouts' numbers finds what has moved, and nothing else."""

import json

import pytest
from compare import main

HISTORY = {"force_N": [100.0, 250.0, 0.0], "iterations": [3, 4, 2], "centre_mm": ["", 1.5, ""]}
CHECK = {"quantity": "residual", "ours": 2e-12, "reference": 0.0, "kind": "absolute", "tolerance": 1e-3, "passed": True}


def write(out, history, check=CHECK):
    """One spring and one case of verification."""
    spring, case = out / "spring" / "one", out / "verify" / "two"
    for folder in (spring, case):
        folder.mkdir(parents=True)
    rows = [",".join(history), *(",".join(map(str, row)) for row in zip(*history.values(), strict=True))]
    (spring / "history.csv").write_text("\n".join(rows))
    table = {"title": "t", "columns": ["method", "s", "set, mm"], "rows": [["newton", 1.0, 3.0], ["bfgs", 2.0, None]]}
    (case / "record.json").write_text(json.dumps({"checks": [check], "tables": [table], "notes": ["a note"]}))


@pytest.fixture
def compare(tmp_path, capsys):
    """Exit code and output for another history, or another check, after."""

    def run(history, check=CHECK, options=()):
        write(tmp_path / "before", HISTORY)
        write(tmp_path / "after", history, check)
        code = main([str(tmp_path / "before"), str(tmp_path / "after"), *options])
        return code, capsys.readouterr().out

    return run


def test_equal_numbers_are_equal(compare):
    code, printed = compare(HISTORY)
    assert code == 0
    assert printed.splitlines()[-1] == "2 runs, 0 off"


@pytest.mark.parametrize(
    ("changed", "code", "words"),
    [
        ({"force_N": [100.0, 250.0, 2e-8]}, 0, "8.0e-11  history.csv force_N"),  # over the maximum force
        ({"force_N": [100.0, 250.0, 5e-8]}, 1, "beyond: history.csv force_N: 2.0e-10 at (2,), 0 → 5e-08"),
        ({"force_N": [100.0, -250.0, 0.0]}, 1, "2.0e+00 at (1,), 250 → -250"),
        ({"force_N": [100.0, "nan", 0.0]}, 1, "inf at (1,)"),
        ({"centre_mm": ["", 1.5, 1.5]}, 1, "centre_mm: inf at (2,)"),
        ({"iterations": [3, 5, 2]}, 1, "count: history.csv iterations: sum 9 → 10, first at (1,): 4 → 5"),
        ({"travel_mm": [1.0, 2.0, 0.0]}, 0, "only after: history.csv travel_mm"),
    ],
)
def test_what_has_moved_is_said(compare, changed, code, words):
    found, printed = compare(HISTORY | changed)
    assert found == code, printed
    assert words in printed


def test_another_number_of_steps_is_no_equality(compare):
    code, printed = compare({name: values[:2] for name, values in HISTORY.items()})
    assert code == 1
    assert "shape (3,) → (2,)" in printed


def test_counts_may_be_let_pass(compare):
    code, printed = compare(HISTORY | {"iterations": [3, 5, 2]}, options=["--counts-may-differ"])
    assert code == 0
    assert "sum 9 → 10" in printed


@pytest.mark.parametrize(("ours", "code"), [(2.05e-12, 0), (2e-3, 1)])
def test_a_number_that_ought_to_vanish_is_measured_by_its_tolerance(compare, ours, code):
    assert compare(HISTORY, CHECK | {"ours": ours})[0] == code
