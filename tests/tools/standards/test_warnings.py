"""What a maker would warn of: each doubtful spring has its one line, a right one has none."""

import numpy as np
import pytest

from coilset.meshes.measured.measured import MeasuredSpec
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.case import read_case
from coilset.model.core.case.material import case_law
from coilset.model.core.material import library
from coilset.model.tools.limits.case_warnings import case_warnings
from coilset.model.tools.limits.spring_warnings import spring_warnings

RIGHT = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 6.0, "pitch": 12.0}


def table(turns, values):
    return {"turns": turns, "values": values, "interpolation": "linear"}


def warnings(entries):
    return spring_warnings(SpringSpec.model_validate(RIGHT | entries).build())


def test_constants_that_tests_leave_open_are_named_by_a_run(example, tmp_path):
    """The ± of a prediction with them said nothing of it."""
    text = (library.FOLDER / "voce.yaml").read_text(encoding="utf-8")
    for known, entry in ((True, ""), (False, "  undetermined: [rise, rate]\n")):
        (tmp_path / "mine.yaml").write_text(text.replace("validity:\n", f"validity:\n{entry}"), encoding="utf-8")
        case = read_case(example, [f"material={tmp_path / 'mine.yaml'}"])
        spring = case.spring.build()
        found = [
            one.message for one in case_warnings(case, spring, case_law(case, spring)) if one.name == "not determined"
        ]
        assert len(found) == (not known)
    assert found[0].startswith("the tests of voce do not determine rise, rate: other values fit them as well")


@pytest.mark.parametrize("scale", [0.0141, 1.0, 4.0])
def test_wires_from_a_hair_to_a_finger_are_right(scale):
    lengths = {name: scale * RIGHT[name] for name in ("wire_diameter", "mean_diameter", "pitch")}
    assert warnings(lengths) == []


def test_the_right_spring_is_right():
    assert warnings({}) == []


WARNED = [
    (  # in metres
        {"wire_diameter": 0.005, "mean_diameter": 0.04, "pitch": 0.012},
        "the wire is 0.005 mm thick at turn 0, outside the 0.07 to 20 mm usual in cold coiling (EN 15800); are all "
        "lengths in mm?",
    ),
    (
        {"wire_diameter": table([0, 6], [19.0, 25.0]), "mean_diameter": 200.0, "pitch": 50.0},
        "the wire is 25 mm thick at turn 6, outside the 0.07 to 20 mm usual in cold coiling (EN 15800); are all "
        "lengths in mm?",
    ),
    (
        {"turns": 3.5, "end_coils": "closed"},
        "only 1.5 active turns; formulas for rate and stress need 2 or more (EN 13906-1)",
    ),
    (
        {"end_coils": {"bottom": {"form": "closed and ground", "tip": 0.2}}},
        "the ground bottom end is 1 mm thick at its tip, less than a quarter of the wire (1.25 mm)",
    ),
    # the end turn of this cone rises by √(5² − 4²) = 3 mm; the flat ends 0.75 · 5 mm above the tip, 0.75 mm into the
    # transition, 3 u/2 + 9 (u³ − u⁴/2)/2 = 0.75 at u = 0.373 of its half turn
    (
        {"mean_diameter": {"shape": "cone", "bottom": 88.0, "top": 40.0}, "end_coils": {"bottom": "closed and ground"}},
        "the flat of the bottom end runs over 1.19 turns and cuts into the transition; its end turns are 1",
    ),
    (
        {"pitch": table([0, 2, 3, 6], [5.0, 5.0, 12.0, 12.0])},
        "coils of the body touch before any load, between turns 0 and 2.11; their pitch is 5 mm",
    ),
]


@pytest.mark.parametrize(("entries", "warning"), WARNED, ids=[warning[:40] for _, warning in WARNED])
def test_doubtful_spring_is_warned_of(entries, warning):
    assert warning in [found.message for found in warnings(entries)]


def test_a_measured_wire_in_metres_is_warned_of(tmp_path):
    """Points in mm, wire in m: no other number of the file is wrong."""
    turn = np.linspace(0.0, 4.0, 65)
    points = np.stack([20 * np.cos(2 * np.pi * turn), 20 * np.sin(2 * np.pi * turn), 12 * turn, 0 * turn + 0.005], 1)
    np.savetxt(tmp_path / "scan.csv", points, delimiter=",", header="x,y,z,wire_diameter", comments="")
    found = spring_warnings(MeasuredSpec(file=str(tmp_path / "scan.csv")).build())
    assert [one.name for one in found] == ["wire"]


@pytest.mark.parametrize(
    ("ends", "support", "place"),
    [
        ("closed and ground", "ends=clamped", "ends"),
        ("closed", "ends=clamped", "ends"),
        ("open", "ends=clamped", None),
        ("open", "seats.hold=groove", "seats.hold"),
        ("open", "seats.hold=tips", None),
        ("closed", "seats.hold=groove", None),
        ("closed and ground", "seats.hold=groove", None),
    ],
)
def test_supports_that_no_spring_has_are_named(example, ends, support, place):
    case = read_case(example, [f"spring.end_coils={ends}", "spring.turns=6", support])
    spring = case.spring.build()
    found = [one for one in case_warnings(case, spring, case_law(case, spring)) if one.name == "support"]
    assert [one.place for one in found] == ([place, place] if place else [])
    assert all(end in one.message and "give" in one.message for end, one in zip(("bottom", "top"), found, strict=False))


@pytest.mark.parametrize(("accuracy", "warned"), [("10 %", True), (0.2, True), ("0.2 %", False), ("none", False)])
def test_an_accuracy_that_is_rather_meant_in_per_cent(example, accuracy, warned):
    case = read_case(example, [f"accuracy={accuracy}", "loading=[{to: {travel: 5}, steps: 2}]"])
    spring = case.spring.build()
    found = [one for one in case_warnings(case, spring, case_law(case, spring)) if one.name == "accuracy"]
    assert len(found) == warned
