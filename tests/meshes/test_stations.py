"""Node placement along the wire: counts, grading and sagitta."""

import numpy as np
import pytest

from coilset.meshes.springs.shapes import Table
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError


def cylinder(turns=2.5):
    return SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=turns, pitch=12.0).build()


@pytest.mark.parametrize(
    ("turns", "per_turn", "elements"), [(2.5, 16, 40), (2.3, 16, 37), (6.0, 10.5, 63), (0.5, 3, 2)]
)
def test_equal_elements(turns, per_turn, elements):
    nodes = cylinder(turns).stations(per_turn)
    np.testing.assert_allclose(nodes, np.linspace(0, turns, elements + 1))


def test_graded_elements():
    # 48 a turn at the tips, falling to 16 within a turn: 32 on average there, 16 in each of the two turns between
    table = Table(turns=(0, 1, 3, 4), values=(48, 16, 16, 48), interpolation="linear")
    nodes = cylinder(4.0).stations(table)
    assert len(nodes) - 1 == 2 * 32 + 2 * 16
    density = 1 / np.diff(nodes)
    middle = 0.5 * (nodes[1:] + nodes[:-1])
    np.testing.assert_allclose(density, np.interp(middle, table.turns, table.values), rtol=0.01)


def test_sagitta_is_kept():
    spring = SpringSpec(
        wire_diameter=5.0, mean_diameter={"shape": "cone", "bottom": 80.0, "top": 30.0}, turns=6, pitch=14.0
    ).build()
    nodes = spring.stations(4, sagitta=0.1)
    ends = spring.centre_line(nodes)
    chord = np.diff(ends, axis=0)
    middle = spring.centre_line(0.5 * (nodes[1:] + nodes[:-1])) - ends[:-1]
    along = np.sum(middle * chord, axis=1, keepdims=True) / np.sum(chord**2, axis=1, keepdims=True)
    distance = np.linalg.norm(middle - along * chord, axis=1)
    # everywhere used up to 3 % (arcs of up to 20°, κ h²/8 is their first term) and never exceeded
    assert distance.max() <= 0.1
    assert distance.min() > 0.096
    # wide coils need more elements: n = π/√(2 s/r) of them in a turn
    assert len(nodes) - 1 == pytest.approx(np.pi / np.sqrt(0.2) * 4 * (40**1.5 - 15**1.5) / (25), rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((2,), "2 to 2 elements per turn; must be 3 to 1000000"),
        ((16, 1e-12), "elements per turn; must be 3 to 1000000"),
        (
            (Table(turns=(0, 3), values=(16, 16), interpolation="linear"),),
            "ends at turn 3, but the spring has 2.5 turns",
        ),
    ],
)
def test_wrong_densities(arguments, message):
    with pytest.raises(InputError, match=message):
        cylinder().stations(*arguments)
