# %% [markdown]
# # A plastic Timoshenko rod with section points, in UFL
#
# A rod that yields, in a hundred lines of DOLFINx and nothing else: the section is a set of points, each with a stress
# and a plastic strain of its own, and the whole of it is one UFL form that is differentiated by UFL. A cantilever of
# round wire is bent far past yield and released. At the end coilset computes the same bar, with another element,
# another law (three stresses) and compiled loops.
#
# With the deflection $w$, the axial displacement $u$ and the rotation $θ$ of the section, a fibre at the height $y$ has
# $ε = u' - y θ'$, and the shear strain is $γ = w' - θ$.

# %%
import basix
import basix.ufl
import matplotlib as mpl
import matplotlib.figure
import numpy as np
import scipy.sparse.linalg
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

length, radius, elements = 100.0, 2.5, 32  # mm
E, G, H, yield_stress = 210e3, 80769.0, 2000.0, 40.0  # MPa, H: slope of stress over plastic strain

# %% [markdown]
# ## The section
#
# Gauss's rule for $\int_{-r}^{r} f(y)\, 2\sqrt{r^2 - y^2}\, dy$ (Chebyshev polynomials of the second kind) has its
# points at $r \cos(kπ/(n + 1))$, with weights proportional to the squared sines.

# %%
layers = 12
angle = np.pi * np.arange(1, layers + 1) / (layers + 1)
y, area = radius * np.cos(angle), np.pi * radius**2 * 2.0 / (layers + 1) * np.sin(angle) ** 2
assert np.isclose((area * y**2).sum(), np.pi * radius**4 / 4.0)  # I of a circle

# %% [markdown]
# ## Rod and state
#
# All three unknowns are quadratic, with two Gauss points an element: shear does not lock. The plastic strains of all
# layers are one vector-valued coefficient at these points.

# %%
domain = mesh.create_interval(MPI.COMM_SELF, elements, [0.0, length])
V = fem.functionspace(domain, basix.ufl.element("Lagrange", "interval", 2, shape=(3,)))
points, weights = basix.make_quadrature(basix.CellType.interval, 3)
at_points = basix.ufl.quadrature_element("interval", value_shape=(layers,), points=points, weights=weights)
S = fem.functionspace(domain, at_points)
unknown, plastic = fem.Function(V), fem.Function(S)
dx = ufl.dx(domain=domain, metadata={"quadrature_degree": 3})

# %% [markdown]
# ## The law, and the virtual work
#
# Linear kinematic hardening: the trial stress is reduced by what it exceeds the yield stress by. `ufl.derivative`
# differentiates through the `max`, which gives the consistent tangent.


# %%
def plastic_increment(strain, k):
    """Of the layer k; its back stress is H times the plastic strain."""
    relative = E * (strain - plastic[k]) - H * plastic[k]
    return ufl.sign(relative) * ufl.max_value(abs(relative) - yield_stress, 0.0) / (E + H)


u, w, θ = ufl.split(unknown)
fibres = [u.dx(0) - float(y[k]) * θ.dx(0) for k in range(layers)]
added = [plastic_increment(fibres[k], k) for k in range(layers)]
stress = [E * (fibres[k] - plastic[k] - added[k]) for k in range(layers)]
normal = sum(float(area[k]) * stress[k] for k in range(layers))
moment = sum(-float(area[k] * y[k]) * stress[k] for k in range(layers))
shear = G * np.pi * radius**2 * (w.dx(0) - θ)
δu, δw, δθ = ufl.TestFunctions(V)
work = (normal * δu.dx(0) + moment * δθ.dx(0) + shear * (δw.dx(0) - δθ)) * dx
residual, tangent = fem.form(work), fem.form(ufl.derivative(work, unknown))
new_plastic = fem.Expression(plastic + ufl.as_vector(added), points)

# %% [markdown]
# ## Steps
#
# Newton's method for the tip's deflection. The plastic strains are updated once a step has converged: a failed step
# would leave no trace.

# %%
left, right = (fem.locate_dofs_geometrical(V, lambda x, at=at: np.isclose(x[0], at)) for at in (0.0, length))
clamped, tip = 3 * int(left[0]) + np.arange(3), 3 * int(right[0]) + 1
free = np.setdiff1d(np.arange(len(unknown.x.array)), [*clamped, tip])
cells = np.arange(elements, dtype=np.int32)


def step(deflection):
    """Move the tip, in mm; its force in N."""
    values = unknown.x.array
    change = np.zeros_like(values)
    change[tip] = deflection - values[tip]
    for _iteration in range(20):
        K = fem.assemble_matrix(tangent).to_scipy().tocsc()
        r = fem.assemble_vector(residual).array + K @ change
        change[free] -= scipy.sparse.linalg.spsolve(K[free][:, free], r[free])
        values += change
        change[:] = 0.0
        forces = fem.assemble_vector(residual).array
        if np.abs(forces[free]).max() < 1e-9 * np.abs(forces).max():
            break
    else:
        raise RuntimeError("no equilibrium")
    plastic.x.array.reshape(-1, layers)[S.dofmap.list.ravel()] = new_plastic.eval(domain, cells).reshape(-1, layers)
    return forces[tip]


way = np.concatenate([np.linspace(0.0, 0.6, 13)[1:], np.linspace(0.6, 0.3, 7)[1:]])
found = np.array([step(deflection) for deflection in way])

# %% [markdown]
# ## coilset's bar
#
# The same bar, section points and steps. coilset's rod has large rotations and a law of three stresses: at this
# deflection of 0.6 % of the length both change the force by less than 1e-4.

# %%
from coilset.model.material import library  # noqa: E402
from coilset.model.material.law.file import MaterialFile  # noqa: E402
from coilset.model.material.law.law import Law  # noqa: E402
from coilset.model.section.rules import DiskRule  # noqa: E402
from coilset.verification.chain import ALL, Y, chain, straight  # noqa: E402

data = library.load("linear_kinematic").data.model_dump()
k0 = 2.0 / 3.0 * yield_stress**2  # k² of the deviator
ζ = 2.0 / 3.0 * H
constants = {
    "elasticity": {"G": G, "nu": E / 2.0 / G - 1.0},
    "isotropic": {"k0_squared": k0},
    "kinematic": {"a5": 1.0, "a6": ζ / np.sqrt(6.0 * k0), "a7": 0.0},
}
data["temperatures"] = [data["temperatures"][0] | constants]
aside = np.sqrt((1.0 - (y / radius) ** 2) / 3.0)  # two points a layer, so that the bar is stiff in all directions
both = np.concatenate([np.stack([y / radius, z], axis=1) for z in (aside, -aside)])
rule = DiskRule(both, np.tile(0.5 * area / area.sum(), 2), "layers")
bar = chain(straight(length, elements), radius, Law(MaterialFile.model_validate(data)), rule, [(0, ALL)])
theirs, before = [], 0.0
for deflection in way:
    assert bar.step({bar.dof(elements, Y): deflection - before}).converged
    theirs.append(bar.force(bar.dof(elements, Y)))
    before = deflection
theirs = np.array(theirs)
elastic = 3.0 * E * np.pi * radius**4 / 4.0 / length**3 * way[11]
worst = np.abs(found - theirs).max()
print(
    f"{found[11]:.3f} N at {way[11]:g} mm, coilset {theirs[11]:.3f} N; {elastic:.1f} N without yield; {worst:.1e} N off"
)
assert found[11] < 0.9 * elastic
assert worst < 3e-4 * found[11]

# %%
with mpl.rc_context({"font.size": 9}):
    figure = mpl.figure.Figure(figsize=(5.0, 3.4), layout="constrained")
    axes = figure.subplots()
    axes.plot([0.0, *way], [0.0, *found], "o-", ms=4, label="UFL, section points")
    axes.plot([0.0, *way], [0.0, *theirs], "k+", label="coilset")
    axes.set(xlabel="deflection of the tip, mm", ylabel="force, N", title="A cantilever bent past yield and released")
    axes.grid(lw=0.3)
    axes.legend()
