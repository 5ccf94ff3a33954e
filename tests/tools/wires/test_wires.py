"""Wires by name against printed tables, and what a user can get wrong."""

import re
from itertools import pairwise

import pytest

from coilset.model.core.base.errors import InputError
from coilset.model.core.base.yaml import read_data
from coilset.model.tools.standards import goodman
from coilset.model.tools.wires import library, names, wire
from coilset.model.tools.wires.library import FOLDER
from coilset.model.tools.wires.wire_file import WireFile, with_common

# Least strengths of EN 10270-1, N/mm², some rows of the tables of springcalc 0.1.24, which are rounded to 10
TABLES = {
    "SL": {
        1.0: 1720,
        1.25: 1660,
        1.6: 1590,
        2.1: 1510,
        2.8: 1420,
        3.4: 1370,
        4.5: 1290,
        6.0: 1210,
        8.0: 1120,
        10.0: 1060,
    },
    "SM": {
        0.3: 2370,
        0.4: 2270,
        0.6: 2140,
        1.0: 1980,
        1.6: 1830,
        2.5: 1690,
        4.0: 1530,
        6.3: 1390,
        10.0: 1240,
        20.0: 1020,
    },
    "DM": {
        0.34: 2330,
        0.5: 2200,
        0.75: 2070,
        1.2: 1920,
        1.9: 1770,
        3.0: 1630,
        5.0: 1460,
        8.0: 1310,
        13.0: 1160,
        17.0: 1070,
    },
    "SH": {
        0.3: 2660,
        0.4: 2560,
        0.6: 2410,
        1.0: 2230,
        1.6: 2060,
        2.5: 1900,
        4.0: 1740,
        6.3: 1570,
        10.0: 1410,
        20.0: 1160,
    },
    "DH": {
        0.1: 2800,
        0.2: 2800,
        0.25: 2720,
        0.28: 2680,
        0.5: 2480,
        1.2: 2170,
        3.0: 1840,
        5.0: 1660,
        9.0: 1450,
        16.0: 1240,
    },
}


@pytest.mark.parametrize("grade", TABLES)
def test_patented_wire_is_the_table_within_its_rounding(grade):
    found = wire(f"EN 10270-1 {grade}")
    for diameter, strength in TABLES[grade].items():
        assert found.strength(diameter) == pytest.approx(strength, abs=5)


def test_other_printed_values():
    assert wire("EN 10270-1 DM").strength(5.0) == pytest.approx(1460, abs=5)  # HeliSpring, spring S.198
    assert wire("EN 10270-3 1.4310 HS").strength(1.6) == pytest.approx(1910, abs=5)  # HeliSpring, spring S.202
    # Metalle Schmidt, least strengths at 0.5 mm
    for grade, strength in {"FDC": 1900, "FDSiCr": 2100, "FDSiCrV": 2280, "TDSiCr": 2080, "VDSiCrV": 2230}.items():
        assert wire(f"EN 10270-2 {grade}").strength(0.5) == strength
    # Cecchi, EN 10270-3, 1.4310: 0.4 < d ≤ 0.5 and 4.25 < d ≤ 5.0
    stainless = wire("EN 10270-3 1.4310")
    assert [stainless.strength(d) for d in (0.4, 0.41, 0.5, 4.25, 4.3, 5.0)] == [2100, 2050, 2050, 1500, 1450, 1450]


# Shigley's A and m of Rm = A/d^m, the range of diameters, and how far the files' tables may be from it (their remarks)
SHIGLEY = {
    "A228": (2211, 0.145, (0.1016, 6.35), (0.93, 0.995)),
    "A227": (1783, 0.190, (0.7, 12.7), (0.97, 1.015)),
    "A231": (2005, 0.168, (0.8, 11.1), (0.96, 1.01)),
    "A313 302": (1867, 0.146, (0.3, 2.03), (0.97, 1.03)),
}


@pytest.mark.parametrize("grade", SHIGLEY)
def test_tables_of_astm_lie_near_the_handbook(grade):
    A, m, (low, high), (least, greatest) = SHIGLEY[grade]
    for i in range(11):
        diameter = low * (high / low) ** (i / 10)
        assert least < wire(f"ASTM {grade}").strength(diameter) / (A / diameter**m) < greatest


def test_strength_falls_with_the_diameter_and_moduli_are_those_of_steel():
    for name in names():
        found = wire(name)
        for low, high in found.ranges:
            values = [found.strength(low * (high / low) ** (i / 50)) for i in range(51)]
            assert all(b <= a + 1e-9 for a, b in pairwise(values)), name
            assert 800 < values[-1] <= values[0] < 3200
        elastic = found.elastic(found.ranges[0][0])
        assert 65e3 < elastic.shear_modulus < 85e3
        assert 0.2 < elastic.young_modulus / (2 * elastic.shear_modulus) - 1 < 0.4
        assert 7.8e-6 < elastic.density < 8.01e-6


def bare_numbers(data, path=""):
    """Places of the numbers of a file that no source and certainty stand beside."""
    if isinstance(data, dict) and {"sources", "sure"} <= set(data):
        return []
    if isinstance(data, (dict, list)):
        parts = data.items() if isinstance(data, dict) else enumerate(data)
        return [found for name, part in parts for found in bare_numbers(part, f"{path}.{name}")]
    return [path] if isinstance(data, (int, float)) and not isinstance(data, bool) else []


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.yaml")), ids=lambda path: path.stem)
def test_no_number_stands_alone_and_estimates_say_how_they_were_made(path):
    raw = with_common(read_data(path, ""))
    assert bare_numbers(raw) == []
    assert bare_numbers({"wires": [{"density": {"value": 1.0, "sure": "one source"}}]}) == [".wires.0.density.value"]
    for entry in WireFile.model_validate(raw).wires:
        for name, number in entry.sourced():
            assert number.remark or number.sure != "estimate", f"{entry.grade}, {name}"
        # no standard states them, so they are estimates of every wire
        assert {entry.elastic_limit.sure, entry.proof_stress.sure} == {"estimate"}


def test_each_number_has_its_certainty():
    for name in names():
        found = wire(name)
        for _, entry in found.entry.sourced():
            assert found.citation(entry).startswith(entry.sure)
    assert wire("EN 10270-2 TDC").entry.strength.sure == "one source"


def test_name_is_found_however_it_is_spaced():
    assert wire("en10270-1  sh") is not None
    assert wire("en10270-1  sh").name == "EN 10270-1 SH"


WRONG = [
    (lambda: wire("EN 10270-1 SX"), "material.wire: 'EN 10270-1 SX' is not a known wire; is EN 10270-1 "),
    (lambda: wire("1.4310"), "material.wire: '1.4310' is not a known wire; is EN 10270-3 1.4310 meant?"),
    (lambda: wire("sh"), "material.wire: 'sh' is not a known wire; is EN 10270-1 SH meant?"),
    (lambda: wire(""), "material.wire: '' is not a known wire; `coilset sheet --wires` lists them"),
    (lambda: wire("copper"), "material.wire: 'copper' is not a known wire; `coilset sheet --wires` lists them"),
    (
        lambda: wire("EN 10270-1 SL").strength(0.5),
        "material.wire: the strength of 'EN 10270-1 SL' is unknown at 0.5 mm; it is given for 1 to 10 mm",
    ),
    (
        lambda: wire("EN 10270-3 1.4401").strength(1.2),
        "material.wire: the strength of 'EN 10270-3 1.4401' is unknown at 1.2 mm; "
        "it is given for 0.05 to 1 and 1.5 to 6 mm",
    ),
]


@pytest.mark.parametrize(("ask", "message"), WRONG)
def test_wrong_wires_have_one_line(ask, message):
    with pytest.raises(InputError) as error:
        ask()
    assert str(error.value).startswith(message)


@pytest.mark.parametrize(
    ("inches", "of_A228", "of_A227"), [(0.032, 82700, 80700), (0.063, 81700, 80000), (0.125, 81000, 79300)]
)
def test_moduli_of_wires_of_the_tables_sizes(inches, of_A228, of_A227):
    """Shigley's table 10-5 has ranges in inches that end with a size of wire."""
    for name, wanted in (("ASTM A228", of_A228), ("ASTM A227", of_A227)):
        assert wire(name).elastic(round(25.4 * inches, 4)).shear_modulus == wanted
        assert wire(name).elastic(25.4 * (inches + 0.001)).shear_modulus < wanted


NUMBER = {"value": 1.0, "sources": ["a"], "sure": "one source"}


def own_file(**other):
    """A file of one wire, with other numbers than those of steel."""
    values = {"young_modulus": 206000.0, "shear_modulus": 79500.0, "density": 7.85e-6, "elastic_limit": 0.8}
    values |= {"proof_stress": 0.9, "block_stress": 0.5}
    common = {name: NUMBER | {"value": value} for name, value in values.items()}
    common["block_stress"] |= {"of": "uncorrected stress"}
    piece = {"form": "power", "diameters": [1, 2], "at_1_mm": 1, "exponent": 1} | other.pop("piece", {})
    strength = {"pieces": [piece], "sources": ["a"], "sure": "one source"}
    common |= {name: common[name] | change for name, change in other.items()}
    sources = {"a": "A"}
    return with_common(
        {
            "standard": "S",
            "title": "T",
            "sources": sources,
            "common": common,
            "wires": [{"grade": "G", "strength": strength}],
        }
    )


def test_numbers_without_their_sources_are_refused():
    assert WireFile.model_validate(own_file()).wires[0].strength.at(2.0) == 0.5
    with pytest.raises(ValueError, match="the source 'b' is not among"):
        WireFile.model_validate(own_file(density={"sources": ["b"]}))
    with pytest.raises(ValueError, match=r"needs 2 source\(s\), 1 given"):
        WireFile.model_validate(own_file(density={"sure": "checked against a second source"}))


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"elastic_limit": {"value": 88.0}}, "elastic_limit is a part of Rm, 0.85 for 85 %, not 88"),
        ({"elastic_limit": {"value": 0.95}}, "elastic_limit must be below proof_stress"),
        ({"young_modulus": {"value": 206.0}, "shear_modulus": {"value": 79.5}}, "both in N/mm², not 206 and 79.5"),
        ({"shear_modulus": {"value": 7950.0}}, "E must be 2 to 3 times G"),
        ({"density": {"value": 7.85}}, "density is in kg/mm³, 7.85e-6 for steel, not 7.85"),
        ({"piece": {"diameters": [2, 1]}}, "the diameters must ascend, not 2, 1"),
        ({"density": {"value": None, "up_to": [2, 1], "values": [1e-6, 1e-6]}}, "the diameters must ascend"),
    ],
)
def test_numbers_in_other_units_or_orders_are_refused(other, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        WireFile.model_validate(own_file(**other))


def test_own_wires_stand_beside_those_of_standards(tmp_path, monkeypatch):
    folder = tmp_path / "coilset" / "wires"
    folder.mkdir(parents=True)
    ours = (library.FOLDER / "en10270-1.yaml").read_text(encoding="utf-8")
    works = re.sub(r"(?m)^standard: .*$", "standard: Works", ours).replace("springs: preset", "springs: not preset")
    (folder / "mine.yaml").write_text(works, encoding="utf-8")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    library.files.cache_clear()
    library._wires.cache_clear()
    try:
        assert wire("Works SH").strength(4.0) == wire("EN 10270-1 SH").strength(4.0)
        assert goodman.line(wire("Works SH").endurance(), 4.0).tested == "springs not preset"
        (folder / "again.yaml").write_text(ours, encoding="utf-8")
        library.files.cache_clear()
        with pytest.raises(InputError, match=r"again.yaml: standard: 'EN 10270-1' is there already"):
            library.files()
    finally:
        monkeypatch.undo()
        library.files.cache_clear()
        library._wires.cache_clear()
