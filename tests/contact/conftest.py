"""Wires for the contact tests, and dense forces and stiffness of a kind of contact."""

import numpy as np
import pytest

from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.curve import CentreLine

TURNS, RADIUS = np.linspace(0.0, 2.5, 41), 20.0


def _helix(pitch, taper=0.0, seed=0, noise=0.0, lift=0.0):
    angle, R = 2 * np.pi * TURNS, RADIUS - taper * TURNS
    x = np.stack([R * np.cos(angle), R * np.sin(angle), pitch * TURNS + lift], axis=1)
    return x + noise * np.random.default_rng(seed).normal(size=x.shape)


def _points(thin=2.5, thick=2.5):
    return CentreLine(TURNS, np.linspace(thin, thick, 41), np.full(40, 2 * np.pi * RADIUS / 16)).points()


def _dense(contact, x, seats):
    part, n = contact.evaluate(TrialPositions(x, seats)), x.size + len(seats)
    f, K = np.zeros(n), np.zeros((n, n))
    for dofs, force, k in zip(part.dofs, part.forces, part.stiffness, strict=True):
        np.add.at(f, dofs, force)
        np.add.at(K, np.ix_(dofs, dofs), k)
    return f, K, part


@pytest.fixture
def helix():
    """Stations of 2.5 turns of radius 20 mm, which shrinks by `taper` mm a turn, with `noise` mm, from z = `lift`."""
    return _helix


@pytest.fixture
def points():
    """Points of that wire, its radius growing from `thin` to `thick`."""
    return _points


@pytest.fixture
def dense():
    """Forces and stiffness on all degrees of freedom of stations and seats, and the Contribution."""
    return _dense
