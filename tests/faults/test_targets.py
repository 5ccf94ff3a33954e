"""Targets judged before the run, with the numbers: seats only press, and nothing is pressed beyond its block."""

import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check, read_case
from coilset.model.core.case.loading import is_pressed
from coilset.model.core.case.targets import check_targets, closing_force
from coilset.model.physics.slice.analysis import SliceAnalysis
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.scripts.commands.solve import solve

G = 84000.0
PULLS = [("force", -1000, "-1000 N"), ("travel", -2, "-2 mm"), ("height", 40, "40 mm, above the free length of 35 mm")]


@pytest.mark.parametrize(("entry", "value", "words"), PULLS)
def test_seats_do_not_pull(example, tmp_path, entry, value, words):
    loading = f"loading=[{{to: {{travel: 2}}}}, {{to: {{{entry}: {value}}}}}]"
    with pytest.raises(InputError, match=words) as caught:
        solve(example, tmp_path / "out", False, [loading])
    assert f"loading.1.to.{entry}" in str(caught.value)
    assert not (tmp_path / "out").exists()
    clamped = read_case(example, [loading, "ends=clamped"])
    check_targets(clamped, clamped.spring.build(), G)  # heads of clamped ends pull


@pytest.mark.parametrize("target", ["force: 0", "travel: 0", "height: 35"])
def test_an_unloaded_spring_is_no_pull(example, target):
    case = read_case(example, [f"loading=[{{to: {{{target}}}}}]"])
    check_targets(case, case.spring.build(), G)


BEYOND = [
    (
        "travel: 25",
        "travel: is 25 mm, but the spring can only be compressed by 17.5 mm, to its block height of 17.5 mm",
    ),
    ("travel: 1e9", "travel: is 1e+09 mm"),
    ("height: 10", "height: is 10 mm, below the block height of 17.5 mm"),
    ("height: 17.49", "height: is 17.49 mm, below the block height of 17.5 mm"),
    ("force: 5000", "force: is 5000 N, but all coils of this spring are in contact at about 717.8 N"),
]


@pytest.mark.parametrize(("target", "words"), BEYOND)
@pytest.mark.parametrize("ends", ["seats", "clamped"])
def test_nothing_is_pressed_beyond_its_block(example, tmp_path, target, words, ends):
    settings = [f"loading=[{{to: block}}, {{to: {{{target}}}}}]", f"ends={ends}"]
    with pytest.raises(InputError) as caught:
        solve(example, tmp_path / "out", False, settings)
    assert f"loading.1.to.{words}" in str(caught.value)
    assert not (tmp_path / "out").exists()


SOLID = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 6.0, "pitch": 5.0}
LIES = (
    "spring: there is no travel: the free length is 35 mm, the block length 35 mm; wind it longer, or pull or turn it, "
    "as in {to: {force: 0, top: {turn: 90}}}"
)


@pytest.mark.parametrize("to", ["block", {"force": 10.0}, {"travel": 0.1}, {"height": 34.9}])
@pytest.mark.parametrize("ends", ["seats", "clamped"])
def test_coils_that_lie_on_each_other_are_not_pressed(to, ends):
    case = check({"spring": SOLID, "ends": ends, "loading": [{"to": to}]})
    spring = case.spring.build()
    for refuses in (lambda: check_targets(case, spring, G), lambda: case_sheet(case, spring, None)):
        with pytest.raises(InputError) as caught:
            refuses()
        assert str(caught.value) == LIES
    if ends == "clamped":
        with pytest.raises(InputError, match="there is no travel"):
            SliceAnalysis(case)


@pytest.mark.parametrize(
    "to",
    [
        {"force": -10.0},
        {"height": 40.0},
        {"force": 0.0, "top": {"turn": 90.0}},
        {"force": 0.0, "top": {"torque": 90.0}},
        {"travel": 0.0, "top": {"turn": -90.0}},
        {"top": {"turn": 90.0}},
    ],
)
def test_coils_that_lie_on_each_other_are_pulled_and_turned(to):
    case = check({"spring": SOLID, "ends": "clamped", "loading": [{"to": to}]})
    spring = case.spring.build()
    check_targets(case, spring, G)
    assert not is_pressed(case, spring)


@pytest.mark.parametrize("target", ["travel: 17.5", "height: 17.5", "force: 1400"])
def test_block_itself_is_not_beyond(example, target):
    case = read_case(example, [f"loading=[{{to: {{{target}}}}}]"])
    check_targets(case, case.spring.build(), G)


def test_a_double_cone_stops_where_its_flanks_rest_on_each_other():
    """Its coils pass their neighbours, and 3.069 mm would press the upper flank into the lower one."""
    spring = {"wire_diameter": 0.979, "turns": 5.07, "pitch": 1.578, "end_coils": "closed and ground"}
    spring["mean_diameter"] = {"shape": "double cone", "ends": 7.398, "middle": 12.221}
    case = check({"spring": spring, "loading": [{"to": {"travel": 3.069}}]})
    words = "is 3.069 mm, but the spring can only be compressed by 2.18626 mm, to its block height of 1.95797 mm"
    with pytest.raises(InputError, match=words):
        check_targets(case, case.spring.build(), G)


def test_seats_of_other_shapes_have_no_known_block(example):
    seats = "seats={bottom: {shape: conical, angle: 10}}"
    for travel, fits in ((20, True), (34.9, True), (35.1, False)):
        case = read_case(example, [seats, f"loading=[{{to: {{travel: {travel}}}}}]"])
        if fits:
            check_targets(case, case.spring.build(), G)
        else:
            with pytest.raises(InputError, match="its free length"):
                check_targets(case, case.spring.build(), G)


def test_the_closing_force_is_that_of_the_last_coil():
    """G d⁴ (p − d)/(8 D³) of a cylinder; of a cone whose coils nest beside each other, of its smallest coil."""
    shape = {"wire_diameter": 5.0, "turns": 4.0, "pitch": 12.0}
    cylinder = SpringSpec.model_validate({**shape, "mean_diameter": 40.0}).build()
    assert closing_force(cylinder, G) == pytest.approx(G * 5**4 * 7 / (8 * 40**3), rel=1e-12)
    cone = SpringSpec.model_validate({**shape, "mean_diameter": {"shape": "cone", "bottom": 100, "top": 50}}).build()
    assert closing_force(cone, G) == pytest.approx(G * 5**4 * 12 / (8 * 50**3), rel=1e-12)
