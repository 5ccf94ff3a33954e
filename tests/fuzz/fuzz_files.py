"""Input files that are nearly right: the shipped ones with an entry or a piece of their text spoilt."""

import copy
from functools import cache
from pathlib import Path

import yaml
from hypothesis import strategies as st

from coilset.model.material.library import FOLDER

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
KINDS = {
    "case": [EXAMPLES / "ck15_presetting.yaml", *sorted((EXAMPLES / "springs").glob("*.yaml"))],
    "material": sorted(Path(FOLDER).glob("*.yaml")),
    "program": sorted((EXAMPLES / "material").glob("*.yaml")),
    "sweep": [path for path in sorted((EXAMPLES / "sweeps").glob("*.yaml")) if path.stem != "thousand"],
}
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
    ],
    "sweep": [
        {"vary": {"spring.pitch": {"from": 11, "to": 13, "count": 3}}, "design": "grid"},
        {"vary": {"spring.turns": {"mean": 2.5, "tolerance": 0.1}}, "design": "sobol", "samples": 8, "seed": 3},
        {"vary": {"w": {"entries": ["spring.wire_diameter"], "values": [4.0, 5.0]}}, "design": "together"},
    ],
}
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
    """The data of a shipped file, perhaps with entries that it leaves out, and one to three of its entries spoilt."""
    data = copy.deepcopy(parsed(draw(st.sampled_from(KINDS[kind]))))
    if kind in ENTRIES and draw(st.booleans()):
        data |= copy.deepcopy(draw(st.sampled_from(ENTRIES[kind])))
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
            group[name] = group[name] * draw(st.sampled_from([-1, 0, 0.1, 0.5, 0.99, 1.01, 2, 10, 1000]))
        else:
            group[name] = copy.deepcopy(draw(st.sampled_from(VALUES)))
    return data


@st.composite
def spoilt_text(draw, kind):
    """The text of a file, with pieces cut out, put in, or doubled."""
    text = shipped(draw(st.sampled_from(KINDS[kind])))
    for _change in range(draw(st.integers(1, 3))):
        start = draw(st.integers(0, len(text)))
        end = draw(st.integers(start, min(len(text), start + 40)))
        middle = draw(st.sampled_from(["", text[start:end] * 2, *PIECES]))
        text = text[:start] + middle + text[end:]
    return text


def texts(kind):
    """Texts of nearly right files of a kind."""
    written = spoilt_data(kind).map(lambda data: yaml.safe_dump(data, allow_unicode=True, sort_keys=False))
    return st.one_of(written, written, spoilt_text(kind))
