"""CSV files as laboratories and spreadsheets write them: what is read, and what is said of the others."""

import numpy as np
import pytest

from coilset.meshes.measured.measured import read_centre_line
from coilset.meshes.sections.shapes import Curve
from coilset.model.core.base.columns import read_columns
from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.hardening_curves import read_table
from coilset.model.physics.vibration.lift import read_lift
from coilset.model.tools.identification.experiments import read_test
from coilset.model.tools.identification.relaxation_tests import read_relaxation


def test_comments_a_byte_order_mark_and_line_endings_of_spreadsheets(tmp_path):
    path = tmp_path / "test.csv"
    path.write_bytes("\ufeff# wire 7\r\n# 20 °C\r\nstrain,stress\r\n0.001,205.5\r\n0.002,411\r\n".encode())
    table = read_columns(path)
    assert table.names == ("strain", "stress")
    np.testing.assert_array_equal(table.numbers("stress"), [205.5, 411.0])


def test_comments_between_the_rows(tmp_path):
    """A pressed spring's table may say what follows; lines keep their numbers."""
    path = tmp_path / "test.csv"
    rows = 'strain,stress\n# first, as "delivered\n0.001,205.5\n\n  "# then"\n0.002,wrong\n'
    path.write_text(rows, encoding="utf-8")
    np.testing.assert_array_equal(read_columns(path).numbers("strain"), [0.001, 0.002])
    with pytest.raises(InputError, match="line 6, column stress"):
        read_columns(path).numbers("stress")


@pytest.mark.parametrize(
    ("heading", "factor"),
    [
        ("Force", 1.0),
        ("FORCE [N]", 1.0),
        ("force_kN", 1e3),
        ("force (kgf)", 9.80665),
        ("force_lbf", 0.45359237 * 9.80665),
    ],
)
def test_headings_in_capitals_and_with_units(tmp_path, heading, factor):
    path = tmp_path / "press.csv"
    path.write_text(f"{heading};remark\n2,5;first\n", encoding="utf-8")
    table = read_columns(path).named({"force": "N"})
    assert table.names == ("force", "remark")
    np.testing.assert_allclose(table.numbers("force"), [2.5 * factor], rtol=1e-12)
    path.write_text(f"{heading};force\n2,5;2,5\n", encoding="utf-8")
    with pytest.raises(InputError, match="force: is there twice; the columns are "):
        read_columns(path).named({"force": "N"})


def test_other_units_and_names_are_left(tmp_path):
    path = tmp_path / "press.csv"
    path.write_text("force [MPa],forces,travel_in,y\n1,2,x,4\n", encoding="utf-8")
    table = read_columns(path).named({"force": "N", "travel_mm": "mm"})
    assert table.names == ("force [MPa]", "forces", "travel_mm", "y")
    with pytest.raises(InputError, match="line 2, column travel_mm: 'x' is not a number"):
        table.numbers("travel_mm")


def _helix():
    turns = np.linspace(0.0, 2.0, 65)
    places = 10.0 * np.cos(2.0 * np.pi * turns), 10.0 * np.sin(2.0 * np.pi * turns), 5.0 * turns
    return "X,Y,Z\n" + "".join(f"{x:.6f},{y:.6f},{z:.6f}\n" for x, y, z in zip(*places, strict=True))


PULLED = "".join(f"{1e-4 * k:g},{206000e-4 * k:g}\n" for k in range(1, 31))
READERS = {
    "centre line": (lambda path: read_centre_line(path)[0], _helix()),
    "section": (lambda path: Curve.read(path).points, "xi,eta\n-1,-1\n1,-1\n1,1\n-1,1\n"),
    "motion": (lambda path: [read_lift(path).travel(0.5)], "Time_s,Travel_mm\n0,0\n0.5,2\n1,0\n"),
    "tensile test": (lambda path: read_test(path).strain, f"Strain,Stress\n{PULLED}"),
    "hardening": (read_table, "STRAIN,STRESS\n0,400\n0.01,500\n"),
    "relaxation": (
        lambda path: read_relaxation(path, points=True).loss,
        "Temperature,Loss,shear_stress\n373,1,700\n423,2.7,700\n423,4.5,900\n473,5.5,700\n",
    ),
}


@pytest.mark.parametrize("name", READERS)
def test_comments_and_capitals_in_every_table(tmp_path, name):
    read, text = READERS[name]
    path = tmp_path / "table.csv"
    path.write_text(text, encoding="utf-8")
    plain = np.array(read(path))
    path.write_text("# of lot 7\n" + text.replace("\n", '\n # checked, "by hand\n"# twice"\n'), encoding="utf-8")
    np.testing.assert_array_equal(read(path), plain)
    assert plain.size


def test_spaces_after_the_commas(tmp_path):
    path = tmp_path / "test.csv"
    path.write_text("strain, stress\n0.001, 205.5\n", encoding="utf-8")
    np.testing.assert_array_equal(read_columns(path).numbers("stress"), [205.5])


@pytest.mark.parametrize(
    "text",
    [
        "# wire 7\nstrain;stress\n0,001;205,5\n-0,002;4,11e2\n",
        "strain\tstress\n0.001\t205.5\n-0.002\t411\n",
        "\nstrain;stress\n\n0.001;205.5\n-,002;411\n",
    ],
)
def test_semicolons_tabs_and_decimal_commas(text, tmp_path):
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    table = read_columns(path)
    np.testing.assert_array_equal(table.numbers("strain"), [0.001, -0.002])
    np.testing.assert_array_equal(table.numbers("stress"), [205.5, 411.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("strain,stress\n0.001,205.5\n0,002,411\n", "line 3: has 3 cells, but the header names 2 columns; numbers"),
        ("strain;stress\n0,001;1.205,5\n", "line 2, column stress: '1.205,5' is not a number"),
        ("# wire 7\nstrain,stress\n0.001,\n", "line 3, column stress: '' is not a number"),
        ("strain,stress\n0.001\n", "line 2, column stress: '' is not a number"),
        (b"Dehnung,Spannung \xfcber alles\n", "it is not a text file in UTF-8"),
    ],
)
def test_other_files_are_refused(text, message, tmp_path):
    path = tmp_path / "test.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError) as error:
        read_columns(path).numbers("stress")
    assert str(error.value).startswith(f"{path}: {message}")
