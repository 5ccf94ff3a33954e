"""Shared by all tests: small springs, rods and wires that touch, and the communicator of the rank alone."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from coilset.meshes.line import line_mesh
from coilset.model.compose.analysis import Analysis
from coilset.model.core.contact.base import TrialPositions
from coilset.model.core.contact.curve import CentreLine
from coilset.model.core.material import library
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.rod.elements import THESIS
from coilset.model.core.rod.rod import Rod
from coilset.model.core.section.rules import polar

os.environ.setdefault("COILSET_THREADS", "1")  # the tests' own processes run side by side already

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Where packages are deleted, as test_deletion.py does, a test that needs one is skipped: it is refused by name."""
    report = yield
    problem = str(call.excinfo.value) if call.excinfo else ""
    if "which this installation lacks" in problem:
        report.outcome, report.longrepr = "skipped", (str(item.path), 0, problem)
    return report


@pytest.fixture(scope="session")
def ck15():
    return library.load("ck15")


@pytest.fixture
def make_rod(ck15):
    """Rod through given stations; keyword arguments: radius (number), law, rule, comm, element."""

    def make(stations, radius=2.5, law=None, rule=None, comm=MPI.COMM_SELF, element=THESIS):
        line = line_mesh(np.asarray(stations, float), comm)
        radii = np.full(len(stations) - 1, float(radius))
        return Rod(line, radii, law or ck15, rule or polar(), element=element)

    return make


@pytest.fixture
def resumed_after(tmp_path):
    """A new analysis of a case, with the state that one left when it was stopped after some step of it, or `before`."""

    def resume(case, number, before=None):
        begun = before or case

        def stop(step):
            if step.number == number:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            Analysis(begun, MPI.COMM_SELF).run(stop, Checkpoint(tmp_path, begun).save)
        resumed = Analysis(case, MPI.COMM_SELF)
        resumed.resume(Checkpoint(tmp_path, case).load(MPI.COMM_SELF))
        return resumed

    return resume


@pytest.fixture(scope="session")
def reference():
    """The law as rate equations, which share nothing with it; see rate_equations.py."""
    sys.path.insert(0, str(Path(__file__).parent))
    import rate_equations

    return rate_equations


@pytest.fixture(scope="session")
def example():
    """The shipped example's path."""
    return EXAMPLES / "ck15_presetting.yaml"


# Wires that touch
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
