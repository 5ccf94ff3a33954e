"""Small slices."""

import numpy as np
import pytest

from coilset.meshes.sections.mesh import section_mesh
from coilset.meshes.sections.shapes import round_wire
from coilset.model.core.material import library
from coilset.model.physics.slice.slice import Coil, Slice


@pytest.fixture
def make_slice():
    """Slice of a coil; keyword arguments: law's name, outline, index (D/d, wire of 5 mm), pitch, across, degree."""

    def make(law="ck15", outline=None, index=8.0, pitch=12.0, across=3.0, degree=2):
        coil = Coil(2.5 * index, pitch)
        return Slice(section_mesh(outline or round_wire(5.0), across, degree), coil, library.load(law))

    return make


@pytest.fixture
def moved():
    """Give a slice a random increment, so large that Ck 15 flows at all its points."""

    def move(body, seed=0, size=2e-2):
        rng = np.random.default_rng(seed)
        body.u[:] = size * rng.normal(size=body.u.shape)
        body.extra.trial[:] += -0.3, 0.01 * body.coil.radius
        assert body.update()
        return rng

    return move
