"""The past of a rod's wire: coiled, relieved or peened, it is not free of stress before its first load."""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from mpi4py import MPI

from coilset.meshes.springs.placement import STRAIGHT
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.base.warning import Warning
from coilset.model.core.material.law.functions import HEATING, elasticity
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import AnyLaw
from coilset.model.core.material.law.parts import Parts
from coilset.model.core.rod.rod import Rod
from coilset.model.core.section.fibres import FibreSections
from coilset.model.core.section.rules import DiskRule
from coilset.model.core.section.sections import Sections
from coilset.model.physics.manufacture.coiling import Coiled, coil, grind, twist, winding_torque
from coilset.model.physics.manufacture.entries import Peening, Relief
from coilset.model.physics.manufacture.peening import Layer, peen, peening_warnings
from coilset.model.physics.outlines.outlined_section import WHOLE
from coilset.model.physics.time.creep.law import CreepLaw

DIGITS = 9  # to which sections must agree to have the same past
INTERVALS = 12  # of a stress relief, equal ones of log(1 + t/t₁), with t₁ = FIRST of it
FIRST = 1e-6
START = "point_state", "surface_state"


@dataclass(frozen=True)
class _Past:
    """What all sections of a rod went through: the law without time, that of the relief, the layer, F0 in N."""

    law: AnyLaw
    coiled: bool
    relief: tuple[Parts, ...]
    layer: Layer | None
    tension: float


def give_past(rod: Rod, spring: object) -> float | None:
    """Give all sections the stresses that the wire's past leaves, if it has one; collective.

    Args:
        rod: with sections of fibres whose placement includes the curvature; its equilibrium is replaced, without a
            force on any section.
        spring: the entries of a case.

    Returns:
        Mean diameter to which the wire was coiled at mid-wire, before it sprang back, mm; None if it was not coiled.

    Raises:
        InputError: if the wire cannot be coiled to the spring, not be relieved or not be peened so.
    """
    if not _has_past(spring):
        return None
    assert isinstance(spring, SpringSpec)
    past, state = _past(rod, spring), {name: rod.state[name].equilibrium for name in START}
    tight, problem = np.zeros((2, *rod.placement.curvature.shape)), None
    try:
        _through(rod.sections, rod.rule, state, past, tight)
    except SolveError as error:
        problem = str(error)
    problem = next((one for one in rod.comm.allgather(problem) if one), None)
    if problem:
        if past.tension and not past.coiled:
            raise InputError(f"the wire does not take this tension: {problem}", "spring.initial_tension")
        if not past.coiled:
            raise InputError(f"the section finds no balance with the layer: {problem}", "spring.peening")
        wanted = "'coiling' needs a wire that yields and keeps its shape"
        raise InputError(f"{wanted}: {problem}", "spring.made_by")
    rod.state.restore()
    rod.rest()
    ordered = rod.comm.bcast(rod.line.in_order(np.moveaxis(tight, 0, -1)))
    curvature, torsion = ordered[len(ordered) // 2, 0]
    return float(2.0 * curvature / (curvature**2 + torsion**2)) if past.coiled else None


def give_sections_past(
    sections: Sections, rule: DiskRule, state: Mapping[str, np.ndarray], rod: Rod, spring: object
) -> None:
    """Give sections beside the rod's own, such as those of a finer rule, the past of its wire; collective.

    Args:
        sections: with the placement of some of the rod's cells.
        rule: theirs.
        state: their arrays, which are written.
        rod, spring: as in `give_past`.

    Raises:
        SolveError: the past has no such state with this rule; on this rank only.
    """
    if _has_past(spring):
        assert isinstance(spring, SpringSpec)
        _through(sections, rule, state, _past(rod, spring), np.zeros((2, *sections.placement.curvature.shape)))


def _has_past(spring: object) -> bool:
    """Whether the wire is not free of stress before its first load."""
    return isinstance(spring, SpringSpec) and bool(spring.made_by or spring.peening or spring.initial_tension)


def _past(rod: Rod, spring: SpringSpec) -> _Past:
    """What the sections of a rod went through; collective."""
    state = {name: rod.state[name].equilibrium for name in START}
    law = rod.sections.law_over_step.over(state, state)
    plastic = _cold(law.parts.plastic)
    return _Past(
        plastic if rod.law.returns_cold else law.parts._replace(plastic=plastic),
        bool(spring.made_by),
        relief_intervals(rod.law, rod.parameters, rod.temperature, spring.relieved),
        None if spring.peening is None else _layer(rod, spring.peening),
        spring.initial_tension or 0.0,
    )


def past_warnings(rod: Rod, spring: object) -> list[Warning]:
    """Warnings about the wire's past; collective."""
    if not isinstance(spring, SpringSpec) or spring.peening is None:
        return []
    return peening_warnings(_layer(rod, spring.peening), rod.rule, rod.largest_radius)


def _layer(rod: Rod, peening: Peening) -> Layer:
    """The layer's eigenstrain, ε* = −σ/E of a given stress.

    Raises:
        InputError: if it is thicker than the wire's radius.
    """
    radius = float(rod.comm.allreduce(rod.radius.min(initial=np.inf), op=MPI.MIN))
    if peening.depth[-1] > radius:
        raise InputError(
            f"goes down to {peening.depth[-1]:g} mm, below the wire's axis at {radius:g} mm", "spring.peening.depth"
        )
    if peening.strain is not None:
        return Layer(np.array(peening.depth), np.array(peening.strain))
    E, _, _ = elasticity(rod.parameters, rod.temperature)
    return Layer(np.array(peening.depth), -np.array(peening.stress) / E)


def relief_intervals(
    law: Law, parameters: np.ndarray, temperature: float, relief: Relief | None, count: int = INTERVALS
) -> tuple[Parts, ...]:
    """The law over the intervals of a stress relief, one after the other; heating and cooling take no time.

    Args:
        law: of the wire.
        parameters: its, at the temperature of the spring.
        temperature: of the spring, K.
        relief: entries of a case; None: nothing.
        count: of the intervals.

    Raises:
        InputError: if the material does not creep, or is not known at the temperature of the relief.
    """
    if relief is None:
        return ()
    if law.data.creep is None:
        raise InputError(
            f"'{law.name}' does not creep, so that time relieves nothing; give a material with creep",
            "spring.relieved",
        )
    try:
        warm = law.known(relief.temperature)
    except InputError as error:
        raise InputError(error.problem, "spring.relieved.temperature") from None
    hours = relief.minutes / 60.0 * FIRST * np.expm1(np.linspace(0.0, 1.0, count + 1) * np.log1p(1.0 / FIRST))
    creep = CreepLaw(law.data.creep, law.parts(_cold(parameters)), rate=law.data.rate)
    clocks = [creep.clock(0.0, temperature)]
    for time, at in (*((float(time), warm) for time in hours), (float(hours[-1]), temperature)):
        clocks.append(creep.clock(time, at, clocks[-1]))
    return tuple(creep.over(before, after) for before, after in pairwise(clocks))


def _cold(parameters: np.ndarray) -> np.ndarray:
    """The law's parameters without heating by plastic work: the wire's past leaves it as warm as the spring."""
    found = parameters.copy()
    found[HEATING] = 0.0
    return found


@dataclass(frozen=True)
class _Bend:
    """Arguments of `coil`, equal to others of the same content."""

    content: Hashable
    arguments: tuple[Any, ...] = field(compare=False)


def _content(argument: Any) -> Hashable:
    if isinstance(argument, np.ndarray):
        return argument.shape, argument.tobytes()
    if isinstance(argument, DiskRule):
        return argument.name, _content(argument.points), _content(argument.weights)
    return tuple(map(_content, argument)) if isinstance(argument, tuple) else argument


@lru_cache(maxsize=256)
def _coiled(bend: _Bend) -> Coiled:
    """`coil`, kept: a spring that is pressed again has the same sections."""
    return coil(*bend.arguments)


def _through(
    sections: Sections, rule: DiskRule, state: Mapping[str, np.ndarray], past: _Past, tight: np.ndarray
) -> None:
    """Write the states of all sections, and their curvature and torsion before they sprang back."""
    assert isinstance(sections, FibreSections)
    place = sections.placement
    radius = np.broadcast_to(sections.radius[:, None], place.curvature.shape)
    ground = np.where(np.isfinite(place.flat[..., :1]), place.flat, [WHOLE, 0.0, 0.0])
    wires = np.concatenate([np.stack([radius, place.curvature, place.torsion], axis=-1), ground], axis=-1)
    wires = wires.reshape(-1, wires.shape[-1])
    size = np.abs(wires).max(axis=0, initial=0.0)
    alike = np.round(wires / np.where(size > 0.0, size, 1.0), DIGITS)
    _, first, which = np.unique(alike, axis=0, return_index=True, return_inverse=True)
    virgin, guess = sections.initial_state()["point_state"], None
    points, surface = (state[name] for name in START)
    for k, (radius, curvature, torsion, *_) in enumerate(wires[first]):
        states = virgin[0, 0, :1]
        here = np.nonzero((which == k).reshape(place.curvature.shape))
        left = sections.cut_points(here[0][0], here[1][0])  # of a ground section
        rim = None if left is None else left[0][:2].T / radius
        if past.coiled and curvature >= STRAIGHT:
            if guess is not None:  # as the last one, turned by as much more as this one is
                guess = guess[0] + curvature - wires[first][k - 1, 1], guess[1] + torsion - wires[first][k - 1, 2]
            bend = past.law, rule, radius, curvature, torsion, states, sections.curved, guess, past.relief, rim
            coiled = _coiled(_Bend(_content(bend), bend))
            guess, states = coiled.turned, np.concatenate([coiled.points, coiled.surface])
            tight[0][here], tight[1][here] = coiled.curvature, coiled.torsion
        if past.layer is not None:
            states = peen(past.law, rule, radius, curvature, sections.curved, states, past.layer, rim)
        if past.tension and torsion:  # hooks are plane, and not wound onto anything
            torque = winding_torque(past.tension, curvature, torsion)
            states = twist(past.law, rule, radius, curvature, sections.curved, states, torque, rim)
        if left is not None and len(states) > 1:
            states = grind(past.law, *left, radius, sections.curved, states[len(rule) :])
        if len(states) > 1:
            points[here], surface[here] = np.split(states, [len(rule)])
