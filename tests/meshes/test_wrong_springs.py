"""Wrong specifications, each with the one line that it must raise, as the reader of case files gives it."""

import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check

RIGHT = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 6.0, "pitch": 12.0}
CONE = {"shape": "cone", "bottom": 40.0, "top": 30.0}
FORMS = "must be a number, a table, or one of the shapes cylinder, cone, double cone, hourglass, barrel, funnel"
OVERLAP = "spring: coils overlap: between the turns {} the centres of the wire are {} mm apart, must be at least 5 mm"


def table(turns, values, **more):
    return {"turns": turns, "values": values, "interpolation": "linear", **more}


# entries that replace or (None) remove those of the right spring, and the message
WRONG = [
    ({"wire_diameter": -5.0}, "spring.wire_diameter: -5.0: must be greater than 0"),
    ({"wire_diameter": 0}, "spring.wire_diameter: 0: must be greater than 0"),
    (
        {"wire_diameter": "5 mm"},
        "spring.wire_diameter: '5 mm': must be a number without its unit; units are N, mm, MPa and K everywhere",
    ),
    ({"wire_diameter": float("nan")}, "spring.wire_diameter: nan: must be a finite number"),
    ({"wire_diameter": 1e9}, "spring.wire_diameter: 1e+09 is not a possible length; must be 0.001 to 100000"),
    ({"wire_diameter": True}, "spring.wire_diameter: True: must be a number"),
    (
        {"wire_diameter": None},
        "spring.wire_diameter: this entry is required; give wire diameter, mm; a number or a table over the turns",
    ),
    ({"diameter": 40.0}, "spring.diameter: unknown entry; is outer_diameter or inner_diameter meant?"),
    (
        {"mean_diameter": 14.0},
        "spring.mean_diameter: the wire is thicker than the coil allows: D/d = 2.8 at turn 0, must be at least 3",
    ),
    ({"mean_diameter": {"shape": "pyramid"}}, "spring.mean_diameter: {'shape': 'pyramid'}: " + FORMS),
    (
        {"mean_diameter": {"shape": "cone", "bottom": 40.0}},
        "spring.mean_diameter.top: this entry is required; give mean coil diameter at the top end, mm",
    ),
    (
        {"mean_diameter": CONE | {"middle": 3.0}},
        "spring.mean_diameter.middle: unknown entry; the entries here are shape, bottom, top",
    ),
    (
        {"mean_diameter": CONE | {"top": 12.0}},
        "spring.mean_diameter: the wire is thicker than the coil allows: D/d = 2.4 at turn 6, must be at least 3",
    ),
    (
        {"mean_diameter": {"shape": "barrel", "ends": 50.0, "middle": 40.0}},
        "spring.mean_diameter: a barrel is wider in its middle (40 mm) than at its ends (50 mm); "
        "the other way round it is an hourglass",
    ),
    (
        {"mean_diameter": {"shape": "hourglass", "ends": 30.0, "middle": 40.0}},
        "spring.mean_diameter: an hourglass is narrower in its middle (40 mm) than at its ends (30 mm); "
        "the other way round it is a barrel",
    ),
    (
        {"mean_diameter": {"shape": "funnel", "bottom": 60.0, "neck": 30.0, "cone_turns": 6.0}},
        "spring.mean_diameter: cone_turns is 6, but the spring has only 6 turns; leave some for the neck, or use the "
        "shape cone",
    ),
    (
        {"mean_diameter": {"turns": [0, 6], "values": [40.0, 30.0]}},
        "spring.mean_diameter.interpolation: this entry is required; give linear; monotone (cubic without overshoot, "
        "smooth slope); spline (cubic, smooth curvature)",
    ),
    (
        {"mean_diameter": table([0, 6], [40.0, 30.0], interpolation="cubic")},
        "spring.mean_diameter.interpolation: 'cubic': must be 'linear', 'monotone' or 'spline'",
    ),
    (
        {"mean_diameter": table([0, 3, 6], [40.0, 30.0])},
        "spring.mean_diameter: has 3 turns but 2 values; give one value for each turn",
    ),
    (
        {"mean_diameter": table([0, 3], [40.0, 30.0])},
        "spring.mean_diameter: ends at turn 3, but the spring has 6 turns",
    ),
    (
        {"mean_diameter": table([0, 4, 4, 6], [40.0] * 4)},
        "spring.mean_diameter: turns must increase from one to the next, by 0.001 or more",
    ),
    ({"mean_diameter": table([1, 6], [40.0] * 2)}, "spring.mean_diameter: must begin at turn 0, not at 1"),
    (
        {"mean_diameter": None},
        "spring: the coil diameter is missing; give one of mean_diameter, outer_diameter (De) and inner_diameter (Di)",
    ),
    (
        {"outer_diameter": 45.0},
        "spring: mean_diameter, outer_diameter are given; give one of mean_diameter, "
        "outer_diameter (De) and inner_diameter (Di)",
    ),
    (
        {"mean_diameter": None, "outer_diameter": 19.0},
        "spring.outer_diameter: the wire is thicker than the coil allows: D/d = 2.8 at turn 0, must be at least 3",
    ),
    ({"mean_diameter": None, "outer_diameter": 4.0}, "spring.outer_diameter: the coil is no wider than its wire"),
    (
        {"mean_diameter": None, "inner_diameter": table([0, 3], [40.0, 30.0])},
        "spring.inner_diameter: ends at turn 3, but the spring has 6 turns",
    ),
    ({"turns": -2.5}, "spring.turns: -2.5: must be greater than or equal to 0.1"),
    ({"turns": float("inf")}, "spring.turns: inf: must be a finite number"),
    ({"pitch": None}, "spring: pitch and free_length are both missing; give one of them"),
    ({"pitch": -12.0}, "spring.pitch: -12.0: must be greater than 0"),
    ({"pitch": 4.0}, OVERLAP.format("0 and 1", "4")),
    # the pitch falls by 1.5 mm a turn, to 3.5 mm and 2 mm at the turns 5 and 6
    ({"pitch": table([0, 6], [11.0, 2.0])}, OVERLAP.format("5 and 6", "2.75")),
    # √(4.5² + (5/6)²) = 4.58
    ({"mean_diameter": CONE, "pitch": 4.5}, OVERLAP.format("0 and 1", "4.58")),
    (
        {"free_length": 80.0},
        "spring.free_length: 80 mm contradicts the pitch, which makes 77 mm; leave one of the two out",
    ),
    (
        {"pitch": None, "free_length": 4.0},
        "spring.free_length: 4 mm leave no pitch: end coils and wire alone need 5 mm",
    ),
    ({"pitch": None, "free_length": 29.0}, OVERLAP.format("0 and 1", "4")),
    ({"hand": "up"}, "spring.hand: 'up': must be 'right' or 'left'"),
    ({"end_coils": "ground"}, "spring.end_coils.form: 'ground': must be 'open', 'closed' or 'closed and ground'"),
    (
        {"end_coils": {"form": "open", "turns": 1.0}},
        "spring.end_coils: open ends have no end turns and no transition; leave these out or make the form closed",
    ),
    (
        {"end_coils": {"form": "closed", "tip": 0.3}},
        "spring.end_coils: tip is for ends that are closed and ground, not for closed ends",
    ),
    ({"end_coils": {"form": "closed and ground", "tip": 1.5}}, "spring.end_coils.tip: 1.5: must be less than 1"),
    (
        {"end_coils": {"bottom": {"form": "closed", "turns": -1.0}}},
        "spring.end_coils.bottom.turns: -1.0: must be greater than or equal to 0.01",
    ),
    (
        {"end_coils": {"form": "closed", "turns": 2.5}},
        "spring.turns: 6 turns are too few: end turns and transitions alone are 6",
    ),
]


def build(entries):
    spring = {key: value for key, value in (RIGHT | entries).items() if value is not None}
    return check({"spring": spring, "loading": [{"to": "block"}]}).spring.build()


@pytest.mark.parametrize(("entries", "message"), WRONG, ids=[message[:60] for _, message in WRONG])
def test_wrong_spring_has_its_message(entries, message):
    with pytest.raises(InputError) as error:
        build(entries)
    assert str(error.value) == message


def test_python_use_raises_the_same():
    with pytest.raises(ValueError, match="should be greater than 0"):
        SpringSpec(wire_diameter=-5.0, mean_diameter=40.0, turns=2.5, pitch=12.0)
