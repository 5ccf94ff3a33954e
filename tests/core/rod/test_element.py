"""One straight rod against closed solutions, a hand-written Table 5.2, and its own derivative."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.matrix import TangentMatrix
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.material import library
from coilset.model.core.rod.elements import MIXED, THESIS

LENGTH, RADIUS = 80.0, 2.5
SEATS = np.zeros(12)
AREA, INERTIA = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0  # the rods of these tests lie across the global frame


@pytest.fixture
def thesis(make_rod):
    return make_rod([[1.0, 2.0, 3.0], np.array([1.0, 2.0, 3.0]) + LENGTH * AXIS], RADIUS)


@pytest.fixture(params=[THESIS, MIXED], ids=lambda element: element.name)
def rod(make_rod, request):
    return make_rod([[1.0, 2.0, 3.0], np.array([1.0, 2.0, 3.0]) + LENGTH * AXIS], RADIUS, element=request.param)


def put(rod, u1=0, t1=0, u2=0, t2=0, shear=(0, 0), modes=0):
    """Set the increments of both nodes (local triad) and the own unknowns; returns the section resultants."""
    E = rod.E0[0]
    values = rod.increment.x.array
    for node, (u, turn) in enumerate(((u1, t1), (u2, t2))):
        values[rod.numbering.u[node]] = E @ (np.zeros(3) + u)
        values[rod.numbering.rotations[node]] = E @ (np.zeros(3) + turn)
    values[rod.numbering.own[0, :2]], values[rod.numbering.own[0, 2:]] = shear, modes
    assert rod.update()
    return rod.coefficients.s[0]


def test_finite_rigid_motion_leaves_no_stress(rod):
    """Turned by 2 rad about a skew axis and shifted by 100 mm: stress of rounding only (E times 1e-16, with room)."""
    turn = np.array([0.4, -1.6, 1.1])
    E = rod.E0[0]
    R = Rotation.from_rotvec(E @ turn).as_matrix()
    shift, chord = E @ np.array([100.0, -20.0, 7.0]), LENGTH * AXIS
    put(rod, E.T @ shift, turn, E.T @ (shift + R @ chord - chord), turn)
    assert np.abs(rod.point_state).max() < 1e-9


@pytest.mark.parametrize(
    ("motion", "component", "expected"),
    [
        # logarithmic strain 1e-6: N = E A ε
        ({"u2": [LENGTH * np.expm1(1e-6), 0, 0]}, 0, lambda m: m.E * AREA * 1e-6),
        ({"t1": [-2e-5, 0, 0], "t2": [2e-5, 0, 0]}, 3, lambda m: m.G * 2 * INERTIA * 4e-5 / LENGTH),
        ({"t1": [0, -3e-5, 0], "t2": [0, 3e-5, 0]}, 4, lambda m: m.E * INERTIA * 6e-5 / LENGTH),
        ({"t1": [0, 0, -3e-5], "t2": [0, 0, 3e-5]}, 5, lambda m: m.E * INERTIA * 6e-5 / LENGTH),
        ({"shear": (0, 2e-5)}, 1, lambda m: m.G * AREA * 2e-5),
        ({"shear": (2e-5, 0)}, 2, lambda m: -m.G * AREA * 2e-5),
    ],
    ids=["tension", "torsion", "bending y", "bending z", "shear y", "shear z"],
)
def test_elementary_states_are_exact(rod, ck15, motion, component, expected):
    """Closed solutions of the straight rod; the mean over the sections, for shear bends them oppositely."""
    s = put(rod, **motion).mean(axis=0)
    assert s[component] == pytest.approx(expected(ck15), rel=1e-10)


def test_timoshenko_cantilever_is_exact_with_one_element(rod, ck15):
    """Tip load F: w = F l³/(3 E I) + F l/(G A), no shear factor; linear solve, so exact to rounding."""
    layout = LineLayout(rod)
    fixed = {int(dof): 0.0 for dof in (*layout.station_dofs[0], *layout.seat_dofs)}
    direction, load, tip = rod.E0[0][:, 1], 0.7, layout.station_dofs[1, :3]
    forces = {int(dof): load * d for dof, d in zip(tip, direction, strict=True)}
    F, A = linearise(System(rod, layout, (), SEATS), np.zeros(layout.size), Load.of(layout, fixed, forces))
    w = direction @ np.linalg.solve(A, -F)[tip]
    assert w == pytest.approx(load * LENGTH**3 / (3 * ck15.E * INERTIA) + load * LENGTH / (ck15.G * AREA), rel=1e-10)


def free_system(rod):
    """A rod with nothing held or loaded."""
    return System(rod, LineLayout(rod), (), SEATS)


def linearise(system, values, load=None):
    """Residual and tangent at increments, dense."""
    load = load or Load.of(system.layout, {}, {})
    X, matrix = system.layout.vector(np.array(values, float)), TangentMatrix(system.body, system.layout)
    system.tangent(X, load, matrix)
    n = system.layout.size
    return forces(system, values, load), matrix.mat.getValues(range(n), range(n))


def forces(system, values, load=None):
    """Residual at increments."""
    X, F = system.layout.vector(np.array(values, float)), system.layout.vector()
    system.residual(X, load or Load.of(system.layout, {}, {}), 1.0, F)
    return F.array.copy()


def table_5_2(l, x, y, z):
    """Linear strain-displacement matrix of Table 5.2 by hand, from (5.2.4): rows ε11, γ12, γ13; columns u1 … u14."""
    xi = x / l
    H1, H3 = (12 * xi - 6) / l**2, (6 - 12 * xi) / l**2
    H2, H4 = (6 * xi - 4) / l**2, (6 * xi - 2) / l**2
    B = np.zeros((3, 14))
    B[0] = [
        -1 / l,
        -H1 * y,
        -H1 * z,
        0,
        H2 * l * z,
        -H2 * l * y,
        1 / l,
        -H3 * y,
        -H3 * z,
        0,
        H4 * l * z,
        -H4 * l * y,
        (H2 + H4) * l * z,
        -(H2 + H4) * l * y,
    ]
    B[1, [3, 9, 13]] = z / l, -z / l, 1.0
    B[2, [3, 9, 12]] = -y / l, y / l, -1.0
    return B


def test_element_matrix_equals_table_5_2(thesis, ck15):
    """UFL against the table coded by hand and integrated with (5.2.43), which is exact for these polynomials."""
    l, R = LENGTH, RADIUS
    points = [(0, 0, 1 / 6)] + [(a, b, 1 / 24) for a, b in ((R, 0), (-R, 0), (0, R), (0, -R))]
    points += [(a, b, 1 / 6) for a in (R / 2, -R / 2) for b in (R / 2, -R / 2)]
    K = np.zeros((14, 14))
    for x in (0.5 * l * (1 - 1 / np.sqrt(3)), 0.5 * l * (1 + 1 / np.sqrt(3))):
        for y, z, w in points:
            B = table_5_2(l, x, y, z)
            K += 0.5 * l * np.pi * R**2 * w * B.T @ np.diag([ck15.E, ck15.G, ck15.G]) @ B
    c = 1 / (1 + ck15.G * AREA * l**2 / (12 * ck15.E * INERTIA))  # Timoshenko's Φ/(1 + Φ)
    shears = np.eye(14)  # u13 = excess − ½ c (t1y + t2y), u14 = excess − ½ c (t1z + t2z), t against the chord
    shears[12, [2, 4, 8, 10]] = c / l, -0.5 * c, -c / l, -0.5 * c
    shears[13, [1, 5, 7, 11]] = -c / l, -0.5 * c, c / l, -0.5 * c
    K = shears.T @ K @ shears
    # an elastic element bends of itself as its turns ask: the excess shear angles do not couple with anything
    np.testing.assert_allclose(K[12:, :12], 0, atol=1e-12 * np.abs(K).max())
    system, E = free_system(thesis), thesis.E0[0]
    A = linearise(system, np.zeros(system.layout.size))[1]
    order = [*system.layout.station_dofs[0], *system.layout.station_dofs[1], *thesis.numbering.own[0]]
    to_local = np.zeros((14, 14))
    for block in range(4):
        to_local[3 * block : 3 * block + 3, 3 * block : 3 * block + 3] = E.T
    to_local[12:, 12:] = np.eye(2)
    ours = to_local @ A[np.ix_(order, order)] @ to_local.T
    np.testing.assert_allclose(ours, K, rtol=0, atol=1e-12 * np.abs(K).max())


@pytest.mark.parametrize("state", ["virgin", "plastic", "plastic and reversed"])
def test_element_tangent_has_taylor_slope_two(rod, state):
    """At states without turns against the triad the tangent is exact; the remainder falls with h².

    But for the chart's curvature, T(ψ)ᵀ m = m − ½ ψ × m + …: it goes with the out-of-balance moments m, which vanish at
    equilibrium, and is added here.
    """
    stretch = {"virgin": 0.0, "plastic": 4e-3, "plastic and reversed": -4e-3}[state]
    if state != "virgin":
        put(rod, u2=[4e-3 * LENGTH, 0, 0], shear=(2e-3, -1e-3), modes=5e-4)
        rod.state.commit()
    put(rod, u2=[stretch * LENGTH, 0, 0], shear=(0.3 * stretch, -0.5 * stretch), modes=0.2 * stretch)
    system, base = free_system(rod), np.append(rod.increment.x.array, SEATS)
    size = rod.element.unknowns
    f0, A = linearise(system, base)
    direction = np.append(np.random.default_rng(3).normal(size=size) * np.repeat([1e-2, 1e-4], [12, size - 12]), SEATS)
    steps = np.array([1e-2, 5e-3, 2.5e-3, 1.25e-3])
    linear = A @ direction
    for dofs in rod.numbering.rotations:
        linear[dofs] -= 0.5 * np.cross(direction[dofs], f0[dofs])
    remainder = [np.linalg.norm(forces(system, base + h * direction) - f0 - h * linear) for h in steps]
    slope = np.polyfit(np.log(steps), np.log(remainder), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("element", [THESIS, MIXED], ids=lambda element: element.name)
def test_tangent_is_exact_at_turned_states(make_rod, element):
    """An elastic rod; turns of 0.1 rad against the triad, thrice a spring's at 16 elements a turn.

    The charts' curvature is added as above; it is taken at a step's start, where the chart's tangent is 1. Central
    differences are good to 1e-8 here.
    """
    rng, size = np.random.default_rng(1), element.unknowns
    rod = make_rod([[0, 0, 0], LENGTH * AXIS], law=library.load("elastic"), element=element)
    rod.increment.x.array[:] = 0.1 * rng.normal(size=size)
    rod.update()
    rod.state.commit()
    base, direction = np.zeros(size + len(SEATS)), np.append(rng.normal(size=size), SEATS)
    system, h = free_system(rod), 1e-6
    f0, A = linearise(system, base)
    linear = A @ direction
    for dofs in rod.numbering.rotations:
        linear[dofs] -= 0.5 * np.cross(direction[dofs], f0[dofs])
    exact = (forces(system, base + h * direction) - forces(system, base - h * direction)) / (2 * h)
    np.testing.assert_allclose(linear, exact, rtol=0, atol=1e-7 * np.linalg.norm(exact))


def test_section_forces_of_the_mixed_element_are_in_equilibrium(make_rod):
    """A rod that is bent, twisted and sheared beyond yield: N, Q and Mt constant, M2 and M3 linear with slopes Q.

    That is the equilibrium of a rod without loads between its nodes, at which the thesis's element does not arrive.
    """
    rod = make_rod([[0, 0, 0], LENGTH * AXIS], RADIUS, element=MIXED)
    put(rod, t1=[-0.03, 0.04, 0.01], u2=[0.05, 1.0, -2.0], t2=[0.09, -0.02, 0.05])
    system, layout, values = free_system(rod), LineLayout(rod), np.append(rod.increment.x.array, SEATS)
    held = Load.of(layout, {int(dof): 0.0 for dof in (*layout.station_dofs.ravel(), *layout.seat_dofs)}, {})
    nodes = values.copy()
    for _ in range(20):
        F, A = linearise(system, values)
        own = rod.numbering.own[0]
        values[own] -= np.linalg.solve(A[np.ix_(own, own)], F[own])
    assert (values[held.held] == nodes[held.held]).all()
    s, work = rod.coefficients.s[0], rod.point_state[..., 6]
    assert (work.max(axis=-1) > 0.1).all()
    assert np.ptp(work.max(axis=-1)) > 0.3 * work.max()  # flow concentrates in it
    l = rod.l0[0]  # to which its curvatures refer
    size = np.abs(s).max(axis=0)
    np.testing.assert_allclose(s[:, :4], s[:1, :4].repeat(3, axis=0), rtol=0, atol=1e-8 * size[:4].max())
    np.testing.assert_allclose(s[1, 4:], 0.5 * (s[0, 4:] + s[2, 4:]), rtol=0, atol=1e-8 * size[3:].max())
    np.testing.assert_allclose(s[2, 4:] - s[0, 4:], l * np.array([s[0, 2], -s[0, 1]]), rtol=0, atol=1e-8 * size.max())


def test_increments_do_not_depend_on_the_number_of_steps(make_rod):
    """A turn of 1 rad of a whole elastic rod with a little twist in it, in one step and in five."""
    results = []
    for steps in (1, 5):
        rod = make_rod([[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0]])
        for k in range(1, steps + 1):
            previous, now = (Rotation.from_rotvec([0, 0, (k - j) / steps]) for j in (1, 0))
            twist = [Rotation.from_rotvec([2e-3 * (k - j) / steps, 0, 0]) for j in (1, 0)]
            values = rod.increment.x.array
            values[rod.numbering.u[1]] = now.apply([LENGTH, 0, 0]) - previous.apply([LENGTH, 0, 0])
            values[rod.numbering.rotations[0]] = (now * previous.inv()).as_rotvec()
            values[rod.numbering.rotations[1]] = (now * twist[1] * (previous * twist[0]).inv()).as_rotvec()
            assert rod.update()
            rod.state.commit()
        results.append(rod.coefficients.s.copy())
    # the axial stress of the spin, (5.2.33), is of second order in the twist and summed up by steps: 1e-5 of the torque
    np.testing.assert_allclose(results[1], results[0], rtol=0, atol=2e-5 * np.abs(results[0]).max())
