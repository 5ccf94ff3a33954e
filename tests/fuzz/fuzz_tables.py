"""Tables that are nearly right: shipped CSV files with a cell, a row, a column, a unit or a piece of text spoilt."""

import csv
import io

from fuzz_files import EXAMPLES, FACTORS, shipped, spoilt_text
from hypothesis import strategies as st

RELAXATION = "hours,temperature,loss,shear_stress\n" + "".join(
    f"{hours},{temperature},{loss * hours**0.2:.3f},{stress}\n"
    for temperature, loss in ((353.15, 0.4), (393.15, 1.1))
    for stress in (600, 800)
    for hours in (1, 10, 48, 100)
)
MOTION = "time_s,travel_mm\n" + "".join(f"{0.001 * k},{9 * (0.05 * k) ** 2 * (3 - 0.1 * k)}\n" for k in range(21))
JOURNAL = "".join(
    f'{{"key": "{k:032x}", "status": "done", "values": {{"spring.pitch": {11 + k}}}, "set_mm": {k}}}\n'
    for k in range(5)
)
TABLES = {  # texts of files of a kind
    "measured": [EXAMPLES / "springs" / "measured.csv"],
    "test": sorted((EXAMPLES / "material" / "fit").glob("*.csv")),
    "press": sorted((EXAMPLES / "material" / "springs").glob("*.csv")),
    "compare": sorted((EXAMPLES / "compare").glob("*/measured.csv")),
    "relaxation": [RELAXATION],
    "motion": [MOTION],
    "journal": [JOURNAL],
}
CELLS = ["", " ", "nan", "inf", "-inf", "1e400", "1e-320", "1e308", "-1", "0", "1,5", "1.5.5", "=1+1", "@SUM(1)", "x"]
CELLS += ["12 345,6", "1_0", "0x1F", "\u0661", "1e5", "#", "'1", "9" * 400, "\0", "\u2028", "true", "None"]
NAMES = ["", "x", "force", "Force", "stress [MPa]", "strain", "height", "free_length", "travel", "wire_diameter"]
CHANGES = ["cell", "cell", "near", "unit", "drop row", "double row", "swap rows", "drop column", "double column"]
CHANGES += ["name", "backwards", "few"]


@st.composite
def spoilt_cells(draw, text):
    """A table with one to three changes, written with any of the separators that are read."""
    comments = [line for line in text.splitlines() if line.startswith("#")]
    separator = ";" if ";" in text else ","
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    rows = [list(row) for row in csv.reader(lines, delimiter=separator)]
    for _change in range(draw(st.integers(1, 3))):
        if len(rows) < 3 or not rows[0]:
            break
        row, column = draw(st.integers(1, len(rows) - 1)), draw(st.integers(0, len(rows[0]) - 1))
        change = draw(st.sampled_from(CHANGES))
        if change == "cell":
            rows[row][column : column + 1] = [draw(st.sampled_from(CELLS))]
        elif change in ("near", "unit"):
            factor = draw(st.sampled_from(FACTORS))
            for one in rows[1:] if change == "unit" else [rows[row]]:
                one[column : column + 1] = [scaled(cell, factor) for cell in one[column : column + 1]]
        elif change == "drop row":
            del rows[row]
        elif change == "double row":
            rows.insert(row, list(rows[row]))
        elif change == "swap rows":
            other = draw(st.integers(1, len(rows) - 1))
            rows[row], rows[other] = rows[other], rows[row]
        elif change == "drop column":
            rows = [one[:column] + one[column + 1 :] for one in rows]
        elif change == "double column":
            rows = [one[: column + 1] + one[column:] for one in rows]
        elif change == "name":
            rows[0][column] = draw(st.sampled_from(NAMES))
        elif change == "backwards":
            rows[1:] = rows[:0:-1]
        else:
            del rows[draw(st.integers(2, 8)) :]
    file = io.StringIO()
    csv.writer(file, delimiter=draw(st.sampled_from([separator, separator, ",", ";", "\t"]))).writerows(rows)
    return "\n".join([*comments, file.getvalue()])


def scaled(cell, factor):
    """A number in a cell, with a decimal comma or point, times a factor; another cell as it is."""
    try:
        return repr(float(cell.replace(",", ".")) * factor)
    except ValueError:
        return cell


def table_texts(kind):
    """Nearly right tables of a kind, as bytes."""
    text = st.sampled_from(TABLES[kind]).map(lambda file: file if isinstance(file, str) else shipped(file))
    cells = text.flatmap(spoilt_cells)
    encodings = st.sampled_from(["utf-8"] * 8 + ["utf-8-sig", "latin-1", "utf-16"])
    return st.tuples(st.one_of(cells, cells, text.flatmap(spoilt_text)), encodings).map(
        lambda pair: pair[0].encode(pair[1], "replace")
    )
