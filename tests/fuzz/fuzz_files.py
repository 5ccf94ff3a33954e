"""Input files that are nearly right: the shipped ones with an entry or a piece of their text spoilt."""

import copy
from functools import cache
from pathlib import Path

import yaml
from hypothesis import strategies as st

from coilset.model.core.material.library import FOLDER

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
KINDS = {
    "case": [
        EXAMPLES / "ck15_presetting.yaml",
        *(path for folder in ("springs", "time", "sheet") for path in sorted((EXAMPLES / folder).glob("*.yaml"))),
        *sorted((EXAMPLES / "nested").glob("nested_*.yaml")),
    ],
    "material": sorted(Path(FOLDER).glob("*.yaml")),
    "program": sorted((EXAMPLES / "material").glob("*.yaml")),
    "sweep": [path for path in sorted((EXAMPLES / "sweeps").glob("*.yaml")) if path.stem != "thousand"],
    "design": sorted((EXAMPLES / "design").glob("*.yaml")),
    "nest": [EXAMPLES / "nested" / "nest.yaml"],
}
COILS = {"mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
TEMPERATURE = {"temperature": 293.15, "elasticity": {"G": 79000, "nu": 0.29}, "non_normality": "none"}
POINTS = {"strain": [0.0, 0.005, 0.01, 0.05], "stress": [0.0, 1000.0, 1200.0, 1400.0]}
ENTRIES = {  # of files of a kind, that the shipped ones leave out
    "case": [
        {"seats": {"hold": "groove", "groove": 1.5, "top": {"tilt": "free"}}},
        {"seats": {"bottom": {"shape": "conical", "angle": 12.5}, "top": {"shape": "stepped", "turns": 0.5}}},
        {"contact": {"coils": "gaps", "bedding": 2000.0, "penetration_limit": 0.03, "friction": {"seats": 0.1}}},
        {"contact": {"augmentation_tolerance": 0.01, "friction": {"coils": 0.2}}},
        {"solver": {"method": "bfgs", "tolerance": 1e-7, "options": {"snes_max_it": 30}}},
        {"solver": {"control": {"newton": {"stagnation": 10}, "steps": {"growth": 1.4, "automatic": 8}}}},
        {"mesh": {"axis": "chords", "section": {"kind": "plane", "rule": "abramowitz9"}}},
        {"mesh": {"elements_per_turn": {"turns": [0, 2.5], "values": [16, 24]}, "sagitta": 0.05}},
        {"mesh": {"section": {"kind": "warping", "degree": 2, "radial": 6, "angular": 24}}},
        {"material": {"wire": "EN 10270-1 SH"}, "temperature": 293.15, "rates_at": [1.0, 2.0]},
        {"ends": "clamped", "loading": [{"to": {"travel": -2.0}, "steps": "auto"}, {"to": {"force": 10}}]},
        {"loading": [{"to": {"height": 30.0}}, {"to": {"force": 100}, "steps": 3}]},
        {"spring": COILS | {"wire": {"tube": {"outer": 5.0, "inner": 3.0}}}},
        {"spring": COILS | {"wire": {"tube": {"outer": 5.0, "inner": 4.9}, "angle": 30}}, "ends": "clamped"},
        {"spring": COILS | {"wire": {"rectangle": {"width": 5.0, "height": 3.0, "corner": 0.4}, "angle": 10}}},
        {"spring": COILS | {"wire": {"rectangle": {"width": 5.0, "height": 5.0, "corner": 2.5}}}},
        {"spring": COILS | {"wire": {"trapezoid": {"width": 5.0, "inside": 4.0, "outside": 3.0, "corner": 0.3}}}},
        {"spring": COILS | {"wire": {"egg": {"inside": 2.0, "outside": 1.5, "distance": 2.0}}, "end_coils": "ground"}},
        {
            "spring": {"wire_diameter": 3.0, "mean_diameter": 30.0, "turns": 8, "initial_tension": 25.0}
            | {"hooks": {"bottom": {"shape": "english"}, "top": {"shape": "german"}}},
            "ends": "clamped",
            "loading": [{"to": {"travel": -30}}, {"to": {"force": 0}}],
        },
        {
            "spring": {"wire_diameter": 3.0, "mean_diameter": 30.0, "turns": 5.5, "pitch": 3.0, "hand": "left"}
            | {"arms": {"bottom": {"length": 25.0}, "top": {"length": 25.0}}},
            "ends": "clamped",
            "heads": {"top": {"sideways": "free"}},
            "contact": {"arbor": 22.0, "friction": {"guides": 0.1}},
            "loading": [
                {"to": {"force": 0, "top": {"turn": 180}}, "steps": 20},
                {"to": {"force": 0, "top": {"torque": 0}}},
            ],
        },
        {"solver": {"options": {"pc_type": "python", "pc_python_type": "evil.py:Evil", "snes_view": "ascii:file"}}},
        {"solver": {"options": {"snes_type": "newtontr", "ksp_type": "gmres", "pc_type": "lu", "ksp_rtol": 1e-10}}},
        {"solver": {"options": {"npc_snes_type": "nrichardson", "npc_snes_max_it": 3, "mat_mumps_icntl_14": 50}}},
        {"working": {"lengths": [30.0, 25.0]}, "limits": {"force_at_30": [100, 200], "set": [0, 1]}},
        {"release": "held", "force_line": {"lower": 0.0, "upper": 40.0, "damper": {"point": [0, 0, 0]}}},
        {"sheet": {"customer": "=1+1", "drawing": "[red]$x$<b>"}},
    ],
    "material": [
        {"temperatures": [TEMPERATURE | {"isotropic": {"law": "table", **POINTS}, "kinematic": "none"}]},
        {
            "temperatures": [
                TEMPERATURE
                | {
                    "isotropic": {"law": "table", "test": "torsion", "strains": "plastic", **POINTS},
                    "kinematic": {"law": "chaboche", "terms": [{"C": 20000, "gamma": 150}]},
                }
            ]
        },
        {
            "temperatures": [
                TEMPERATURE
                | {"temperature": at, "kinematic": "none"}
                | {"isotropic": {"law": "swift", "C": 1500, "strain_0": 0.002, "n": 0.15}}
                for at in (293.15, 473.15)
            ]
        },
        {
            "temperatures": [
                TEMPERATURE
                | {"isotropic": {"law": "ramberg-osgood", "proof_stress": 900, "n": 12, "elastic_limit": 700}}
                | {"kinematic": "none"}
            ]
        },
        {"rate": {"reference_rate": 0.01, "exponent": 5}, "tensile_strength": 1800},
        {"heating": {"dissipated": 0.9, "density": 7.85e-9, "specific_heat": 4.6e8}},
        {"creep": {"form": "garofalo", "strain": 2e-4, "stress": 800, "exponent": 6, "hardening": "time"}},
        {"units": "N, m, K"},
    ],
    "design": [
        {"find": {"spring.pitch": [11.0, 13.0], "ends": {"choices": ["seats", "clamped"]}}},
        {"find": {"p": {"entries": ["spring.pitch", {"entry": "spring.turns", "factor": 0.2}], "from": 10, "to": 13}}},
        {"such_that": {"set_mm": {"at_most": 1.0}, "force_at": [{"height": 21.0, "N": {"at_least": 100}}]}},
        {"such_that": {"working": {"force_at_25_N": 100}, "turn_set_deg": 3}, "trade_offs": {"material": ["ck15"]}},
    ],
    "nest": [{"loading": [{"to": {"height": 50.0}, "steps": 3}, {"to": "block"}]}],
    "sweep": [
        {"vary": {"spring.pitch": {"from": 11, "to": 13, "count": 3}}, "design": "grid"},
        {"vary": {"spring.turns": {"mean": 2.5, "tolerance": 0.1}}, "design": "sobol", "samples": 8, "seed": 3},
        {"vary": {"w": {"entries": ["spring.wire_diameter"], "values": [4.0, 5.0]}}, "design": "together"},
    ],
}
FACTORS = [-1, 0, 1e-6, 1e-3, 0.1, 0.5, 0.99, 1.01, 2, 9.80665, 10, 25.4, 1e3, 1e6]  # also of units
VALUES = [
    None,
    True,
    False,
    0,
    1,
    -1,
    3,
    12.0,
    0.5,
    -0.5,
    1e-300,
    1e300,
    -1e300,
    1e9,
    10**30,
    float("nan"),
    float("inf"),
    "",
    "block",
    "auto",
    "ck15",
    "none",
    "no",
    "1e5",
    "12:30:00",
    "0x1F",
    "../../etc/passwd",
    "/dev/null",
    ".",
    "x" * 5000,
    "Ä ß 漢",
    "a\tb",
    "[",
    [],
    {},
    [1, 2],
    [[1.0, 2.0], [3.0]],
    {"to": "block"},
    {"a": {"b": {"c": [1, {"d": 2}]}}},
    {"turns": [0, 1], "values": [5.0, 4.0]},
    {"mean": 5, "tolerance": 0.1},
    [None],
    ["block"],
    {"force": 0},
]
PIECES = [
    "\0",
    "\t",
    ": ",
    "- ",
    "&a ",
    "*a",
    "{",
    "}",
    "[",
    "]",
    "!!python/object:os.system ",
    "#",
    "'",
    '"',
    "\n",
    "|",
    ">",
    "---\n",
    "...\n",
    "\ufeff",
    "\x85",
    "\u2028",
    "%YAML 9.9\n",
    "<<: *a\n",
    "? ",
    "1e999",
    "0777",
    "~",
    "é" * 9,
]


def places(data, above=()):
    """Paths of all entries and list items."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for name, value in items:
        yield (*above, name)
        yield from places(value, (*above, name))


def at(data, path):
    for name in path:
        data = data[name]
    return data


@cache
def shipped(path):
    """Text of a shipped file, read once."""
    return path.read_text(encoding="utf-8")


@cache
def parsed(path):
    """Its data, read once; a copy is to be changed."""
    return yaml.safe_load(shipped(path))


@st.composite
def spoilt_data(draw, kind):
    """The data of a shipped file, perhaps with entries that it leaves out, and up to three of its entries spoilt."""
    data = copy.deepcopy(parsed(draw(st.sampled_from(KINDS[kind]))))
    if kind in ENTRIES and draw(st.booleans()):
        data |= copy.deepcopy(draw(st.sampled_from(ENTRIES[kind])))
    return draw(spoilt_entries(data))


@st.composite
def spoilt_entries(draw, data):
    """Data with up to three of their entries spoilt, in place."""
    for _change in range(draw(st.integers(0, 3))):
        found = list(places(data))
        if not found:
            break
        *above, name = draw(st.sampled_from(found))
        group, change = at(data, above), draw(st.sampled_from(["value", "value", "near", "remove", "rename", "add"]))
        if change == "remove":
            del group[name]
        elif change == "rename" and isinstance(group, dict):
            group[draw(st.sampled_from(["x", str(name) + "s", str(name)[:-1], "", "a.b", "0"]))] = group.pop(name)
        elif change == "add" and isinstance(group, list):
            group.append(copy.deepcopy(group[0]))
        elif change == "near" and isinstance(group[name], int | float):
            group[name] = group[name] * draw(st.sampled_from(FACTORS))
        else:
            group[name] = copy.deepcopy(draw(st.sampled_from(VALUES)))
    return data


@st.composite
def spoilt_text(draw, text):
    """A text with pieces cut out, put in, or doubled."""
    for _change in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text)))
        end = draw(st.integers(start, min(len(text), start + 40)))
        middle = draw(st.sampled_from(["", text[start:end] * 2, *PIECES]))
        text = text[:start] + middle + text[end:]
    return text


def texts(kind):
    """Texts of nearly right files of a kind."""
    written = spoilt_data(kind).map(lambda data: yaml.safe_dump(data, allow_unicode=True, sort_keys=False))
    return st.one_of(written, written, st.sampled_from(KINDS[kind]).flatmap(lambda path: spoilt_text(shipped(path))))
