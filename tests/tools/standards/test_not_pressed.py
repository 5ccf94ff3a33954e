"""Springs that are pulled or turned: judged as such, and not by the rules for compression springs.

The numbers of the spring with long hooks (wire 1.2, D 10.8, 18 turns, F0 8 N, SH) are worked out by hand from
G = 81,500 N/mm² and the hooks' compliance of 0.0606 mm/N.
"""

from dataclasses import replace

import numpy as np
import pytest

from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.load_history import LoadHistory
from coilset.model.core.base.entry import check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import UnloadedCase, check
from coilset.model.tools.document.diagrams import diagrams
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.from_results import Found
from coilset.model.tools.sheet.rows import sections
from coilset.model.tools.standards.buckling import buckling_travel

HOOK = {"shape": "german", "length": 18.6}
PULLED = {
    "spring": {
        "wire_diameter": 1.2,
        "outer_diameter": 12.0,
        "turns": 18,
        "initial_tension": 8.0,
        "hooks": {"bottom": HOOK, "top": HOOK},
    },
    "material": {"wire": "EN 10270-1 SH"},
    "ends": "clamped",
    "loading": [{"to": {"force": -35.0}}, {"to": {"force": 0.0}}],
    "working": {"lengths": [75.0, 90.0]},
}
EXAMPLE = {
    "spring": {
        "wire_diameter": 3.0,
        "mean_diameter": 30.0,
        "turns": 10,
        "initial_tension": 25.0,
        "hooks": {"bottom": {"shape": "german"}, "top": {"shape": "german"}},
    },
    "working": {"lengths": [150.0, 180.0]},
}
TURNED = {
    "spring": {
        "wire_diameter": 2.0,
        "inner_diameter": 14.0,
        "turns": 6.25,
        "pitch": 2.2,
        "arms": {"bottom": {"length": 30.0}, "top": {"length": 30.0}},
    },
    "material": {"wire": "EN 10270-1 SH"},
    "ends": "clamped",
    "loading": [{"to": {"force": 0.0, "top": {"turn": 220.0}}}, {"to": {"force": 0.0, "top": {"torque": 0.0}}}],
}


def made(entries, lengths=()):
    case = check(entries)
    return case_sheet(case, case.spring.build(), None, lengths=lengths)


DOOR = {"wire_diameter": 6.35, "inner_diameter": 50.8, "turns": 20, "pitch": 6.35}


@pytest.mark.parametrize(
    ("entries", "part"),
    [(PULLED, "13906-2"), (TURNED, "13906-3"), (PULLED | {"spring": DOOR}, "13906-2")],
    ids=["hooks", "arms", "coils that lie on each other"],
)
def test_without_a_load_program_the_drawing_shows_what_a_spring_is_for(entries, part):
    left = {name: value for name, value in entries.items() if name not in ("loading", "working")}
    case = check_entries(left, UnloadedCase)
    sheet = case_sheet(case, case.spring.build(), None)
    assert part in sections(sheet)[1][0]
    assert [panel.name for panel in diagrams(sheet, {})] == ([] if sheet.turned else ["force"])


def test_a_torque_is_a_rotation_by_the_rate():
    """The sheet of a spring that a torque turns was that of a compression spring."""
    turned = made(TURNED)
    loading = [{"to": {"force": 0.0, "top": {"torque": 100.0 * turned.turn_rate}}}]
    sheet = made(TURNED | {"loading": loading})
    assert sheet.turns_to == pytest.approx((100.0,))
    assert sheet.beyond == turned.beyond > 0.0
    assert "13906-3" in sections(sheet)[1][0]


def test_hooks_give_way_before_the_coils_open():
    """Their stretch by F0 belongs to the travel: 21.23 and 34.46 N without it; a run has 20.69 and 34.18 N."""
    sheet = made(PULLED)
    assert sheet.beyond == pytest.approx(0.0606, rel=1e-3)
    for length, by_hand in ((75.0, 20.80), (90.0, 34.03)):
        assert -sheet.force(length) == pytest.approx(
            (length - 60.0 + 8.0 / 0.93164) / (1.0 / 0.93164 + 0.0606), rel=1e-3
        )
        assert -sheet.force(length) == pytest.approx(by_hand, abs=0.01)
        assert sheet.length(sheet.force(length)) == pytest.approx(length)
    stretch = sheet.beyond * 8.0
    assert -sheet.force(60.0 + 0.5 * stretch) == pytest.approx(4.0)
    assert -sheet.force(60.0 + stretch) == pytest.approx(8.0)
    assert sheet.length(-4.0) == pytest.approx(60.0 + 0.5 * stretch)


def test_the_cycle_of_a_pulled_spring_is_judged_in_the_quadrant_of_its_stress():
    """It was drawn from −862 to −584 MPa, 370 MPa below a line that it exceeds; τ = 8 D F/(π d³), k = 10.5/9.25.

    The line of SH, as coiled, at 3 mm: 422.5 MPa over 0, 922.4 over 678.4.
    """
    sheet = made(PULLED | EXAMPLE)
    forces = [-sheet.force(length) for length in (150.0, 180.0)]
    stresses = [10.5 / 9.25 * 8.0 * 30.0 * force / (np.pi * 27.0) for force in forces]
    assert (sheet.cycle.lower, sheet.cycle.upper) == pytest.approx(stresses)
    assert sheet.endured.upper(stresses[0]) == pytest.approx(422.5 + (922.4 - 422.5) * stresses[0] / 678.4, rel=1e-3)
    assert sheet.endured.upper(stresses[0]) < stresses[1]
    assert [title for title, _ in sections(sheet)][-1] == "Endurance"


def test_what_winding_left_does_not_shift_the_cycle():
    run = Found({}, np.array([60.0, 90.0]), np.array([0.0, -34.0]), residual=126.0, ring=1.0)
    sheet = replace(made(PULLED), found=run)
    assert sheet.residual is None
    assert replace(sheet, pulled=False).residual == 126.0


def test_hooks_are_shown():
    """q 32 F a/(π d³) + 4 F/(π d²) of an English hook, a = 5.4 mm, q = (4 · 81 − 9 − 1)/(4 · 9 · 8)."""
    english = PULLED["spring"] | {"hooks": {"bottom": {"shape": "english"}, "top": {"shape": "english"}}}
    sheet = made(PULLED | {"spring": english})
    by_hand = 314.0 / 288.0 * 32.0 * 5.4 / (np.pi * 1.2**3) + 4.0 / (np.pi * 1.2**2)
    assert sheet.hook_stress == pytest.approx(by_hand, rel=1e-3)
    shown = {row.label.strip(): row for _, rows in sections(made(PULLED)) for row in rows}
    assert shown["bending stress of hooks"].value == pytest.approx(made(PULLED).hook_stress * 34.03, rel=1e-3)
    assert shown["minimum tensile strength Rm"].value == pytest.approx(2230 - 820 * np.log10(1.2), rel=1e-3)


@pytest.mark.parametrize("shape", ["german", "english", "side"])
def test_hook_stress_is_that_of_a_run(shape):
    """Elastic, 1 N: 38.1, 35.6 and 35.8 MPa on a mesh of 64 elements a turn."""
    found = {"german": 38.12, "english": 35.55, "side": 35.80}[shape]
    hooks = {"bottom": {"shape": shape}, "top": {"shape": shape}}
    sheet = made(PULLED | {"spring": PULLED["spring"] | {"turns": 4, "initial_tension": 1e-3, "hooks": hooks}})
    assert sheet.hook_stress == pytest.approx(found, rel=0.03)


def test_no_safety_against_the_block_stress_of_another_kind():
    """That of a pulled or turned spring was 0.56 Rm, the stress allowed at block, over its τ: 2.23 for this one."""
    short = PULLED["spring"] | {"turns": 3}
    mesh = {"elements_per_turn": 8, "section": {"radial": 2, "angular": 8}}
    pulled = LoadHistory(check(PULLED | {"spring": short, "mesh": mesh, "working": None}))
    assert pulled.setup.limits.shear is None
    pressed = {name: short[name] for name in ("wire_diameter", "outer_diameter", "turns")} | {"pitch": 2.0}
    loading = {"loading": [{"to": {"travel": 1.0}}]}
    compressed = LoadHistory(check(PULLED | {"spring": pressed, "mesh": mesh, "working": None} | loading))
    assert compressed.setup.limits.shear == pytest.approx(0.56 * (2230 - 820 * np.log10(1.2)), rel=1e-3)


def test_what_hangs_in_hooks_does_not_buckle_on_seats():
    """A slender spring of 5.6 L0/D was said to buckle, before a block to which nothing presses it."""
    spring = check(PULLED).spring.build()
    assert buckling_travel(spring) == np.inf
    slender = SpringSpec(wire_diameter=1.0, mean_diameter=8.0, turns=20, pitch=4.0).build()
    assert buckling_travel(slender) < slender.free_length


def test_lengths_of_a_pulled_spring_are_above_the_free_one():
    assert list(made(PULLED, [100.0]).lengths) == [100.0]
    with pytest.raises(InputError, match=r"^--length: 50 mm is no working length; must be above the free length 60 mm"):
        made(PULLED, [50.0])
