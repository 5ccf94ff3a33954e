"""The data sheet as a document: numbers and words in every format, and a drawing that opens again."""

import csv
import io
import json
import re
from itertools import pairwise

import numpy as np
import pytest

from coilset.meshes.drawings.silhouette import silhouette
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.tools.document.content import document
from coilset.model.tools.document.output import WRITERS
from coilset.model.tools.document.words import Words
from coilset.model.tools.sheet import from_results
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.scripts.main import app

SPRING = {"wire_diameter": 4.0, "mean_diameter": 32.0, "turns": 7.5, "free_length": 65.0, "hand": "left"}
CASE = {
    "spring": SPRING | {"end_coils": "closed and ground"},
    "material": {"wire": "EN 10270-1 DH"},
    "loading": [{"to": {"height": 40.0}}, {"to": {"force": 0.0}}],
    "working": {"lengths": [55.0, 42.0]},
    "limits": {"force_at_42": [300.0, 350.0]},
    "sheet": {"customer": "Söhne & <Co>", "order": 4711, "part": "V-12"},
}


def run_of(folder):
    """A results folder of a spring that was preset by 2 mm."""
    states = [
        {"length_wanted": length, "reason": "", "force_N": force, "shear_surface_MPa": 2.0 * force, "safety": 1.5}
        for length, force in ((55.0, 110.0), (42.0, 290.0))
    ]
    summary = {"free_length_before_mm": 65.0, "free_length_after_mm": 63.0, "set_mm": 2.0, "material": "wire"}
    lives = {"10": 1.7e6, "50": 3.5e6, "90": 1.2e10}
    fatigue = {"criterion": "Haigh", "safety": 0.9, "lives": lives}
    summary |= {"working": states, "force_at_42_N": 290.0, "fatigue": [fatigue]}
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "history.csv").write_text("seat_height_mm,force_N\n50,210\n40,330\n50,180\n63,0\n")
    return from_results.read(folder)


def made(language="en", run=None):
    case = check(CASE)
    spring = case.spring.build()
    name = "out" if run else ""
    return document(case, spring, case_sheet(case, spring, run), [], name, ["a remark"], Words(language))


def test_the_table_has_the_formulas_and_the_run_with_their_words(tmp_path):
    """R = G d⁴/(8 D³ n) with G 81,500 of EN 10270-1: 14.47 N/mm."""
    text = WRITERS[".csv"](made("de", run_of(tmp_path))).decode("utf-8-sig")
    rows = {row[1]: row[2:] for row in csv.reader(io.StringIO(text), delimiter=";")}
    assert rows["Kunde"][0] == "Söhne & <Co>"
    assert rows["Auftrag"][0] == "4711"
    assert float(rows["Federrate R"][0].replace(",", ".")) == pytest.approx(81500 * 4**4 / (8 * 32**3 * 5.5), rel=1e-3)
    assert rows["Kraft bei 55 mm"] == ["144,7", "110", "N"]
    assert rows["Kraft bei 42 mm"] == ["300 … 350", "290", "N ✗"]  # its limits come last
    assert rows["Windungsrichtung"][0] == "links"
    assert rows["Lastspiele, die 10, 50, 90 % nicht erreichen"][1] == "1,7e6; 3,5e6; 1,2e10"
    assert rows["Druckfeder"][0].startswith("Ergebnisse des Laufs out")
    before = WRITERS[".csv"](made()).decode("utf-8-sig")
    assert "Calculated by the formulas of EN 13906-1, EN 15800, before a run" in before
    assert "force at 55 mm,144.7,,N" in before


def test_every_label_has_a_german_word(tmp_path):
    english, german = made("en", run_of(tmp_path)), made("de", run_of(tmp_path))
    same = {"Draht"}
    for (title, lines), (titel, zeilen) in zip(english.tables, german.tables, strict=True):
        assert title != titel
        for line, zeile in zip(lines, zeilen, strict=True):
            assert line.label != zeile.label or line.label in same, line.label
    for one, other in zip(english.panels, german.panels, strict=True):
        assert one.title != other.title or "Goodman" in one.title
        names = [[trace.get("name") for trace in panel.traces] for panel in (one, other)]
        assert all(a != b or a is None for a, b in zip(*names, strict=True)), names


def test_an_extension_spring_is_drawn_with_the_forces_of_its_table():
    """At the body's drawing, in the diagram and in the table: hooks give way from the first pull on, coils from F0."""
    case = read_case(EXAMPLES / "springs" / "extension.yaml")
    sheet = case_sheet(case, case.spring.build(), None)
    found = document(case, case.spring.build(), sheet, [], "", (), Words("en"))
    ((_, lines),) = [table for table in found.tables if "EN 13906-2" in table[0]]
    (stated,) = [float(line.value.replace(",", "")) for line in lines if line.label.startswith("force at")]
    exact = sheet.pull_rate * (sheet.lengths[0] - sheet.spring.length + sheet.tension / sheet.rate)
    assert stated == pytest.approx(exact, rel=1e-3)
    formula, points = found.panels[0].traces
    assert formula["y"][[0, -1]] == pytest.approx([0.0, exact])
    assert points["y"] == pytest.approx([exact])
    levels = [text.text for text in found.drawing.texts]
    assert {"L0 = 95.48", "LK = 33", "L1 = 195.5   F1 = 311.4 N"} <= set(levels)
    assert WRITERS[".html"](found).decode().count("<svg") == 1  # the diagram is beside the table
    outline = np.concatenate([line for line, layer in found.drawing.lines if layer == "OUTLINE"])
    assert np.ptp(outline[:, 1]) == pytest.approx(95.48 + 2 * 3.0, abs=0.02)  # L0 is between the insides of the hooks
    assert ("top hook", "german") in [(line.label, line.value) for line in found.tables[0][1]]


def test_a_torsion_spring_has_its_arms_on_one_page():
    case = read_case(EXAMPLES / "springs" / "torsion.yaml")
    sheet = case_sheet(case, case.spring.build(), None)
    found = document(case, case.spring.build(), sheet, [], "", (), Words("de"))
    rows = [(line.label.strip(), line.value) for _, lines in found.tables for line in lines]
    assert rows.count(("gerade Länge", "25")) == 2
    assert {"Schenkel oben", "mit eingespannten Schenkeln"} <= dict(rows).keys()
    lengths = [text for text in found.drawing.texts if text.text == "25"]
    assert len(lengths) == 2  # beside the arms, which are seen from above
    outline = np.concatenate([line for line, layer in found.drawing.lines if layer == "OUTLINE"])
    assert max(outline[:, 0]) - min(text.x for text in lengths) > 30.0
    assert WRITERS[".html"](found).decode().count("<svg") == 1


def test_wound_coils_of_a_run_open_at_what_remains_of_their_initial_tension(tmp_path):
    """Steps at 100 and 40 N on F0' + R s with F0' = 10 N, R = 3 N/mm: the curve has F0' where the line ends."""
    case = read_case(EXAMPLES / "springs" / "extension.yaml", ["working={lengths: [120]}"])
    spring = case.spring.build()
    summary = {"free_length_before_mm": 95.5, "free_length_after_mm": 96.0, "set_mm": -0.5}
    summary |= {"initial_tension_N": 25.0, "initial_tension_after_N": 10.0}
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    (tmp_path / "history.csv").write_text("seat_height_mm,force_N,contacts\n127,-100,0\n107,-40,0\n96,0,9\n")
    found = document(case, spring, case_sheet(case, spring, from_results.read(tmp_path)), [], "", (), Words("en"))
    _, run, points = found.panels[0].traces
    assert run["y"][:2] == pytest.approx([0.0, 10.0])
    assert run["x"][1] == pytest.approx(11.0 - 30.0 / 3.0)
    assert points["y"] == pytest.approx([40.0 + 13.0 * 3.0])


def test_torque_over_rotation_has_the_run_and_its_limits(tmp_path):
    """Of a left-handed spring that sets by 10° on its way to 200°; it last passes 100° on the way back."""
    settings = ["spring.hand=left", "limits={torque_max: [-4900, -4700]}"]
    settings += ["loading=[{to: {top: {turn: -200}}}, {to: {top: {torque: 0}}}, {to: {top: {turn: -100}}}]"]
    case = read_case(EXAMPLES / "springs" / "torsion.yaml", settings)
    spring = case.spring.build()
    summary = {"free_length_before_mm": 25.0, "turn_max_deg": -200.0, "torque_max_Nmm": -4800.0, "turn_set_deg": -10.0}
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    rows = ["25,0,-200,-4800", "25,0,-10,0", "25,0,-100,-2250"]
    (tmp_path / "history.csv").write_text("\n".join(["seat_height_mm,force_N,turn_deg,torque_Nmm", *rows]))
    sheet = case_sheet(case, spring, from_results.read(tmp_path))
    found = document(case, spring, sheet, [], "", (), Words("de"))
    (panel,) = found.panels
    assert (panel.title, panel.layout["yaxis"]["title"]["text"]) == ("Moment über Drehwinkel", "Moment, N mm")
    formula, run, limits, points = panel.traces
    assert formula["y"][-1] == pytest.approx(200.0 * sheet.turn_rate)
    assert (run["x"][-1], run["y"][-1]) == pytest.approx((100.0, 2250.0))
    assert (limits["x"], limits["y"]) == ([200.0, 200.0], [4700.0, 4900.0])
    assert points["y"] == pytest.approx([4800.0, 2250.0])
    values = {line.label.strip(): line.found for _, lines in found.tables for line in lines}
    finished = {line.label: line.found for line in dict(found.tables)["Fertige Feder"]}
    assert (values["Moment bei 100°"], finished["größtes Moment des Laufs"]) == ("2250", "4800")
    assert finished["Setzbetrag"] == "10"


def test_a_page_is_self_contained_and_escaped():
    text = WRITERS[".html"](made()).decode()
    assert text.count("<svg") == 2
    assert "<Co>" not in text
    assert "Söhne &amp; &lt;Co&gt;" in text
    assert not re.findall(r'(?:src|href)="(?!#)', text)
    assert "@import" not in text
    assert "L2 = 42   F2 = 332.8 (300 … 350) N" in text  # what is drawn is text


def test_a_pdf_has_two_pages_of_a4():
    text = WRITERS[".pdf"](made())
    assert text.startswith(b"%PDF")
    assert text.rstrip().endswith(b"%%EOF")
    boxes = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", text)
    assert len(boxes) == 2
    assert np.allclose(np.array(boxes, float), [595.28, 841.89], atol=0.01)


def test_a_dxf_file_opens_again_with_the_dimensions_of_the_spring(tmp_path):
    lines = WRITERS[".dxf"](made(run=run_of(tmp_path))).decode("cp1252").split("\r\n")[:-1]
    pairs = [(int(code), value) for code, value in zip(lines[::2], lines[1::2], strict=True)]
    assert pairs[0] == (0, "SECTION")
    assert pairs[-1] == (0, "EOF")
    assert [v for c, v in pairs if (c, v) in ((0, "SECTION"), (0, "ENDSEC"))] == ["SECTION", "ENDSEC"] * 3
    assert sum(p == (0, "POLYLINE") for p in pairs) == sum(p == (0, "SEQEND") for p in pairs)
    corners = [
        (float(x[1]), float(y[1]))
        for (kind, layer, x), y in zip(zip(pairs, pairs[1:], pairs[2:], strict=False), pairs[3:], strict=False)
        if kind == (0, "VERTEX") and layer == (8, "OUTLINE")
    ]
    width, height = np.ptp(np.array(corners), axis=0)
    assert width == pytest.approx(36.0, abs=0.05)  # De
    assert height == pytest.approx(63.0, abs=0.05)  # L0 of the finished spring, not of the wound one
    assert any(text == (1, "D = 32 %%p 0.5") for text in pairs)


def test_a_point_of_an_outline_is_hidden_by_what_is_before_it():
    """A ring of one turn seen from its side: the far half shows beside the near one only by its rise."""
    spring = SpringSpec(wire_diameter=2.0, mean_diameter=40.0, turns=2.0, pitch=20.0).build()
    t = np.linspace(0.0, 2.0, 4001)
    centre = spring.centre_line(t)
    for line in silhouette(spring):
        for x, z in line[:: max(len(line) // 20, 1)]:
            near = np.hypot(centre[:, 0] - x, centre[:, 2] - z)
            assert near.min() == pytest.approx(1.0, abs=0.08) or near.min() < 1.0  # on an outline or before a coil
    drawn = sum(np.linalg.norm(b - a) for line in silhouette(spring) for a, b in pairwise(line))
    whole = 2.0 * np.linalg.norm(np.diff(centre[:, [0, 2]], axis=0), axis=1).sum()
    assert 0.85 * whole < drawn < whole + 4 * np.pi  # crossings are hidden, with both faces of the wire's ends


def test_lengths_between_block_and_free_are_those_of_the_spring():
    spring = check(CASE).spring.build()
    for height in (60.0, 40.0, 30.5):
        pressed = spring.at_height(height)
        assert pressed.free_length == pytest.approx(height, rel=1e-12)
        assert pressed.wire_diameter(3.0) == 4.0
        assert pressed.block_height == pytest.approx(spring.block_height)
        assert np.all(pressed.pitch(pressed.breaks) >= 4.0 - 1e-9)
    with pytest.raises(InputError, match="must be between the block height"):
        spring.at_height(20.0)


def test_the_command_writes_what_the_names_say(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.yaml").write_text(json.dumps(CASE))
    words = ["sheet", "case.yaml", "--out", "a/s.csv", "--out", "a/s.dxf", "--language", "de"]
    app(words, standalone_mode=False)
    assert sorted(path.name for path in tmp_path.rglob("*.*")) == ["case.yaml", "s.csv", "s.dxf"]
    with pytest.raises(InputError, match="already exists"):
        app(words, standalone_mode=False)
