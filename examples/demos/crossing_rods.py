# %% [markdown]
# # Contact of two rods
#
# Two cantilevers of round wire cross above each other. The upper one is pressed down at its tip, closes the gap and
# takes the lower one along. Rods touch at the points of their centre lines that are closest to each other; where these
# are changes as the rods slide. The contact force is found by an augmented Lagrangian, so that the rods do not
# penetrate. For small deflections, Timoshenko's beam theory gives the answer in closed form.

# %%
import basix.ufl
import matplotlib.figure
import numpy as np
import scipy.sparse.linalg
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

E, G, r, gap = 206e3, 79.3e3, 2.0, 0.03  # MPa, MPa; wire radius and the free space between the wires, mm
elements, crossing, lower_part = 10, 60.0, 50.0  # of each rod; mm along the rods to the crossing
along = np.array([np.cos(1.22), np.sin(1.22), 0.0])
upper = np.array([[0.0, 0.0, 2.0 * r + gap], [100.0, 0.0, 2.0 * r + gap]])  # clamped end, tip, mm
lower = np.array([[crossing, 0.0, 0.0] - lower_part * along, [crossing, 0.0, 0.0] + 30.0 * along])

# %% [markdown]
# ## Two rods in one mesh
#
# Unknowns are the displacement and the rotation of the section, both quadratic; with two Gauss points an element,
# shear does not lock.

# %%
part, ends = np.linspace(0.0, 1.0, elements + 1)[:, None], np.arange(elements)[:, None] + np.array([0, 1])
nodes = np.concatenate([a + part * (b - a) for a, b in (upper, lower)])
cells = np.concatenate([ends, ends + elements + 1])
line = basix.ufl.element("Lagrange", "interval", 1, shape=(3,))
domain = mesh.create_mesh(MPI.COMM_SELF, cells, nodes, ufl.Mesh(line))
V = fem.functionspace(domain, basix.ufl.element("Lagrange", "interval", 2, shape=(6,)))


def strains(a):
    """Axial strain, shear strains, twist, curvatures; vectors are those of space."""
    slope, turn = ufl.dot(ufl.grad(a), t), ufl.as_vector([a[3], a[4], a[5]])
    γ, κ = (
        ufl.as_vector([slope[k] for k in range(3)]) + ufl.cross(t, turn),
        ufl.as_vector([slope[k] for k in (3, 4, 5)]),
    )
    return ufl.dot(γ, t), γ - ufl.dot(γ, t) * t, ufl.dot(κ, t), κ - ufl.dot(κ, t) * t


J = ufl.Jacobian(domain)[:, 0]
t = J / ufl.sqrt(ufl.dot(J, J))
A, I = np.pi * r**2, np.pi * r**4 / 4.0
test, trial = strains(ufl.TestFunction(V)), strains(ufl.TrialFunction(V))
stiffness = zip((E * A, G * A, 2.0 * G * I, E * I), test, trial, strict=True)
energy = sum(k * ufl.inner(a, b) for k, a, b in stiffness) * ufl.dx(metadata={"quadrature_degree": 3})
K = fem.assemble_matrix(fem.form(energy)).to_scipy().tocsr()

# %% [markdown]
# ## The closest points
#
# A rod's displacement at a coordinate $s$ is a row of shape functions times the unknowns, and so is its derivative.
# Newton's method finds where $x_1 - x_2$ is normal to both rods.

# %%
places = V.tabulate_dof_coordinates()


class Line:
    """The deformed centre line of a rod: quadratic pieces."""

    def __init__(self, start, end):
        self.start, self.length = start, np.linalg.norm(end - start)
        self.direction = (end - start) / self.length
        s = (places - start) @ self.direction
        on = np.flatnonzero(np.linalg.norm(places - start - s[:, None] * self.direction, axis=1) < 1e-9)
        self.dofs = on[np.argsort(s[on])]  # ends and middles of the elements in turn

    def shape(self, s):
        """The three points that carry the displacement at s; their shape functions and two derivatives."""
        size = self.length / elements
        k = min(max(int(s / size), 0), elements - 1)
        ξ = s / size - k
        N = [(1 - ξ) * (1 - 2 * ξ), 4 * ξ * (1 - ξ), ξ * (2 * ξ - 1)], [4 * ξ - 3, 4 - 8 * ξ, 4 * ξ - 1], [4, -8, 4]
        return self.dofs[2 * k : 2 * k + 3], np.array(N) / size ** np.arange(3)[:, None]

    def at(self, s, q):
        """Position and its two derivatives."""
        dofs, N = self.shape(s)
        return N @ q.reshape(-1, 6)[dofs, :3] + [self.start + s * self.direction, self.direction, np.zeros(3)]


lines, s = [Line(*upper), Line(*lower)], np.array([crossing, lower_part])


def closest(q):
    """Both points, their coordinates s found from those of the last call."""
    for _iteration in range(20):
        (x, dx, ddx), (y, dy, ddy) = (one.at(at, q) for one, at in zip(lines, s, strict=True))
        f = np.array([(x - y) @ dx, (y - x) @ dy])
        if np.abs(f).max() < 1e-11:
            return x, y
        H = np.array([[dx @ dx + (x - y) @ ddx, -dx @ dy], [-dx @ dy, dy @ dy + (y - x) @ ddy]])
        s[:] -= np.linalg.solve(H, f)
    raise RuntimeError("no closest points")


# %% [markdown]
# ## Equilibrium
#
# The gap is $g = |x_1 - x_2| - 2r$, and its gradient in the unknowns is the normal times the shape functions: the
# coordinates of the closest points do not contribute. The force is $\max(λ - c g, 0)$, and λ takes its value until
# nothing penetrates.

# %%
penalty = 2000.0  # c, N/mm
clamped = [np.argmin(np.linalg.norm(places - rod[0], axis=1)) for rod in (upper, lower)]
tip = 6 * int(np.argmin(np.linalg.norm(places - upper[1], axis=1))) + 2
free = np.setdiff1d(np.arange(len(places) * 6), [*(6 * node + k for node in clamped for k in range(6)), tip])
q, λ = np.zeros(len(places) * 6), 0.0


def contact(q):
    """The gap and its gradient."""
    x, y = closest(q)
    distance, b = np.linalg.norm(x - y), np.zeros((len(places), 6))
    for sign, one, at in zip((1.0, -1.0), lines, s, strict=True):
        dofs, N = one.shape(at)
        b[dofs, :3] += sign * N[0][:, None] * (x - y) / distance
    return distance - 2.0 * r, b.ravel()


def step(deflection):
    """Press the tip down to a deflection, mm; the forces at the tip and of the contact, N."""
    global λ
    q[tip] = -deflection
    for _iteration in range(60):
        g, b = contact(q)
        force = max(λ - penalty * g, 0.0)
        out = K @ q - force * b
        if np.abs(out[free]).max() <= 1e-9 * np.abs(out).max():
            if abs(force - λ) < 1e-7 * max(force, 1.0):
                return -out[tip], force
            λ = force
            continue
        matrix = K + penalty * (force > 0.0) * scipy.sparse.csr_array(np.outer(b, b))
        q[free] -= scipy.sparse.linalg.spsolve(matrix[free][:, free].tocsc(), out[free])
    raise RuntimeError("no equilibrium")


way = np.linspace(0.0, 0.2, 21)
found = np.array([step(one) for one in way])

# %% [markdown]
# ## Closed form
#
# A cantilever that is loaded at $a$ gives way at $b ≥ a$ by $a^2 (3b - a) / 6EI + a / GA$ per newton. The tip's force
# $F$ and the contact's $P$ follow from the tip's deflection and from the gap, which is used up. Rods that tilt touch at
# other points, which this leaves out: the difference, 3e-4 here, is 3e-3 with ten times the gap and deflection.


# %%
def flexibility(a, b):
    """Deflection at b of a unit force at a ≤ b, mm/N."""
    return a**2 * (3.0 * b - a) / (6.0 * E * I) + a / (G * A)


f = [flexibility(a, b) for a, b in ((100.0, 100.0), (crossing, 100.0), (crossing, crossing), (lower_part, lower_part))]
together = np.linalg.inv([[f[0], -f[1]], [f[1], -f[2] - f[3]]]) @ np.stack([way, np.full(len(way), gap)])
alone = np.stack([way / f[0], 0.0 * way])
exact = np.where(together[1] > 0.0, together, alone).T
worst = np.abs(found - exact).max() / exact.max()
print(f"tip {found[-1, 0]:.4f} N, contact {found[-1, 1]:.4f} N; closed form {exact[-1, 0]:.4f}, {exact[-1, 1]:.4f} N")
assert found[-1, 1] > 2.0
assert worst < 5e-4

# %%
figure = matplotlib.figure.Figure(figsize=(8.0, 3.6), layout="constrained")
left, right = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2, projection="3d")
for column, (style, name) in enumerate((("C0o", "tip"), ("C1s", "contact"))):
    left.plot(way, found[:, column], style, ms=4, mfc="none", label=f"{name}, finite elements")
    left.plot(way, exact[:, column], style[:2], lw=1.0, label=f"{name}, closed form")
left.set(
    xticks=way[::5], xlabel="deflection of the tip, mm", ylabel="force, N", title="Gap closes, then both rods carry"
)
left.legend()
for one, colour in zip(lines, ("C0", "C1"), strict=True):
    right.plot(*np.array([one.at(at, q)[0] for at in np.linspace(0.0, one.length, 41)]).T, colour, lw=4.0)
right.plot(*np.array(closest(q)).T, "k.-", ms=5)
right.set(xlabel="x, mm", ylabel="y, mm", title="the closest points at the end (z magnified)", zlabel="z, mm")
right.view_init(elev=18.0, azim=-65.0)
