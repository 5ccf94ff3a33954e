"""A drawing as a DXF file, ASCII of release 12: lines and texts on layers, which every CAD program reads."""

from collections.abc import Iterator
from typing import Any

from coilset.model.tools.document.view import LETTERS, Drawing

COLOURS = {"OUTLINE": 7, "AXIS": 1, "DIMENSION": 5}  # of AutoCAD's index
ENCODING = "cp1252"  # of DWGCODEPAGE
SIGNS = {"±": "%%p", "°": "%%d", "Ø": "%%c", "−": "-", "…": "...", "≤": "<="}


def dxf(drawing: Drawing) -> bytes:
    """The file's content; 1 unit is 1 mm of the spring."""
    pairs = _pairs(drawing)
    return "".join(f"{code}\r\n{value}\r\n" for code, value in pairs).encode(ENCODING, errors="replace")


def _pairs(drawing: Drawing) -> Iterator[tuple[int, Any]]:
    yield from ((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"), (9, "$DWGCODEPAGE"), (3, "ANSI_1252"))
    yield from ((0, "ENDSEC"), (0, "SECTION"), (2, "TABLES"))
    yield from ((0, "TABLE"), (2, "LTYPE"), (70, 2))
    yield from ((0, "LTYPE"), (2, "CONTINUOUS"), (70, 0), (3, ""), (72, 65), (73, 0), (40, 0.0))
    dashes = [unit * drawing.unit for unit in (6.0, -1.0, 1.0, -1.0)]
    yield from ((0, "LTYPE"), (2, "CENTER"), (70, 0), (3, ""), (72, 65), (73, 4), (40, 9.0 * drawing.unit))
    yield from ((49, dash) for dash in dashes)
    yield from ((0, "ENDTAB"), (0, "TABLE"), (2, "LAYER"), (70, len(COLOURS)))
    for layer, colour in COLOURS.items():
        kind = "CENTER" if layer == "AXIS" else "CONTINUOUS"
        yield from ((0, "LAYER"), (2, layer), (70, 0), (62, colour), (6, kind))
    yield from ((0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES"))
    for points, layer in drawing.lines:
        yield from ((0, "POLYLINE"), (8, layer), (66, 1), (10, 0.0), (20, 0.0), (30, 0.0), (70, 0))
        for x, y in points.tolist():
            yield from ((0, "VERTEX"), (8, layer), (10, f"{x:.6f}"), (20, f"{y:.6f}"), (30, 0.0))
        yield from ((0, "SEQEND"), (8, layer))
    for text in drawing.texts:
        words = "".join(SIGNS.get(letter, letter) for letter in text.text)
        place = ((10, f"{text.x:.6f}"), (20, f"{text.y:.6f}"), (30, 0.0))
        yield from ((0, "TEXT"), (8, "DIMENSION"), *place, (40, LETTERS * drawing.unit), (1, words))
        if text.middle:  # 72: centred about the second point
            yield from ((72, 1), (11, f"{text.x:.6f}"), (21, f"{text.y:.6f}"), (31, 0.0))
    yield from ((0, "ENDSEC"), (0, "EOF"))
