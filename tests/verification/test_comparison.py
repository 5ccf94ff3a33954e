"""Measured numbers beside those of a run: verdicts, ratios and wrong tables."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from coilset.model.core.base.errors import InputError
from coilset.verification.comparison import Compared, Comparison, compare, figure

CASE = {
    "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0},
    "ends": "clamped",
    "accuracy": "none",
    "mesh": {"elements_per_turn": 8, "section": {"radial": 4, "angular": 12}},
    "loading": [{"to": {"travel": 12.0}, "steps": 6}, {"to": {"force": 0}, "steps": 2}],
}
HEAD = "quantity;value;error;travel_mm;phase;turn\n"


def test_met_within_both_errors():
    assert Compared("set", 1.0, 0.05, 1.08, 0.04).met
    assert not Compared("set", 1.0, 0.05, 1.08, 0.02).met
    assert not Compared("set", 1.0, 0.05, 1.08, float("nan")).met


@pytest.mark.parametrize(
    ("measured", "error", "computed", "known", "shown", "ratio"),
    [
        (0.02, 0.05, -1.0658e-14, 1.4e-13, 0.0, None),
        (0.2, 0.05, -1.0658e-14, float("nan"), 0.0, None),
        (0.2, 0.05, 0.01, 0.02, 0.01, None),
        (0.01, 0.05, 0.2, 0.01, 0.2, None),
        (0.2, 0.05, 0.1, 0.02, 0.1, 2.0),
    ],
)
def test_a_number_that_is_0_has_no_ratio(measured, error, computed, known, shown, ratio):
    """An elastic spring's set is rounding; divided by it, others left the picture's axis from -6e12 to 2e12."""
    row = Compared("set_mm", measured, error, computed, known)
    assert row.shown(computed) == shown
    assert row.ratio == pytest.approx(float("nan") if ratio is None else ratio, nan_ok=True)
    drawn = figure(Comparison([row, Compared("force_max_N", 100.0, 1.0, 99.0, 0.5)], []), "spring")
    low, high = drawn.axes[0].get_xlim()
    assert -1.0 < low < high < 4.0
    assert [text.get_text() for text in drawn.axes[0].texts] == (
        [] if ratio else [f"0 within its error: no ratio, {'met' if row.met else 'not met'}"]
    )


def test_a_folder(tmp_path):
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(CASE))
    rows = "force_N;185,0;10;12;1;\nset_mm;9;0,1;;;\nstress_+45°_MPa;0;500;;;1,25\n"
    (tmp_path / "measured.csv").write_text(HEAD + rows, encoding="utf-8")
    found = compare(tmp_path, tmp_path / "results")
    force, lost, stress = found.rows
    assert force.met
    assert force.ratio == pytest.approx(1.0, abs=0.06)
    assert not lost.met
    assert lost.computed < 8.0
    assert stress.met
    assert stress.computed != 0.0
    assert (tmp_path / "results" / "summary.json").is_file()
    drawn = figure(replace(found, rows=[force, lost]), "spring")
    assert drawn.axes[0].get_title() == "spring: 1 of 2 numbers met"
    pressed, released = drawn.axes[1].lines[:2]
    assert np.interp(12.0, *pressed.get_data()) == pytest.approx(force.computed, rel=1e-9)
    assert released.get_xdata()[-1] == pressed.get_xdata()[-1] == pytest.approx(12.0)
    (dot,) = drawn.axes[1].containers
    assert dot.lines[0].get_ydata() == [185.0]
    assert len(figure(replace(found, rows=[lost]), "spring").axes) == 1
    for wrong, message in (
        (
            "initial_rate_N_per_mm;9;0,1;;;",
            r"line 2: 'initial_rate_N_per_mm' is none that a run has; is rate_N_per_mm meant\?",
        ),
        ("set_mm;9;0,1;;;\nset_mm;9;-0,1;;;", r"line 3, column error: is -0\.1; must be 0 or more"),
    ):
        (tmp_path / "measured.csv").write_text(HEAD + wrong + "\n")
        with pytest.raises(InputError, match=message):
            compare(tmp_path, tmp_path / "out", True)
    (tmp_path / "measured.csv").write_text(HEAD + "sett_mm;9;0,1;;;\n")
    with pytest.raises(InputError, match=r"line 2: 'sett_mm' is none that a run has; is set_mm meant\?"):
        compare(tmp_path, tmp_path / "results", overwrite=True)
    (tmp_path / "measured.csv").write_text("quantity,value\nset_mm,9\n")
    with pytest.raises(InputError, match="column error: is missing"):
        compare(tmp_path, tmp_path / "results", overwrite=True)


def rows_of(folder, *rows, head="quantity;value;error;travel_mm;height_mm;phase"):
    (folder / "case.yaml").write_text(yaml.safe_dump(CASE | {"material": "elastic"}))
    (folder / "measured.csv").write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return compare(folder, folder / "results", True).rows


def test_a_force_at_a_height_and_in_other_units(tmp_path):
    """A drawing and a tester state a force at a height: 25 mm are 10 mm of the 35; one kgf is 9.80665 N."""
    at_travel, at_height, kgf, inches = rows_of(
        tmp_path,
        "force_N;400;4;10;;1",
        "force_N;400;4;;25;1",
        "force_kgf;40;0,4;;25;1",
        "set_in;0,01;0,001;;;",
    )
    assert at_height.computed == pytest.approx(at_travel.computed, rel=1e-9)
    assert at_height.quantity == "force_N at a height of 25 mm, phase 1"
    assert (kgf.measured, kgf.error) == pytest.approx((40 * 9.80665, 0.4 * 9.80665))
    assert (inches.quantity, inches.measured, inches.error) == ("set_mm", pytest.approx(0.254), pytest.approx(0.0254))
    (heading,) = rows_of(tmp_path, "force_N;400;4;0,3937007874", head="Quantity;VALUE;Error;Travel [in]")
    assert heading.computed == pytest.approx(at_travel.computed, rel=1e-9)


def test_the_tester_has_an_offset_and_gives_way(tmp_path):
    """An elastic spring of some 40 N/mm: 0.1 ± 0.05 mm and 1 ± 0.5 µm/N beside 400 N are 0.5 ± 0.25 mm of travel."""
    plain, less = rows_of(tmp_path, "force_N;400;4;9,5;;1", "force_N;400;4;10;;1")
    given = "tester_offset_mm;0,1;0,05;;;", "tester_compliance_mm_per_N;0,001;0,0005;;;"
    (read,) = rows_of(tmp_path, *given, "force_N;400;4;10;;1")
    assert read.computed == pytest.approx(plain.computed, rel=1e-9)
    assert read.travel == pytest.approx(9.5)
    slope = (less.computed - plain.computed) / 0.5
    assert slope == pytest.approx(40.0, rel=0.1)
    assert read.error == pytest.approx(4.0 + 0.25 * slope, rel=0.02)
    (height,) = rows_of(tmp_path, *given, "force_N;400;4;;25;1")  # a height has its own zero
    assert height.travel == pytest.approx(9.6)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("force_N;400;4;10;25;1", r"line 2: 'force_N' needs one of travel_mm and height_mm as a number"),
        ("force_N;400;4;;;1", r"line 2: 'force_N' needs one of travel_mm and height_mm as a number"),
        ("force_kgf;400;-4;10;;1", r"line 2, column error: is -4; must be 0 or more"),
        ("force_N;400;4;;40;1", r"line 2, column height_mm: -5 mm are not reached in phase 1"),
        ("tester_offset_mm;1;0;;;\ntester_offset_mm;1;0;;;", "line 3: .tester_offset_mm. is there twice; leave one"),
        ("tester_offset;1;0;;;", r"line 2: 'tester_offset' is none that a run has; is tester_offset_mm meant\?"),
    ],
)
def test_wrong_rows_are_refused(tmp_path, row, message):
    with pytest.raises(InputError, match=message):
        rows_of(tmp_path, row)


def test_a_nest(tmp_path):
    """Forces add up; a number of one of the springs begins with its name."""
    for name, d, D, pitch in (("outer", 5.0, 40.0, 10.0), ("inner", 3.0, 24.0, 11.0)):
        spring = {"wire_diameter": d, "mean_diameter": D, "turns": 1.5, "pitch": pitch}
        mesh = {"elements_per_turn": 8, "section": {"radial": 2, "angular": 8}}
        case = {"spring": spring, "material": "elastic", "mesh": mesh, "accuracy": "none", "loading": [{"to": "block"}]}
        (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump(case))
    nest = {name: {"case": f"{name}.yaml"} for name in ("outer", "inner")}
    (tmp_path / "nest.yaml").write_text(yaml.safe_dump(nest | {"loading": [{"to": {"height": 18.0}, "steps": 2}]}))
    rows = "force_N;100;10;2;1;\nouter.force_max_N;100;10;;;\nforce_max_N;100;10;;;\n"
    (tmp_path / "measured.csv").write_text(HEAD + rows)
    found = compare(tmp_path, tmp_path / "results")
    force, outer, both = (row.computed for row in found.rows)
    assert force == pytest.approx(both, rel=1e-9)
    assert 0.3 * force < outer < 0.95 * force
    (tmp_path / "measured.csv").write_text(HEAD + "stress_along_MPa;9;0,1;;;1\n")
    with pytest.raises(InputError, match=r"line 2: 'stress_along_MPa' is none that a run has"):
        compare(tmp_path, tmp_path / "results", overwrite=True)


def test_a_force_near_a_kink_between_two_steps(tmp_path):
    """Coils close in the last step: open they have 10.4 N/mm, and the straight line to the end is within the error."""
    spring = {"wire_diameter": 3.0, "mean_diameter": 24, "turns": 5.5, "free_length": 45}
    loading = [{"to": {"height": 20}, "steps": 5}, {"to": {"force": 0}, "steps": 20}]
    coarse = {"elements_per_turn": 8, "section": {"radial": 4, "angular": 12}}
    case = {"spring": spring, "material": "elastic", "ends": "clamped", "accuracy": "5 %", "loading": loading}
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(case | {"mesh": coarse, "contact": {"bedding": 1e5}}))
    (tmp_path / "measured.csv").write_text(HEAD + "force_N;243;3;23;1;\nforce_N;420;3;23;1;\nforce_N;211;3;20;1;\n")
    near, far, before = compare(tmp_path, tmp_path / "results").rows
    assert near.computed == pytest.approx(242.0, rel=0.02)
    assert near.computed_error > 10.0
    assert near.met
    assert not far.met
    assert before.computed == pytest.approx(211.0, rel=0.02)
    assert before.computed_error < 5.0
