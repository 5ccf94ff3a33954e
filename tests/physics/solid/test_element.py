"""The element: patch test at finite strain, rank, rates against a manufactured solution, and the tangent."""

import basix
import numpy as np
import pytest
import scipy.linalg
import ufl
from dolfinx import fem, mesh
from dolfinx.fem.petsc import apply_lifting, assemble_matrix, assemble_vector, set_bc
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import logm, polar
from solid_calls import commit, internal_forces, tangent
from solid_laws import Elastic, IdealPlastic

from coilset.meshes.solids.solid import SectionGrid, coil_section, straight_wire
from coilset.model.core.base.compat import interpolation_points
from coilset.model.physics.solid.solid import Solid

DOUBLE = np.array([1.0, 1, 1, 2, 2, 2])


def patch(layers=2):
    """A prism with the topology of the wire's mesh, its edges straight and its inner vertices displaced."""
    solid = Solid(straight_wire(2.0, 1.5, layers, MPI.COMM_SELF, SectionGrid(2, 1)), Elastic())
    x, cells = solid.state["x"].equilibrium, solid.V.dofmap.list
    vertices, edges = basix.topology(solid.wire.mesh.basix_cell())[:2]
    inside = np.setdiff1d(cells[:, : len(vertices)], boundary(solid))
    x[inside] += np.random.default_rng(0).uniform(-0.1, 0.1, (len(inside), 3))
    for edge, (a, b) in enumerate(edges):
        x[cells[:, len(vertices) + edge]] = 0.5 * (x[cells[:, a]] + x[cells[:, b]])
    solid.update()
    return solid


def boundary(solid):
    body = solid.wire.mesh
    body.topology.create_connectivity(2, 3)
    return fem.locate_dofs_topological(solid.V, 2, mesh.exterior_facet_indices(body.topology))


def solve(A, b):
    ksp = PETSc.KSP().create(A.comm)
    ksp.setOperators(A)
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    x = b.duplicate()
    ksp.solve(b, x)
    return x.array.copy()


def dense(form):
    A = assemble_matrix(form)
    A.assemble()
    return A.convert("dense").getDenseArray().copy()


def test_finite_patch_test():
    # any affine motion of the boundary of a distorted patch: the inside follows, and the stress is that of one point
    law, solid = Elastic(), patch()
    F = np.eye(3) + 0.15 * np.random.default_rng(4).normal(size=(3, 3))
    x0, edge = solid.x.copy(), boundary(solid)
    held = [fem.dirichletbc(fem.Function(solid.V), edge)]
    solid.u[:] = x0 @ (F - np.eye(3)).T  # the inside starts elsewhere
    inside = np.setdiff1d(np.arange(len(x0)), edge)
    solid.u[inside] += 0.003 * np.random.default_rng(7).normal(size=(len(inside), 3))
    assert solid.update()
    for _ in range(6):
        r = -internal_forces(solid)
        r[edge] = 0.0
        solid.u[:] += solve(tangent(solid, held), PETSc.Vec().createWithArray(r.ravel())).reshape(-1, 3)
        assert solid.update()
    assert np.allclose(solid.u, x0 @ (F - np.eye(3)).T, atol=1e-11)
    R, U = polar(F)
    E = logm(U).real
    σ = law.C @ (DOUBLE * [E[0, 0], E[1, 1], E[2, 2], E[0, 1], E[0, 2], E[1, 2]])
    S = np.array([[σ[0], σ[3], σ[4]], [σ[3], σ[1], σ[5]], [σ[4], σ[5], σ[2]]])
    S = R @ S @ R.T
    exact = [S[0, 0], S[1, 1], S[2, 2], S[0, 1], S[0, 2], S[1, 2]]
    assert np.allclose(solid.point_state[..., :6], exact, atol=1e-10 * law.G)


def test_rank():
    # six rigid modes and no other, and the softest deformation nearly as stiff as with full integration
    solid = patch()
    u, v = ufl.TrialFunction(solid.V), ufl.TestFunction(solid.V)
    M = dense(fem.form(ufl.inner(u, v) * ufl.dx(metadata={"quadrature_degree": 7})))
    values = scipy.linalg.eigh(dense(solid.forms.tangent), M, eigvals_only=True)
    assert np.all(np.abs(values[:6]) < 1e-9 * values[-1])
    G, λ = Elastic().G, Elastic().C[0, 1]
    work = 2 * G * ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) + λ * ufl.div(u) * ufl.div(v)
    full = dense(fem.form(work * ufl.dx(metadata={"quadrature_degree": 5})))
    reference = scipy.linalg.eigh(full, M, eigvals_only=True)
    assert values[6] == pytest.approx(reference[6], rel=0.05)


def test_manufactured_solution_converges_at_the_elements_rate():
    # linear elasticity on a round wire, body force from the exact field: order 3 in u and 2 in strain
    errors = []
    for n in (2, 4):
        solid = Solid(straight_wire(2.0, 1.5, n, MPI.COMM_SELF, SectionGrid(n, n // 2)), Elastic(1.0, 0.3))
        x = ufl.SpatialCoordinate(solid.wire.mesh)
        exact = ufl.as_vector(
            [
                ufl.sin(x[0] + 0.5 * x[2]) * ufl.cos(x[1]),
                ufl.exp(0.5 * x[0]) * ufl.sin(x[2]),
                ufl.cos(x[0] - x[1] + x[2]),
            ]
        )
        λ = 0.6 / 0.4
        σ = 2 * ufl.sym(ufl.grad(exact)) + λ * ufl.div(exact) * ufl.Identity(3)
        v = ufl.TestFunction(solid.V)
        dx = ufl.dx(metadata={"quadrature_degree": 6})
        b = assemble_vector(fem.form(-ufl.inner(ufl.div(σ), v) * dx))
        held = fem.Function(solid.V)
        held.interpolate(fem.Expression(exact, interpolation_points(solid.V)))
        conditions = [fem.dirichletbc(held, boundary(solid))]
        apply_lifting(b, [solid.forms.tangent], bcs=[conditions])
        set_bc(b, conditions)
        A = tangent(solid, conditions)
        u = fem.Function(solid.V)
        u.x.array[:] = solve(A, b)
        e = u - exact
        squares = ufl.inner(e, e), ufl.inner(ufl.grad(e), ufl.grad(e))
        errors.append([fem.assemble_scalar(fem.form(f * dx)) ** 0.5 for f in squares])
    rates = np.log2(np.array(errors[0]) / errors[1])
    assert rates == pytest.approx([3.0, 2.0], abs=0.35)
    assert errors[1][0] < 3e-3


def test_tangent_by_taylor_in_a_plastic_state():
    # r(u + h v) − r(u) − h K v falls with h², in a body that is partly plastic and has turned by 0.6 rad
    law = IdealPlastic()
    solid = Solid(coil_section(5.0, 20.0, 8.0, 60.0, 4, MPI.COMM_SELF, SectionGrid(2, 1)), law)
    rng = np.random.default_rng(5)
    turn = scipy.spatial.transform.Rotation.from_rotvec([0.3, -0.5, 0.2]).as_matrix()
    x = solid.x.copy()
    solid.u[:] = x @ (turn - np.eye(3)).T + 0.0008 * rng.normal(size=x.shape)
    assert solid.update()
    plastic = solid.point_state[..., 12] > 0
    assert 0.2 < plastic.mean() < 0.999
    A = tangent(solid)
    u, r = solid.u.copy(), internal_forces(solid)
    v = 1e-3 * rng.normal(size=u.shape)
    Kv = (A * PETSc.Vec().createWithArray(v.ravel())).array.reshape(-1, 3)
    rest = []
    for h in (3e-3, 1.5e-3, 0.75e-3):
        solid.u[:] = u + h * v
        solid.update()
        rest.append(np.linalg.norm(internal_forces(solid) - r - h * Kv))
    assert rest[-1] < 1e-3 * 0.75e-3 * np.linalg.norm(Kv)
    assert np.log2(rest[0] / rest[1]) == pytest.approx(2, abs=0.02)
    assert np.log2(rest[1] / rest[2]) == pytest.approx(2, abs=0.02)


def test_rigid_motion_of_a_stressed_body_turns_its_stress():
    solid = Solid(coil_section(5.0, 20.0, 8.0, 60.0, 4, MPI.COMM_SELF, SectionGrid(2, 1)), Elastic())
    solid.u[:] = 0.01 * np.random.default_rng(6).normal(size=solid.u.shape)
    assert solid.update()
    before = internal_forces(solid)
    commit(solid)
    R = scipy.spatial.transform.Rotation.from_rotvec([1.0, -2.0, 0.5]).as_matrix()
    solid.u[:] = solid.x @ (R - np.eye(3)).T + [3.0, 1.0, -2.0]
    assert solid.update()
    assert np.allclose(internal_forces(solid), before @ R.T, atol=1e-9 * np.abs(before).max())
