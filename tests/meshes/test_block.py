"""The height at which springs are solid, against stacks worked out by hand; in wire diameters unless said otherwise.

The middle of a double cone lies at y = 0, and its radius falls by c wire diameters a turn on either side. Wires of one
meridian lie whole turns apart. `tests/core/contact/test_block.py` presses such a spring onto its stack.
"""

import numpy as np
import pytest
import yaml

from coilset.meshes.springs.block import _each_on_the_next, _highest_stack
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.compose.examples import EXAMPLES

EXACT = 1e-9


def double_cone(slope, turns=5.0, wide=30.0):
    diameter = {"shape": "double cone", "ends": wide - slope * turns, "middle": wide}
    return SpringSpec(wire_diameter=1.0, mean_diameter=diameter, turns=turns, pitch=3.0).build()


def test_flanks_that_pass_their_neighbours_rest_on_each_other():
    """Beyond c = 1 each cone lies flat, and the upper one on the lower one; the mean of neighbours is less."""
    for slope in (1.0, 1.1, 1.5):
        spring = double_cone(slope)
        assert spring.block_height == pytest.approx(2.0, rel=EXACT)
        assert _each_on_the_next(spring) == pytest.approx(1.0 + np.pi / (4.0 * slope), rel=1e-4)


@pytest.mark.parametrize("slope", [0.3, 0.6, 0.8])
def test_steep_flanks_stack_on_their_neighbours(slope):
    """Of 5 turns, six wires at y = ±½, ±3/2, ±5/2: the middle ones one wire, the others √(1 − c²) above each other."""
    spring = double_cone(slope)
    assert _highest_stack(spring) == pytest.approx(1.0 + 1.0 + 4.0 * np.sqrt(1.0 - slope**2), rel=EXACT)


def test_wires_of_both_flanks_two_turns_apart():
    """c = 0.97, 4 turns: at y = 0, ±1, ±2 the wires −1 and 1 lie one wire apart; over 0 it were 2 √(1 − c²) = 0.486."""
    c = 0.97
    stack = 1.0 + np.sqrt(1.0 - c**2) + 1.0 + np.sqrt(1.0 - c**2)
    assert _highest_stack(double_cone(c, turns=4.0)) == pytest.approx(stack, rel=EXACT)


def test_wide_barrels_rest_on_stacks():
    """The example: r = 25 − 10 (y/3)² mm, 6 turns, d 5. Five wires at y = ±½, ±3/2, ±5/2 that all touch."""
    d, r = 5.0, lambda y: 25.0 - 10.0 * (y / 3.0) ** 2
    stack = 2 * d + 2 * sum(np.sqrt(d**2 - (r(y + 1) - r(y)) ** 2) for y in (0.5, 1.5))
    spec = yaml.safe_load((EXAMPLES / "springs" / "barrel.yaml").read_text(encoding="utf-8"))["spring"]
    assert SpringSpec.model_validate(spec).build().block_height == pytest.approx(stack, rel=EXACT)


def test_thick_wire_at_one_turn():
    """Wire of 1, 2, 1 mm over 4 turns: the wires at 1, 2, 3 turns are 1.5, 2, 1.5 mm thick; 0 and 4 turns, 1 mm."""
    wire = {"turns": [0.0, 2.0, 4.0], "values": [1.0, 2.0, 1.0], "interpolation": "linear"}
    spring = SpringSpec(wire_diameter=wire, mean_diameter=20.0, turns=4.0, pitch=4.0).build()
    assert spring.block_height == pytest.approx(1.0 + 1.5 + 2.0 + 1.5 + 1.0, rel=EXACT)


def test_flat_spirals_lie_on_their_seats():
    """A cone whose coils all pass each other is as high as its wire; ground tips stand half a wire lower."""
    cone = {"shape": "cone", "bottom": 60.0, "top": 20.0}
    spring = SpringSpec(wire_diameter=2.0, mean_diameter=cone, turns=5.0, pitch=5.0).build()
    assert spring.block_height == pytest.approx(2.0, rel=EXACT)


def test_short_stacks_do_not_replace_whole_coils():
    """Of a cylinder of 5.6 turns the wires of a meridian are six at most, but its coils rise by 5.6 wires and one."""
    spring = SpringSpec(wire_diameter=2.0, mean_diameter=20.0, turns=5.6, pitch=5.0).build()
    assert _highest_stack(spring) == pytest.approx(12.0, rel=EXACT)
    assert spring.block_height == pytest.approx(13.2, rel=EXACT)
