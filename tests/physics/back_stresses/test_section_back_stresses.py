"""A wire of several back stresses, twisted forth and back: its torque against the closed curves of its fibres."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from coilset.meshes.springs.placement import straight
from coilset.model.core.material import library
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import polar

R, TERMS = 2.5, [(200000.0, 1000.0), (22500.0, 150.0), (2000.0, 20.0)]  # C and γ of the file
LAW = library.load("chaboche")
TWISTS = (0.02, -0.015)  # of the rim, and back


def fibre(strains):
    """Shear stress of a fibre that is sheared from one strain to the next, by its plastic strain's closed curve."""
    plastic = way = 0.0
    X = [0.0] * len(TERMS)
    for γ in strains:
        sign = math.copysign(1.0, γ - plastic)

        def stress(change, sign=sign, X=tuple(X), way=way):
            far = [sign * C / g for C, g in TERMS]
            back = [a + (x - a) * math.exp(-g * change) for a, x, (_, g) in zip(far, X, TERMS, strict=True)]
            return (sum(back) + sign * (450.0 - 50.0 * math.exp(-30.0 * (way + change)))) / math.sqrt(3), back

        def off(change, γ=γ, plastic=plastic, sign=sign, stress=stress):
            """Of Hooke's stress from that of the curve, after a plastic strain change √3 (tension's change)."""
            return sign * (LAW.G * (γ - plastic - sign * math.sqrt(3) * change) - stress(change)[0])

        change = brentq(off, 0.0, 0.1, xtol=1e-15) if off(0.0) > 0 else 0.0
        X, way, plastic = stress(change)[1] if change else X, way + change, plastic + sign * math.sqrt(3) * change
    return LAW.G * (strains[-1] - plastic)


def test_torque_of_a_wire_twisted_forth_and_back():
    sections = make_sections("plane", LAW, LAW.parameters(), polar(12, 12), np.array([R]), straight(1))
    state = sections.initial_state() | {"strain": np.zeros((1, 2, 6))}
    s, D, found, twist = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6)), [], 0.0
    for end in TWISTS:
        for part in np.linspace(twist, end, 61)[1:]:
            trial = {name: values.copy() for name, values in state.items()}
            trial["strain"][..., 3] = part / R
            assert sections.update(trial["strain"], state, trial, s, D)
            state = trial
        found, twist = [*found, s[0, 0, 3]], end
    nodes, weights = np.polynomial.legendre.leggauss(60)
    r, dr = 0.5 * R * (1 + nodes), 0.5 * R * weights
    for i, torque in enumerate(found):
        τ = np.array([fibre([twist * one / R for twist in TWISTS[: i + 1]]) for one in r])
        assert torque == pytest.approx(2 * math.pi * (τ * r * r) @ dr, rel=1e-3)
    assert sections.components[7:] == ("B11_1", "B12_1", "B13_1", "B11_2", "B12_2", "B13_2")
