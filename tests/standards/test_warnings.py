"""What a maker would warn of: each doubtful spring has its one line, a right one has none."""

import pytest

from coilset.meshes.spring import SpringSpec
from coilset.model.standards.warnings import spring_warnings

RIGHT = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 6.0, "pitch": 12.0}


def table(turns, values):
    return {"turns": turns, "values": values, "interpolation": "linear"}


def warnings(entries):
    return spring_warnings(SpringSpec.model_validate(RIGHT | entries).build())


def test_the_right_spring_is_right():
    assert warnings({}) == []


WARNED = [
    # γ = 1 − 81.5/206 = 0.6044: 65/γ · (1 − √(1 − γ/0.8956 · (π/3.25)²)) = 42.18 mm
    (
        {"mean_diameter": 20.0, "turns": 8.0, "pitch": 15.625, "end_coils": "open"},
        "slender, L0/D = 6.5: unguided it buckles at 42.2 mm of travel on parallel seats, before its block at 85 mm "
        "(EN 13906-1)",
    ),
    ({"mean_diameter": 17.5}, "D/d = 3.5 at turn 0 is outside of the 4 to 20 usual in cold coiling (EN 15800)"),
    ({"mean_diameter": 110.0}, "D/d = 22 at turn 0 is outside of the 4 to 20 usual in cold coiling (EN 15800)"),
    (
        {"turns": 3.5, "end_coils": "closed"},
        "only 1.5 active turns; formulas for rate and stress need 2 or more (EN 13906-1)",
    ),
    (
        {"end_coils": {"bottom": {"form": "closed and ground", "tip": 0.2}}},
        "the ground bottom end is 1 mm thin at its tip, less than a quarter of the wire (1.25 mm)",
    ),
    # the end turn of this cone rises by √(5² − 4²) = 3 mm; the flat ends 0.75 · 5 mm above the tip, 0.75 mm into the
    # transition, 3 u/2 + 9 (u³ − u⁴/2)/2 = 0.75 at u = 0.373 of its half turn
    (
        {"mean_diameter": {"shape": "cone", "bottom": 88.0, "top": 40.0}, "end_coils": {"bottom": "closed and ground"}},
        "the flat of the bottom end runs over 1.19 turns and cuts into the transition; its end turns are 1",
    ),
    (
        {"pitch": table([0, 2, 3, 6], [5.0, 5.0, 12.0, 12.0])},
        "coils of the body are solid before any load, between the turns 0 and 2; their pitch is 5 mm",
    ),
]


@pytest.mark.parametrize(("entries", "warning"), WARNED, ids=[warning[:40] for _, warning in WARNED])
def test_doubtful_spring_is_warned_of(entries, warning):
    assert warning in [found.message for found in warnings(entries)]
