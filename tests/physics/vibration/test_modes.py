"""Natural frequencies of rods against closed solutions and the twelve equations of a helix."""

import re

import numpy as np
import pytest

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import check
from coilset.model.core.contact.base import Contribution
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.material import library
from coilset.model.physics.vibration.mass import TONNE
from coilset.model.physics.vibration.modes import _glued, natural_modes
from coilset.model.tools.standards.buckling import critical_travel
from coilset.model.tools.standards.en13906 import natural_frequency
from coilset.model.tools.studies.loaded_spring import _gone_on, after_run, phase_to
from coilset.verification.chain import ALL, X, chain, elastic, straight
from coilset.verification.spring_references.vibrating_helix import HelicalRod

E, NU, DENSITY = 206e3, 0.3, 7.85e-6
G = E / (2.0 * (1.0 + NU))
CK15 = {"wire_diameter": 5.0, "mean_diameter": 40.0}


def clamped(length, radius, elements, law):
    return chain(straight(length, elements), radius, law, held=[(0, ALL), (elements, ALL)])


def spring(turns, pitch, kind="plane", loading=None, **more):
    entries = {"spring": CK15 | {"turns": turns, "pitch": pitch}, "material": "elastic", "ends": "clamped"}
    mesh = {"elements_per_turn": 16, "section": {"kind": kind, "radial": 3, "angular": 8}}
    loading = loading or [{"to": {"travel": 1.0}, "steps": 1}]
    return Analysis(check(entries | {"mesh": mesh, "loading": loading, "accuracy": "none"} | more))


def modes_of(analysis, count, **options):
    load = analysis.control.to_height(analysis.control.height)
    return natural_modes(analysis.system, load, DENSITY, count, **options)


def test_straight_clamped_rod():
    """Axial and torsion are standing half waves; bending follows from the same twelve equations with κ = τ = 0."""
    length, radius, n = 200.0, 2.5, 80
    frame = clamped(length, radius, n, elastic(E, NU))
    found = natural_modes(frame.system, frame.load, DENSITY, 16)
    c = np.sqrt(np.array([E, G]) / (DENSITY * TONNE)) / (2.0 * length)
    axial, torsion = (found.frequencies[np.abs(found.frequencies - one).argmin()] for one in c)
    assert [axial, torsion] == pytest.approx(c, rel=1e-4)
    bending = HelicalRod(2.0 * radius, length, 0.0, 0.0, E, G, DENSITY).frequencies(2, 60.0)
    assert found.frequencies[[0, 2]] == pytest.approx(bending, rel=1e-4)
    slender = np.pi * radius / (2.0 * length) * 4.7300407  # rotary inertia and shear lower the frequency by its square
    euler = 4.7300407**2 / length**2 * 0.5 * radius * np.sqrt(E / (DENSITY * TONNE)) / (2.0 * np.pi)
    assert 1.0 - slender**2 < found.frequencies[0] / euler < 1.0
    mass = DENSITY * np.pi * radius**2 * length
    assert found.total[:3] == pytest.approx(mass, rel=1e-12)


def test_the_error_is_of_second_order_in_the_element():
    """(π h/λ)²/6 of a half wave along the rod, λ = 2 L, for axial and torsion."""
    exact = np.sqrt(E / (DENSITY * TONNE)) / 400.0
    for n in (8, 16):
        frame = clamped(200.0, 2.5, n, elastic(E, NU))
        found = natural_modes(frame.system, frame.load, DENSITY, 16).frequencies
        error = found[np.abs(found - exact).argmin()] / exact - 1.0
        assert error == pytest.approx((np.pi / n) ** 2 / 24.0, rel=0.05)


@pytest.mark.mpi
def test_helical_spring():
    """The first eight frequencies against the twelve equations of the helix; curved sections are stiffer by (d/D)²."""
    for kind, tolerance in (("plane", 2e-4), ("curved", 0.5 * (5.0 / 40.0) ** 2)):
        found = modes_of(spring(4.0, 12.0, kind), 8).frequencies
        law = library.load("elastic")
        helix = HelicalRod.coil(5.0, 40.0, 4.0, 12.0, young=law.E, shear=law.G, density=DENSITY)
        assert found == pytest.approx(helix.frequencies(8, 2.0, 100.0), rel=tolerance)


def test_first_axial_frequency_of_the_standard():
    """Its half wave of an elastic bar holds for many turns of little pitch; found is the mode with most axial mass."""
    turns = 12.0
    found = modes_of(spring(turns, 6.0), 12)
    axial = found.frequencies[found.masses[:, 2].argmax()]
    law = library.load("elastic")
    assert axial == pytest.approx(natural_frequency(law.G, DENSITY, 5.0, 40.0, turns), rel=0.02)


def test_frequency_falls_to_zero_where_the_spring_buckles():
    """λ of the lowest mode over travel crosses zero within 3 % of Haringx's travel of clamped ends."""
    turns, pitch = 20.0, 12.0
    law = library.load("elastic")
    critical = critical_travel(turns * pitch, 40.0, law.G / law.E)
    parts = (0.7, 0.9, 0.97)
    loading = [{"to": {"travel": part * critical}, "steps": 2} for part in parts]
    analysis, lowest = spring(turns, pitch, loading=loading), [modes_of(spring(turns, pitch), 1).eigenvalues[0]]
    analysis.recorder.begin(1.0)
    for number in range(len(parts)):
        for _step in analysis.program.run(analysis.stage(number)):
            pass
        lowest.append(modes_of(analysis, 1).eigenvalues[0])
        analysis.program.begin(number + 1)
    assert (np.diff(lowest) < 0.0).all()
    zero = parts[-1] + lowest[-1] * (parts[-1] - parts[-2]) / (lowest[-2] - lowest[-1])
    assert zero == pytest.approx(1.0, abs=0.03)
    assert lowest[-1] < 0.12 * lowest[0]


def test_a_bar_that_has_yielded_vibrates_elastically():
    """Stretched far beyond yield, its axial frequency is that of E, not that of the much softer plastic tangent."""
    law, n, length = library.load("ck15"), 10, 100.0
    frame = clamped(length, 2.5, n, law)
    dof = frame.dof(n, X)
    assert frame.step({dof: 0.004 * length}).converged
    found = natural_modes(frame.system, frame.load, DENSITY, 14).frequencies
    stretched = length * 1.004
    c = np.sqrt(law.E / (DENSITY * TONNE)) / (2.0 * stretched)  # E A of the strain, ρ A of the stress-free length
    assert np.abs(found / (c * np.sqrt(1.004) * (1.0 + (np.pi / n) ** 2 / 24.0)) - 1.0).min() < 2e-3


def test_a_spring_that_is_pressed_at_its_ends_is_turned_by_a_free_head():
    """A head without mass that is free to turn: the twist mode is the quarter wave of the clamped one's half."""
    free = spring(6.0, 8.0, heads={"top": {"turn": "free"}})
    found, held = modes_of(free, 6), modes_of(spring(6.0, 8.0), 6)
    assert found.frequencies[0] < 0.6 * held.frequencies[0]
    assert found.total == pytest.approx(held.total, rel=1e-9)


def test_glued_coils_resist_sliding_with_their_normal_stiffness():
    """Of one pair: k w wᵀ n nᵀ becomes k w wᵀ, if the geometric part is left out."""
    w = np.array([0.2, 0.3, 0.4, 0.1, -0.1, -0.5, -0.3, -0.1])
    n = np.array([0.6, 0.0, 0.8])
    g, k = np.outer(w, n).ravel(), 250.0
    normal = k * np.outer(g, g)
    part = Contribution(np.arange(24)[None], -3.0 * g[None], normal[None], *(np.array([v]) for v in (3.0, 0.1, 0, 0.0)))
    stiff = _glued(part, 8).stiffness[0]
    assert stiff == pytest.approx(k * np.kron(np.outer(w, w), np.eye(3)), abs=1e-9)
    assert _glued(part, 3) is part  # of a seat


def test_states_in_words():
    block = check({"spring": CK15 | {"turns": 3.0, "pitch": 12.0}, "material": "elastic", "loading": [{"to": "block"}]})
    coil = block.spring.build()
    assert phase_to("end", coil) is None
    assert phase_to("block-3mm", coil) == {"to": {"height": coil.block_height + 3.0}}
    assert phase_to("force=12.5", coil) == {"to": {"force": 12.5}}
    with pytest.raises(InputError, match="is no state; give end, block"):
        phase_to("blocked", coil)


def test_seats_that_no_longer_touch_the_spring_are_refused():
    """Above the length that it has after its set; clamped heads pull it, and hooks."""
    entries = {"spring": CK15 | {"turns": 2.5, "pitch": 12.0}, "material": "ck15", "accuracy": "none"}
    mesh = {"elements_per_turn": 8, "section": {"radial": 2, "angular": 8}}
    loading = [{"to": "block", "steps": 4}, {"to": {"force": 0.0}, "steps": 2}]
    pressed = check(entries | {"mesh": mesh, "loading": loading})
    free = after_run(pressed)
    length = free.setup.outer_length(free.layout.gather(free.rod.x))
    assert length < 23.0
    for at in ("height=30", "travel=5", f"height={length + 0.1}"):
        message = f"'{at}' leads to a height of .* mm, above the present free length of {length:.5g} mm, but seats"
        with pytest.raises(InputError, match=re.escape("--at: ") + message):
            after_run(pressed, at)
    assert after_run(pressed, f"height={length - 0.1}").control.force > 0.0
    clamped = check(entries | {"mesh": mesh, "loading": loading, "ends": "clamped"})
    assert after_run(clamped, "height=30").control.force < 0.0


def test_the_way_to_a_state_has_equal_steps_where_errors_are_not_estimated():
    entries = {"spring": CK15 | {"turns": 3.0, "pitch": 12.0}, "material": "elastic"}
    case = check(entries | {"loading": [{"to": {"travel": 1.0}, "steps": 1}], "accuracy": "none"})
    assert _gone_on(case, "travel=2").loading[-1].steps == case.solver.control.steps.automatic
    assert _gone_on(case, "end") is case


def test_load_that_holds_nothing_leaves_six_rigid_modes():
    """Free in space: six frequencies of zero."""
    frame = chain(straight(100.0, 8), 2.0, elastic(E, NU), held=[])
    load = Load.of(frame.layout, {int(dof): 0.0 for dof in frame.layout.seat_dofs}, {})
    found = natural_modes(frame.system, load, DENSITY, 7).eigenvalues
    assert np.abs(found[:6]).max() < 1e-6 * found[6]
