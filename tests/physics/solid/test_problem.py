"""The solid between its heads: torsion against closed solutions, balance, solvers and ranks against each other."""

import numpy as np
import pytest
from mpi4py import MPI
from solid_laws import Elastic, IdealPlastic

from coilset.meshes.solids import solid
from coilset.meshes.solids.solid import SectionGrid, coil_section, straight_wire
from coilset.model.core.base.compat import to_ranks
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.equilibrium.newton import methods
from coilset.model.core.equilibrium.settings import StepControl
from coilset.model.core.material import library
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.program import AxialProgram
from coilset.model.physics.solid.sampling import SectionSample, disk_grid
from coilset.verification.solid_study.references import nadai_torque

d, R, L = 5.0, 2.5, 5.0
ORIGIN = np.zeros(3)


def straight(n, law, layers=2, **options):
    return SolidProblem(straight_wire(d, L, layers, MPI.COMM_SELF, SectionGrid(n, n)), law, "direct", **options)


def section(comm, law, degrees=90.0, layers=6, **options):
    return SolidProblem(coil_section(d, 30.0, 10.0, degrees, layers, comm, SectionGrid(2, 1)), law, **options)


def twist(problem, angle):
    problem.step(Motion(rotation=(0.0, 0.0, angle)))
    return problem.reactions(ORIGIN)[1].moment[2]


def test_elastic_torsion():
    # G I_p θ/L; the field is in the space, so only the parabolic outline errs: order 4 or better in the torque
    law, angle = Elastic(), 1e-6
    exact = law.G * np.pi * R**4 / 2 * angle / L
    errors = [abs(twist(straight(n, law), angle) / exact - 1) for n in (1, 2, 4)]
    assert errors[2] < 1e-4
    assert errors[0] / errors[1] > 2**4
    assert errors[1] / errors[2] > 2**4


def test_elastic_plastic_torsion_is_nadais():
    # within 0.5 %; measured on this mesh: 0.06 % or less
    law = library.load("ideal_plastic")
    yield_shear = law.yield_stress / np.sqrt(3)
    problem = straight(3, MaterialPoints(law))
    yield_angle = yield_shear * L / (law.G * R)
    for ratio in (1.5, 2.0, 3.0, 5.0):
        assert twist(problem, ratio * yield_angle) == pytest.approx(nadai_torque(yield_shear, R, ratio), rel=2e-3)
    # elastic release: the angle that springs back is T / (G I_p / L)
    torque = nadai_torque(yield_shear, R, 5.0)
    rest = twist(problem, 5 * yield_angle - torque * L / (law.G * np.pi * R**4 / 2))
    assert abs(rest) < 2e-3 * torque


def test_heads_balance_after_a_large_twist():
    # forces, and moments about any point, of the two heads cancel: the virtual work of the rigid motions
    problem = straight(2, Elastic(), precision=1e-10)
    for angle in (0.4, 0.8, 1.2):
        twist(problem, angle)
    bottom, top = problem.reactions([1.0, 2.0, 3.0])
    size = np.abs(top.moment).max()
    assert np.abs(bottom.force + top.force).max() < 1e-8 * size / d
    assert np.abs(bottom.moment + top.moment).max() < 1e-8 * size


@pytest.mark.parametrize("law", [Elastic(), IdealPlastic()], ids=["elastic", "ideal plastic"])
def test_balance_and_newtons_convergence(law):
    problem = section(MPI.COMM_SELF, law, precision=1e-9)
    norms = []
    problem.newton.iteration.snes.setMonitor(lambda snes, iteration, norm: norms.append(norm))
    for z in (-0.5, -1.0):
        norms.clear()
        problem.step(Motion((0.0, 0.0, z)))
    # the last iterations at least square the error, with a constant of order one in relative terms
    relative = np.array(norms) / norms[0]
    assert relative[-1] < 10 * relative[-2] ** 1.5 or relative[-1] < 1e-10
    bottom, top = problem.reactions(ORIGIN)
    assert np.abs(bottom.force + top.force).max() < 1e-7 * np.abs(top.force).max()
    assert np.abs(bottom.moment + top.moment).max() < 1e-7 * np.abs(top.moment).max()
    assert top.force[2] < 0


@pytest.mark.parametrize("solver", ["multigrid", "multigrid-cg"])
def test_multigrid_finds_what_the_factorisation_finds(solver):
    forces = []
    for name in ("direct", solver):
        problem = section(MPI.COMM_SELF, MaterialPoints(library.load("ck15")), solver=name, precision=1e-9)
        effort, _cuts = problem.step(Motion((0.0, 0.0, -1.0)))
        forces.append(problem.reactions(ORIGIN)[1].force)
    assert np.allclose(*forces, rtol=1e-7, atol=1e-7 * np.abs(forces[0]).max())
    assert effort.linear_iterations < 60 * effort.iterations


@pytest.mark.mpi
@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_all_ranks_together_find_what_one_finds(solver):
    results = []
    for comm in (MPI.COMM_SELF, MPI.COMM_WORLD):
        problem = section(comm, MaterialPoints(library.load("ck15")), solver=solver, precision=1e-10)
        program = AxialProgram(problem)
        program.press(1.5, 2)
        program.release(2, precision=1e-7)
        results.append([(s.travel, s.force, s.torque) for s in program.stations])
    scale = np.abs(results[0]).max(axis=0)
    assert np.all(np.abs(np.array(results[0]) - results[1]) < 1e-8 * scale)


@pytest.mark.mpi
@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_a_rank_without_cells_takes_part(monkeypatch, solver):
    def all_on_the_first(comm, ranks, kinds, nodes):
        return to_ranks(np.zeros(len(nodes[0]) // 8))

    monkeypatch.setattr(solid, "unghosted", lambda: all_on_the_first)
    results = []
    for comm in (MPI.COMM_SELF, MPI.COMM_WORLD):
        wire = straight_wire(d, L, 8, comm, SectionGrid(1, 1))
        problem = SolidProblem(wire, MaterialPoints(library.load("ck15")), solver, precision=1e-10)
        problem.step(Motion(rotation=(0.0, 0.0, 0.05)))
        stress = SectionSample(problem.solid, 0.5 * L, *disk_grid(R, 2, 8)).stress()
        results.append(np.append(problem.reactions(ORIGIN)[1].moment, stress))
    assert np.abs(results[1] - results[0]).max() < 1e-7 * np.abs(results[0]).max()


@pytest.mark.mpi
def test_all_ranks_together_sample_what_one_samples():
    # a grid with many integration points at equal distances, whose order depends on the partition
    found = []
    for comm in (MPI.COMM_SELF, MPI.COMM_WORLD):
        wire = coil_section(d, 40.0, 12.0, 180.0, 8, comm, SectionGrid(2, 2))
        problem = SolidProblem(wire, Elastic(), precision=1e-10)
        problem.step(Motion((0.0, 0.0, -0.5)))
        found.append(SectionSample(problem.solid, 0.5 * wire.length, *disk_grid(R)).stress())
    assert np.abs(found[1] - found[0]).max() < 1e-8 * np.abs(found[0]).max()


def test_a_step_too_large_is_cut():
    problem = section(MPI.COMM_SELF, Elastic(), 180.0, 8)
    _effort, cuts = problem.step(Motion((0.0, 0.0, -60.0)))  # twice the coil's diameter at one go
    assert cuts > 0
    assert problem.top.motion == Motion((0.0, 0.0, -60.0))
    bottom, top = problem.reactions(ORIGIN)
    assert np.abs(bottom.force + top.force).max() < 1e-6 * np.abs(top.force).max()


def test_an_impossible_step_leaves_the_last_equilibrium():
    problem = section(MPI.COMM_SELF, Elastic(), steps=StepControl(smallest=0.5))
    problem.step(Motion((0.0, 0.0, -0.5)))
    x, forces = problem.solid.x.copy(), problem.forces.copy()
    with pytest.raises(SolveError, match="no equilibrium"):
        problem.step(Motion((0.0, 0.0, -300.0)))
    assert np.array_equal(problem.solid.x, x)
    assert np.allclose(problem.forces, forces, atol=1e-9 * np.abs(forces).max())


@pytest.mark.parametrize("solver", ["multigrid", "multigrid-cg"])
def test_one_layer_leaves_multigrid_no_vertex_and_is_refused(solver):
    # both heads hold all vertices; `auto` takes the factorisation however many unknowns there are
    wire = straight_wire(d, L, 1, MPI.COMM_SELF, SectionGrid(1, 1))
    with pytest.raises(InputError, match=f"solver: '{solver}' needs two layers of elements or more"):
        SolidProblem(wire, Elastic(), solver)


@pytest.mark.parametrize(("layers", "chosen"), [(1, "direct"), (2, "multigrid")])
def test_many_unknowns_are_solved_by_multigrid_where_a_vertex_is_free(monkeypatch, layers, chosen):
    monkeypatch.setattr(methods, "DIRECT_LIMIT", 10)
    problem = SolidProblem(straight_wire(d, L, layers, MPI.COMM_SELF, SectionGrid(1, 1)), Elastic(), "auto")
    assert problem.solver == chosen
    assert twist(problem, 1e-6) > 0


def test_an_unknown_solver_is_refused():
    wire = straight_wire(d, L, 1, MPI.COMM_SELF, SectionGrid(1, 1))
    with pytest.raises(InputError, match="solver"):
        SolidProblem(wire, Elastic(), "magic")
