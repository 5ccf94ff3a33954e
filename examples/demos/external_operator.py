# %% [markdown]
# # A rod's law by an external operator
#
# Where a law cannot be written in UFL, the form gets a coefficient in its place, whose values and derivatives a
# function computes at the quadrature points. This is the idea of `dolfinx-external-operator` (A. Latyshev, J. Bleyer,
# C. Maurini and J. S. Hale): the function gets the operands of all points in one array and returns values or
# derivatives. Here it is written out in thirty lines, and the function is coilset's law of a material with several back
# stresses (Chaboche).
#
# The bar is a thin tube that is stretched, twisted and twisted back. It deforms evenly, so that the point's own
# testing machine (`coilset material test`) must give the same stresses.

# %%
import basix
import basix.ufl
import matplotlib.figure
import numpy as np
import scipy.sparse.linalg
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from coilset.model.core.material import library
from coilset.model.core.material.point.points import initial_state, update
from coilset.model.tools.identification.programs import Program
from coilset.model.tools.identification.programs import run as run_program

length, radius, elements = 50.0, 10.0, 6  # mm
law = library.load("chaboche")

# %% [markdown]
# ## The operator
#
# Operands are ε11, γ12, γ13 at all points. Stress and tangent are coefficients of the form; the state at the last
# equilibrium is kept beside them and replaced only by `commit`.


# %%
class StressOperator:
    """Stress of a strain, given at quadrature points, by a function of all points at once."""

    def __init__(self, domain, strain, function):
        points, weights = basix.make_quadrature(basix.CellType.interval, 2)

        def coefficient(shape):
            element = basix.ufl.quadrature_element("interval", value_shape=shape, points=points, weights=weights)
            return fem.Function(fem.functionspace(domain, element))

        self.strain, self.function = fem.Expression(strain, points), function
        self.value, self.derivative = coefficient((3,)), coefficient((3, 3))
        self.domain, self.cells = domain, np.arange(elements, dtype=np.int32)

    def evaluate(self):
        """Compute value and derivative where the operands are now."""
        operands = self.strain.eval(self.domain, self.cells).reshape(-1, 3)
        for derivatives, coefficient in (((0,), self.value), ((1,), self.derivative)):
            found = self.function(derivatives)(operands)
            places = coefficient.function_space.dofmap.list.ravel()
            coefficient.x.array.reshape(len(places), -1)[places] = found.reshape(len(places), -1)


class Points:
    """coilset's law in that convention: `points(derivatives)` is a function of the operands."""

    def __init__(self, count):
        self.state, self.old = initial_state(law, count), np.zeros((count, 3))

    def __call__(self, derivatives):
        """The function for values, (0,), or derivatives, (1,)."""
        return lambda strain: update(law, self.state, strain - self.old)[derivatives[0]].reshape(len(strain), -1)[
            :, : 9 if derivatives[0] else 3
        ]

    def commit(self, strain):
        """Make the state at the strain that of the last equilibrium."""
        self.state, self.old = update(law, self.state, strain - self.old)[0], strain.copy()


# %% [markdown]
# ## The bar
#
# Unknowns are the axial displacement u and the twist φ; ε11 = u′, γ12 = r φ′.

# %%
domain = mesh.create_interval(MPI.COMM_SELF, elements, [0.0, length])
V = fem.functionspace(domain, basix.ufl.element("Lagrange", "interval", 1, shape=(2,)))
unknown, test, trial = fem.Function(V), ufl.TestFunction(V), ufl.TrialFunction(V)


def strain(v):
    """ε11, γ12, γ13."""
    return ufl.as_vector([v[0].dx(0), radius * v[1].dx(0), 0.0])


points = Points(2 * elements)
operator = StressOperator(domain, strain(unknown), points)
dx = ufl.dx(metadata={"quadrature_degree": 2})
residual = fem.form(ufl.inner(operator.value, strain(test)) * dx)
tangent = fem.form(ufl.inner(ufl.dot(operator.derivative, strain(trial)), strain(test)) * dx)
left, right = (fem.locate_dofs_geometrical(V, lambda x, at=at: np.isclose(x[0], at)) for at in (0.0, length))
held, driven = 2 * int(left[0]) + np.arange(2), 2 * int(right[0]) + np.arange(2)
free = np.setdiff1d(np.arange(len(unknown.x.array)), [*held, *driven])


def step(stretch, shear):
    """Bring the ends to a strain and a shear angle; the stresses σ11 and τ12."""
    values = unknown.x.array
    change = np.zeros_like(values)
    change[driven] = np.array([stretch * length, shear / radius * length]) - values[driven]
    for _iteration in range(20):
        operator.evaluate()
        K, r = fem.assemble_matrix(tangent).to_scipy().tocsc(), fem.assemble_vector(residual).array
        if not change.any() and np.abs(r[free]).max() < 1e-9 * np.abs(r).max():
            points.commit(operator.strain.eval(domain, operator.cells).reshape(-1, 3))
            return operator.value.x.array[:2].copy()
        change[free] -= scipy.sparse.linalg.spsolve(K[free][:, free], (r + K @ change)[free])
        values += change
        change[:] = 0.0
    raise RuntimeError("no equilibrium")


ends, count = [(0.004, 0.0), (0.004, 0.01), (0.004, -0.01)], 20
way = np.concatenate([np.linspace(a, b, count + 1)[1:] for a, b in zip([(0.0, 0.0), *ends[:-1]], ends, strict=True)])
found = np.array([step(*to) for to in way])

# %% [markdown]
# ## The same by the testing machine

# %%
program = [{"to": {"eps11": a, "gamma12": b, "gamma13": 0.0}, "increments": count} for a, b in ends]
theirs = run_program(law, Program.model_validate({"name": "tube", "steps": program})).stress[1:, :2]
worst = np.abs(found - theirs).max()
print(f"greatest difference {worst:.1e} MPa of {np.abs(theirs).max():.0f} MPa")
assert worst < 1e-7 * np.abs(theirs).max()
assert np.ptp(found[count:, 0]) > 10.0  # the axial stress falls as the tube is twisted

# %%
figure = matplotlib.figure.Figure(figsize=(5.0, 3.4), layout="constrained")
axes = figure.subplots()
axes.plot(found[:, 1], found[:, 0], "-", label="external operator")
axes.plot(theirs[::4, 1], theirs[::4, 0], "k+", label="point in the testing machine")
axes.set(xlabel="shear stress, MPa", ylabel="axial stress, MPa", title="A tube stretched, twisted and twisted back")
axes.grid(lw=0.3)
axes.legend()
