"""The tangent on ranks, whose elements at cuts have rows of two of them, against that of one rank."""

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.core.equilibrium.system.load import Load

pytestmark = pytest.mark.mpi
COMM = MPI.COMM_WORLD
SPRING = [
    "spring.turns=5",
    "spring.pitch=6",
    "mesh.section.radial=2",
    "mesh.section.angular=6",
    "mesh.elements_per_turn=12",
    "loading=[{to: {travel: 1}}]",
]


def products(case, comm, height):
    """Tangent times two vectors, in natural order, with the spring bent at random at a share of its height; and the
    number of contacts."""
    analysis = Analysis(case, comm)
    system, matrix, layout = analysis.system, analysis.newton.iteration.matrix, analysis.layout
    rng, n, x0 = np.random.default_rng(6), len(layout.station_dofs), analysis.rod.line.stations
    ordered = rng.normal(scale=1e-3, size=layout.size)
    ordered[2 : 6 * n : 6] += (height - 1.0) * x0[:, 2]
    increments, found = layout.vector(layout.from_order(ordered).copy()), []
    load = Load.of(layout, {int(dof): 0.0 for dof in layout.station_dofs[n // 2]}, {})
    system.evaluate(increments)
    matrix.fill(system.last.contributions)
    for held in ([], load.held):  # then also with a station held in the middle
        matrix.hold(np.asarray(held, dtype=np.int64))
        right = layout.vector(layout.from_order(rng.normal(size=layout.size)).copy())
        found.append(layout.to_order((matrix.mat * right).getArray(readonly=True)))
    return found, system.last.closed


@pytest.mark.parametrize("height", [0.98, 0.55], ids=["open", "pressed"])
def test_tangent_is_that_of_one_rank(example, height):
    """To 1e-12 of the largest entry: sums in another order."""
    case = read_case(example, SPRING)
    (found, closed), (expected, of_one) = products(case, COMM, height), products(case, MPI.COMM_SELF, height)
    assert closed == of_one
    assert (closed > 60) == (height < 0.6)
    for each, right in zip(found, expected, strict=True):
        np.testing.assert_allclose(each, right, rtol=0, atol=1e-12 * np.abs(right).max())
