"""Damped corrections: what they leave of weak and stiff modes; stability where friction makes tangents unsymmetric."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from coilset.model.compose.analysis import Analysis
from coilset.model.core.case import read_case
from coilset.model.core.equilibrium.newton.damping import NOTHING, RELAX, SHORT, Damping
from coilset.model.physics.stability.stability import _rayleigh_ritz

EXAMPLE = Path(__file__).parents[3] / "examples" / "ck15_presetting.yaml"
WEAK, STIFF = 0.5, 4e4  # N/mm
WEIGHTS = np.array([1.0, 2.0, 1.0])


def damping():
    return Damping(SimpleNamespace(weights=WEIGHTS, comm=MPI.COMM_SELF))


def vector(values):
    return PETSc.Vec().createWithArray(np.array(values, dtype=float), comm=MPI.COMM_SELF)


FREE = SimpleNamespace(is_held=np.array([False, False, True]))


@pytest.mark.parametrize("share", [0.2, 0.01])
def test_a_weak_mode_is_damped_by_the_share_that_was_made(share):
    """K = diag(weak, 2 stiff), the third unknown is held: of the next correction by (K + c M)⁻¹ F along the weak mode
    the same share is left, and nearly all along the stiff one."""
    found, K = damping(), np.array([WEAK, 2.0 * STIFF])
    forces = np.array([3.0, 0.0])
    found.adjust(vector([*(forces / K), 7.0]), vector([*forces, 1e6]), FREE, share)
    left = K / (K + found.value * WEIGHTS[:2])
    assert left[0] == pytest.approx(share, rel=1e-12)
    assert left[1] > 1.0 - 2e-3
    # whole corrections relax it, until it is nothing beside the mode
    for _relaxed in range(1, 20):
        before = found.value
        found.adjust(vector([*(forces / K), 7.0]), vector([*forces, 1e6]), FREE, 1.0)
        assert found.value == pytest.approx(before * RELAX) or (found.value == 0.0 and before * RELAX < NOTHING * WEAK)
    assert found.value == 0.0


def test_nothing_is_damped_unless_corrections_are_short():
    found = damping()
    found.adjust(vector([1.0, 1.0, 0.0]), vector([1.0, 1.0, 0.0]), FREE, SHORT)
    assert found.value == 0.0


def test_stability_with_friction_counts_real_eigenvalues():
    """Those of the tangent at block, dense; it is not symmetric."""
    case = read_case(
        EXAMPLE,
        [
            "mesh.elements_per_turn=8",
            "mesh.section={rule: abramowitz9}",
            "contact={bedding: 2e5, friction: {seats: 0.9, coils: 0.9}}",
            "loading=[{to: block, steps: 6}]",
        ],
    )
    analysis = Analysis(case, MPI.COMM_SELF, estimates=False)
    analysis.run()
    system, load, matrix = analysis.system, analysis.newton.iteration.load, analysis.newton.iteration.matrix
    system.tangent(system.layout.vector(), load, matrix)
    n = system.layout.size
    free = np.setdiff1d(np.arange(n), load.held)
    K = matrix.mat.getValues(range(n), range(n))[np.ix_(free, free)]
    roots = np.linalg.eigvals(K / system.layout.weights[free][:, None])
    assert not system.is_symmetric
    assert abs(K - K.T).max() > 1e-3 * abs(K).max()
    least = analysis.stability.weakest(load)
    assert least.negative == np.count_nonzero(roots.real < 0.0) == 0
    assert least.value == pytest.approx(roots[np.isreal(roots)].real.min(), rel=1e-3)


@pytest.mark.parametrize("friction", [True, False])
def test_a_sliding_contact_makes_the_symmetric_part_alone_indefinite(friction):
    """Penetration and slip of one contact, μ = 0.3: K = ((c, 0), (μ c, k)) has the eigenvalues c and k."""
    c, k, μ = 1e4, 10.0, 0.3
    K = PETSc.Mat().createDense((2, 2), array=np.array([[c, 0.0], [μ * c, k]]), comm=MPI.COMM_SELF)
    block = [vector([1.0, 0.0]), vector([0.0, 1.0])]
    values, _ = _rayleigh_ritz(K, vector([1.0, 1.0]), block, symmetric=not friction)
    if friction:
        assert np.sort(values) == pytest.approx([k, c], rel=1e-9)
    else:
        assert values.min() == pytest.approx(0.5 * (c + k - np.hypot(c - k, μ * c)), rel=1e-9)
        assert values.min() < 0.0
