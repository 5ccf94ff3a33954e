# %% [markdown]
# # A plastic Timoshenko rod with section points, in UFL
#
# The section is a set of points, each with a stress and a plastic strain of its own, and the whole rod is one UFL form
# that UFL differentiates. A cantilever of round wire is bent far past yield and released; at the end coilset computes
# the same bar with another element, another law (three stresses) and compiled loops.
#
# With the deflection $w$, the axial displacement $u$ and the rotation $θ$ of the section, a fibre at the height $y$ has
# $ε = u' - y θ'$, and the shear strain is $γ = w' - θ$.

# %%
import basix.ufl
import matplotlib.figure
import numpy as np
import scipy.sparse.linalg
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from coilset.verification.chain import layered_bar

length, radius, elements, layers = 100.0, 2.5, 32, 12  # mm
E, G, H, yield_stress = 210e3, 80769.0, 2000.0, 40.0  # MPa, H: slope of stress over plastic strain

# %% [markdown]
# ## Section, rod and state
#
# Gauss's rule for $\int_{-r}^{r} f(y)\, 2\sqrt{r^2 - y^2}\, dy$ has its points at $r \cos(kπ/(n + 1))$, with weights
# proportional to the squared sines. The three unknowns are quadratic, with two Gauss points an element: shear does not
# lock. The plastic strains of all layers are one coefficient at these points.

# %%
angle = np.pi * np.arange(1, layers + 1) / (layers + 1)
y, area = radius * np.cos(angle), np.pi * radius**2 * 2.0 / (layers + 1) * np.sin(angle) ** 2
domain = mesh.create_interval(MPI.COMM_SELF, elements, [0.0, length])
V = fem.functionspace(domain, basix.ufl.element("Lagrange", "interval", 2, shape=(3,)))
points, weights = basix.make_quadrature(basix.CellType.interval, 3)
at_points = basix.ufl.quadrature_element("interval", value_shape=(layers,), points=points, weights=weights)
S = fem.functionspace(domain, at_points)
unknown, plastic = fem.Function(V), fem.Function(S)

# %% [markdown]
# ## The law, and the virtual work
#
# Linear kinematic hardening: the trial stress, less the back stress $H ε_p$, is reduced by what it exceeds the yield
# stress by. `ufl.derivative` differentiates through the `max`, which gives the consistent tangent.

# %%
u, w, θ = ufl.split(unknown)
strain = ufl.as_vector([u.dx(0) - height * θ.dx(0) for height in y.tolist()])
relative = [E * strain[k] - (E + H) * plastic[k] for k in range(layers)]
added = [ufl.sign(one) * ufl.max_value(abs(one) - yield_stress, 0.0) / (E + H) for one in relative]
force = [float(area[k]) * E * (strain[k] - plastic[k] - added[k]) for k in range(layers)]
δu, δw, δθ = ufl.TestFunctions(V)
shear = G * np.pi * radius**2 * (w.dx(0) - θ) * (δw.dx(0) - δθ)
work = shear + sum(force[k] * (δu.dx(0) - float(y[k]) * δθ.dx(0)) for k in range(layers))
work = work * ufl.dx(domain=domain, metadata={"quadrature_degree": 3})
residual, tangent = fem.form(work), fem.form(ufl.derivative(work, unknown))
new_plastic = fem.Expression(plastic + ufl.as_vector(added), points)

# %% [markdown]
# ## Steps
#
# Newton's method for the tip's deflection. The plastic strains are updated once a step has converged: a failed step
# would leave no trace.

# %%
left, right = (fem.locate_dofs_geometrical(V, lambda x, at=at: np.isclose(x[0], at)) for at in (0.0, length))
tip = 3 * int(right[0]) + 1
free = np.setdiff1d(np.arange(len(unknown.x.array)), [*(3 * int(left[0]) + np.arange(3)), tip])


def step(deflection):
    """Move the tip, in mm; its force in N."""
    values, change = unknown.x.array, np.zeros(len(unknown.x.array))
    change[tip] = deflection - values[tip]
    for _iteration in range(20):
        K, r = fem.assemble_matrix(tangent).to_scipy().tocsc(), fem.assemble_vector(residual).array
        if not change.any() and np.abs(r[free]).max() < 1e-9 * np.abs(r).max():
            new = new_plastic.eval(domain, np.arange(elements, dtype=np.int32))
            plastic.x.array.reshape(-1, layers)[S.dofmap.list.ravel()] = new.reshape(-1, layers)
            return r[tip]
        change[free] -= scipy.sparse.linalg.spsolve(K[free][:, free], (r + K @ change)[free])
        values += change
        change[:] = 0.0
    raise RuntimeError("no equilibrium")


way = np.concatenate([np.linspace(0.0, 0.6, 13)[1:], np.linspace(0.6, 0.3, 7)[1:]])
found = np.array([step(deflection) for deflection in way])

# %% [markdown]
# ## coilset's bar
#
# The same bar, section points and steps. coilset's rod has large rotations and a law of three stresses: at this
# deflection of 0.6 % of the length both change the force by less than 1e-4.

# %%
theirs = layered_bar(length, radius, elements, y, area, {"E": E, "G": G, "H": H, "yield_stress": yield_stress}, way)
elastic, worst = 3.0 * E * np.pi * radius**4 / 4.0 / length**3 * way[11], np.abs(found - theirs).max()
print(f"{found[11]:.3f} N, coilset {theirs[11]:.3f} N, {elastic:.1f} N without yield; at most {worst:.1e} N apart")
assert found[11] < 0.9 * elastic
assert worst < 3e-4 * found[11]

# %%
figure = matplotlib.figure.Figure(figsize=(5.0, 3.4), layout="constrained")
axes = figure.subplots()
axes.plot([0.0, *way], [0.0, *found], "o-", ms=4, label="UFL, section points")
axes.plot([0.0, *way], [0.0, *theirs], "k+", label="coilset")
axes.set(xlabel="deflection of the tip, mm", ylabel="force, N", title="A cantilever bent past yield and released")
axes.legend()
