# %% [markdown]
# # The helical slice: a whole spring in one section of its wire
#
# A long spring under axial load stays a helix whose sections all deform alike, so that one section is the whole
# three-dimensional problem. Here a plastic spring is pressed and released with nothing but UFL's derivatives; coilset's
# slice, which has another measure of strain and compiled loops, checks the numbers.
#
# A point of the wire is $x = Q(t)\, x_0(ξ, η) + h t\, e_z$: the section $x_0$ is turned about the spring's axis by $t$
# and raised by $h t$. At $t = 0$ the tangents of $x$ along $ξ$, $η$ and $t$ are the columns of
# $\hat F = [\, x_{0,ξ} \;|\; x_{0,η} \;|\; e_z × x_0 + h\, e_z \,]$, linear in $x_0$ and the rise $h$ together.

# %%
import basix.ufl
import gmsh
import matplotlib.figure
import numpy as np
import scipy.sparse.linalg
import ufl
from dolfinx import fem
from mpi4py import MPI

from coilset.api import Case, slice_
from coilset.model.core.base.compat import mesh_from_gmsh  # dolfinx.io.gmshio.model_to_mesh, under its names so far

d, D, pitch, turns = 5.0, 30.0, 11.0, 5.0  # mm
E, ν, yield_stress, H = 210e3, 0.3, 400.0, 2000.0  # MPa; H: slope of stress over plastic strain
G, bulk = E / 2.0 / (1.0 + ν), E / 3.0 / (1.0 - 2.0 * ν)

# %% [markdown]
# ## The section
#
# Curved triangles; $ξ$ points away from the spring's axis, $η$ upward, both normal to the wire. Each point has a state:
# six plastic strains and their accumulated length.

# %%
gmsh.initialize(["", "-v", "1"], readConfigFiles=False, interruptible=False)
disk = gmsh.model.occ.addDisk(0.0, 0.0, 0.0, 0.5 * d, 0.5 * d)
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(2, [disk])
gmsh.option.setNumber("Mesh.MeshSizeMax", d / 6.0)
gmsh.model.mesh.generate(2)
gmsh.model.mesh.setOrder(2)
domain = mesh_from_gmsh(gmsh.model, MPI.COMM_SELF, gdim=2)[0]
gmsh.finalize()
V = fem.functionspace(domain, ("Lagrange", 2, (3,)))
points, weights = basix.make_quadrature(basix.CellType.triangle, 2)
at_points = basix.ufl.quadrature_element("triangle", value_shape=(7,), points=points, weights=weights)
S = fem.functionspace(domain, at_points)
u, state = fem.Function(V), fem.Function(S)
rise = fem.Function(fem.functionspace(domain, ("DG", 0)))  # h, the same everywhere
rise.x.array[:] = h0 = pitch / 2.0 / np.pi
dx = ufl.dx(domain=domain, metadata={"quadrature_degree": 2})

# %% [markdown]
# ## Strain and law
#
# The deformation gradient is $F = \hat F \hat F_0^{-1}$ and $E = ½ (F^T F - 1)$. Plastic strains are subtracted from
# it, and the stress returns along the radius to von Mises's yield surface. That is exact enough while strains are
# small; rotations may be large.


# %%
def tangents(x, h):
    """The columns of F̂."""
    return ufl.as_matrix([[x[i].dx(0), x[i].dx(1), (-x[1], x[0], h)[i]] for i in range(3)])


R, slope = 0.5 * D, np.arctan(2.0 * h0 / D)
wire, upward = (ufl.as_vector([0.0, *a]) for a in ((np.cos(slope), np.sin(slope)), (-np.sin(slope), np.cos(slope))))
ξ, η = ufl.SpatialCoordinate(domain)
start = ufl.as_vector([R + ξ, 0.0, 0.0]) + η * upward
inverse, volume = ufl.inv(tangents(start, h0)), abs(ufl.det(tangents(start, h0)))
F = tangents(start + u, rise) * inverse
places = [[0, 3, 4], [3, 1, 5], [4, 5, 2]]
plastic = ufl.as_matrix([[state[k] for k in row] for row in places])
elastic = 0.5 * (F.T * F - ufl.Identity(3)) - plastic
trial = 2.0 * G * ufl.dev(elastic)
equivalent = ufl.sqrt(1.5 * ufl.inner(trial, trial) + 1e-12)
added = ufl.max_value(equivalent - yield_stress - H * state[6], 0.0) / (3.0 * G + H)  # plastic strain of the step
flow = ufl.variable(1.5 * added / equivalent * trial)
stress = 2.0 * G * (ufl.dev(elastic) - flow) + bulk * ufl.tr(elastic) * ufl.Identity(3)

# %% [markdown]
# ## Virtual work
#
# Per radian: of a change $v$ of the section, and of a change of the rise, which is the axial force. UFL differentiates
# the first for both, through the law.

# %%
strain_change = ufl.sym(F.T * tangents(ufl.TestFunction(V), 0.0) * inverse)
work = ufl.inner(stress, strain_change) * volume * dx
residual, tangent = fem.form(work), fem.form(ufl.derivative(work, u))
column = fem.form(ufl.derivative(work, rise, fem.Constant(domain, 1.0)))
lift = ufl.as_matrix(np.diag([0.0, 0.0, 1.0]).tolist())  # ∂F̂/∂h
pull = fem.form(ufl.inner(stress, ufl.sym(F.T * lift * inverse)) * volume * dx)
pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
new_state = fem.Expression(state + ufl.as_vector([*(flow[i, j] for i, j in pairs), added]), points)
middle = int(np.argmin(np.linalg.norm(V.tabulate_dof_coordinates(), axis=1)))
free = np.setdiff1d(np.arange(len(u.x.array)), 3 * middle + np.array([1, 2]))  # no rise, no turn as a whole
cells = np.arange(domain.topology.index_map(2).size_local, dtype=np.int32)


def step(shortening):
    """Shorten the spring to so many mm; its force in N."""
    h = h0 - shortening / turns / 2.0 / np.pi
    lead = fem.assemble_vector(column).array * (h - rise.x.array[0])
    for _iteration in range(25):
        K, r = fem.assemble_matrix(tangent).to_scipy().tocsc(), fem.assemble_vector(residual).array + lead
        u.x.array[free] -= scipy.sparse.linalg.spsolve(K[free][:, free], r[free])
        rise.x.array[:], lead = h, 0.0
        if np.abs(fem.assemble_vector(residual).array).max() < 1e-7 * yield_stress * d**2:
            break
    else:
        raise RuntimeError("no equilibrium")
    state.x.array.reshape(-1, 7)[S.dofmap.list.ravel()] = new_state.eval(domain, cells).reshape(-1, 7)
    return -fem.assemble_scalar(pull)


# %% [markdown]
# ## Press and release
#
# Ten steps to nine tenths of the way to block, two back, and secants to zero force; then the same by coilset.

# %%
deepest = 0.9 * turns * (pitch - d)
way = [0.0, *np.linspace(0.0, deepest, 11)[1:], 0.8 * deepest, 0.7 * deepest]
force = [0.0, *(step(one_way) for one_way in way[1:])]
while abs(force[-1]) > 1e-5 * max(force):
    way.append(way[-1] - force[-1] * (way[-1] - way[-2]) / (force[-1] - force[-2]))
    force.append(step(way[-1]))
spring = {"wire_diameter": d, "mean_diameter": D, "turns": turns, "pitch": pitch}
loading = [{"to": {"travel": deepest}, "steps": 10}, {"to": {"force": 0}, "steps": 4}]
theirs = slice_(Case({"spring": spring, "material": "linear_isotropic", "ends": "clamped", "loading": loading}))
print(f"{force[10]:.2f} N, coilset {theirs.force[9]:.2f} N; set {way[-1]:.3f} mm, coilset {theirs.set:.3f} mm")
assert abs(force[10] / theirs.force[9] - 1.0) < 1e-3
assert abs(way[-1] / theirs.set - 1.0) < 3e-4

# %% [markdown]
# ## Residual stress
#
# The shear about the wire's axis, at the points of the section: what the outer fibres keep, the core balances.

# %%
about = (ξ * ufl.dot(wire, stress * upward) - η * ufl.dot(wire, stress)[0]) / ufl.sqrt(ξ**2 + η**2)
residual_shear = fem.Expression(about, points).eval(domain, cells).ravel()
place = fem.Expression(ufl.as_vector([ξ, η]), points).eval(domain, cells).reshape(-1, 2)
figure = matplotlib.figure.Figure(figsize=(8.0, 3.4), layout="constrained")
left, right = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
left.plot(way, force, "o-", ms=4, label="this script")
left.plot([0.0, *theirs.travel], [0.0, *theirs.force], "k+", label="coilset's slice")
left.set(xlabel="travel, mm", ylabel="force, N", title=f"{turns:g} turns pressed and released")
left.legend()
limit = 50.0 * np.ceil(np.abs(residual_shear).max() / 50.0)
shown = right.tricontourf(*place.T, residual_shear, levels=np.linspace(-limit, limit, 17), cmap="RdBu_r")
figure.colorbar(shown, ax=right, label="shear about the wire's axis, MPa")
right.set(aspect="equal", xlabel="outward ξ, mm", ylabel="upward η, mm", title="what stays after release")
