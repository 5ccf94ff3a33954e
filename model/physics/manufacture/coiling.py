"""The wire's past: straight wire is bent and twisted beyond yield, and springs back to the shape of its spring.

A wire free of stress is brought along a straight path to the rotations θ (bend) and φ (twist) of a length of it, while
N, Q2, Q3 and M2 stay zero; then the moments are taken away. With the stretch λ of the axis, its curvature is θ/λ, and
its torsion φ/λ. θ and φ are sought for which both are those of the spring when all resultants are zero. Strains of the
fibres are logarithmic in the limit of many increments, since each increment divides by the length 1 − κ y of the fibre
half way through it.

Stress relief may follow: the wire creeps while all resultants stay zero, which unbends it a little. θ and φ are then
those for which it has the spring's shape afterwards.

An end is ground last: the remaining sections spring back until all resultants are zero, without a change of the
spring's shape.

What coiling machines do besides is left out: no temperature, no tension in the wire, no stress from drawing, and no
second bend where a pitch tool or another pin touches.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material.law.loop import AnyLaw
from coilset.model.core.material.point.loops import with_loop
from coilset.model.core.section.rules import DiskRule
from coilset.model.core.section.sections import BEND, TWIST
from coilset.model.physics.manufacture.wire import Wire

LOADING, RELEASE, TWISTS = 40, 4, 4  # increments
FREE = np.array([0, 1, 2, 4])  # ε, γ12, γ13, κ2 follow while the wire is bent and twisted
CLOSE = 1e-10  # of the spring's curvature
ATTEMPTS = 30


@dataclass(frozen=True)
class Coiled:
    """Sections of a wire that was coiled and sprang back.

    Attributes:
        points: states of the rule's points, shape (points, n_state), MPa; surface: of the points on the surface.
        curvature, torsion: of the axis before it sprang back, 1/mm.
        moments: M3 and Mt there, N mm.
        turned: θ and φ there, 1/mm.
    """

    points: np.ndarray
    surface: np.ndarray
    curvature: float
    torsion: float
    moments: tuple[float, float]
    turned: tuple[float, float]


def coil(
    law: AnyLaw,
    rule: DiskRule,
    radius: float,
    curvature: float,
    torsion: float,
    row: np.ndarray,
    curved: bool = True,
    guess: tuple[float, float] | None = None,
    relief: Sequence[AnyLaw] = (),
    surface: np.ndarray | None = None,
) -> Coiled:
    """The wire of a spring after coiling and stress relief.

    Args:
        law: without time, as `Wire` takes it.
        rule: quadrature of the disk.
        radius: of the wire, mm.
        curvature, torsion: of the spring's axis, 1/mm.
        row: state of a virgin point, shape (1, n_state).
        curved: logarithmic strains of fibres; else ε = −κ y.
        guess: θ and φ to begin with, 1/mm.
        relief: the law over the intervals of time of the stress relief, one after the other.
        surface: points without weight, as in `Wire.of_disk`.

    Raises:
        SolveError: if no coiling ends at this shape, as of a wire that does not yield.
    """
    wanted = np.array([curvature, torsion])
    turned = np.array(guess if guess else 1.1 * wanted)
    before: tuple[np.ndarray, np.ndarray] | None = None
    slope = np.eye(2)
    for _ in range(ATTEMPTS):
        virgin = Wire.of_disk(law, rule, radius, curved, row, surface)
        wire, tight, moments = bent(virgin, turned, wanted[0], relief)
        off = wire.curvature - wanted
        if np.abs(off).max() <= CLOSE * curvature:
            inside = len(rule.weights)
            return Coiled(wire.states[:inside], wire.states[inside:], *tight, moments, (turned[0], turned[1]))
        if before is not None:  # Broyden's update of the slope
            way = turned - before[0]
            slope += np.outer(off - before[1] - slope @ way, way) / (way @ way)
        before = turned, off
        turned = turned - np.linalg.solve(slope, off)
        if not np.abs(turned).max() < 1.0 / radius:
            break
    raise SolveError("it springs back to another shape, however it is bent")


def grind(
    law: AnyLaw, fibres: np.ndarray, shape: np.ndarray, radius: float, curved: bool, states: np.ndarray
) -> np.ndarray:
    """The remaining part of a section with initial stresses after grinding: its states without a resultant.

    Args:
        law: without time, as `Wire` takes it.
        fibres, shape: of the points that are left, see `integration` and `shape`.
        radius: of the wire, mm.
        curved: whether the fibres include the wire's curvature
        states: of these points in the whole section, shape (points, n_state).

    Raises:
        SolveError: if there is no such state.
    """
    wire = Wire(law, fibres, radius, curved, states, shape)
    wire.step(np.zeros(6), np.arange(6), np.zeros(6), 0.0)
    return wire.states


def winding_torque(tension: float, curvature: float, torsion: float) -> float:
    """Mt = F0 r cos α of the wire of an extension spring whose coils press on each other with F0, N mm.

    The helix of radius r and pitch angle α has κ = cos²α/r and τ = sin α cos α/r, so that r = κ/(κ² + τ²).
    """
    return float(np.copysign(tension * curvature**2 / (curvature**2 + torsion**2) ** 1.5, torsion))


def twist(
    law: AnyLaw,
    rule: DiskRule,
    radius: float,
    curvature: float,
    curved: bool,
    states: np.ndarray,
    torque: float,
    surface: np.ndarray | None = None,
) -> np.ndarray:
    """The states of a section under a torque alone, N mm, from its states without a resultant; arguments as of `coil`.

    Raises:
        SolveError: if the section cannot carry it.
    """
    wire = Wire.of_disk(law, rule, radius, curved, states, surface)
    for k in range(1, TWISTS + 1):
        wire.step(np.zeros(6), np.arange(6), np.array([0.0, 0.0, 0.0, torque * k / TWISTS, 0.0, 0.0]), curvature)
    return wire.states


def bent(
    wire: Wire, turned: np.ndarray, end: float, relief: Sequence[AnyLaw], increments: int = LOADING
) -> tuple[Wire, tuple[float, float], tuple[float, float]]:
    """The wire after it was turned by θ and φ a length, released and relieved; curvature and torsion, M3, Mt before.

    Args:
        wire: straight, which is changed.
        turned: θ and φ, 1/mm.
        end: curvature of the spring, 1/mm.
        relief: as in `coil`.
        increments: of the bend.

    Raises:
        SolveError: if a section finds no equilibrium.
    """
    d = np.zeros(6)
    for _ in range(increments):
        d[[BEND, TWIST]] = turned / increments / wire.stretch
        d = wire.step(d, FREE, np.zeros(6), wire.curvature[0] + 0.5 * d[BEND])
    tight, moments = (float(wire.curvature[0]), float(wire.curvature[1])), (float(wire.s[BEND]), float(wire.s[TWIST]))
    loaded, d = wire.s.copy(), np.zeros(6)
    for k in range(1, RELEASE + 1):
        bend = end if k == RELEASE else wire.curvature[0]  # it ends in balance as a section of the spring
        d = wire.step(d, np.arange(6), loaded * (1.0 - k / RELEASE), bend)
    d = np.zeros(6)
    for interval in relief:
        wire.law = with_loop(interval, 3)
        d = wire.step(d, np.arange(6), np.zeros(6), end)
    return wire, tight, moments
