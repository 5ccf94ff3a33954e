"""CSV files as laboratories and spreadsheets write them: what is read, and what is said of the others."""

import numpy as np
import pytest

from coilset.model.base.columns import read_columns
from coilset.model.base.errors import InputError


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
