"""From a case to the parts of its analysis: mesh and rod, heat, Newton's method, control, continuation."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI

from coilset.meshes.line import line_mesh
from coilset.meshes.springs.geometry import Spring
from coilset.meshes.springs.placement import Placement, chord_placement, refuse_sharp_bends, section_placement
from coilset.model.compose.parts import installed
from coilset.model.core.base.package import package
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case
from coilset.model.core.case.head_freedoms import HeadsSpec
from coilset.model.core.case.phases import heads_of
from coilset.model.core.case.seats import SeatsSpec
from coilset.model.core.equilibrium.newton.contact_limit import ContactLimit
from coilset.model.core.equilibrium.newton.methods import Method, rod_method
from coilset.model.core.equilibrium.newton.newton import Newton
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.system.heads import Heads, Holding
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.material.law.law import Law
from coilset.model.core.rod.elements import ELEMENTS
from coilset.model.core.rod.rod import Rod
from coilset.model.core.rotations.triads import chord_triads
from coilset.model.core.runtime.threads import Threads

# The doors to what not every spring has.
HEAT, PAST = "coilset.model.physics.time.heat", "coilset.model.physics.manufacture.initial_state"
OUTLINED, LEVER = "coilset.model.physics.outlines.outlined_section", "coilset.model.physics.guides.lever"
PENETRATION = 0.02  # usual maximum penetration in wire diameters; a case may allow more
AUGMENTED = 2.0  # times the maximum penetration: up to there contacts are augmented although the case does not say so


@dataclass(frozen=True)
class MeshedWire:
    """The wire of a spring in elements.

    Attributes:
        turns: of the stations, shape (n + 1,).
        radius: of the elements, shape (n,), mm.
        placement: Placement of their sections.
        rod: Rod.
        warnings: about mesh and effort.
    """

    turns: np.ndarray
    radius: np.ndarray
    placement: Placement
    rod: Rod
    warnings: tuple[Warning, ...]


def build_wire(case: Case, spring: Spring, law: Law, comm: MPI.Comm, threads: int) -> MeshedWire:
    """The wire of a case's spring.

    Raises:
        InputError: if it needs more memory than there is, bends too sharply, or is outside the law's temperatures.
    """
    element = ELEMENTS[case.mesh.element]
    turns = spring.stations(case.mesh.elements_per_turn, case.mesh.sagitta)
    section, rule, automatic = case.mesh.section, case.section_rule, case.solver.control.steps.automatic
    if spring.section is not None:
        outlined = package(OUTLINED, "wire that is not round", "spring.wire").Outlined
        rule = outlined(spring.section.scaled(1.0, spring.hand)).rule(len(rule))  # the binormal of a left one is down
    steps = sum(phase.count(automatic) for phase in case.loading)
    points = 2 * len(rule) * len(element.abscissae) // 2  # an effort is that of two sections
    warnings: tuple[Warning, ...] = ()
    if (accuracy := installed("physics.accuracy.effort")) is not None:
        # before the rod is made, which takes the memory that this needs for a moment
        warnings = accuracy.checked(spring, turns, points, steps, case.steps_error is not None)
    line = line_mesh(spring.centre_line(turns), comm)
    radius = 0.5 * spring.wire_diameter(0.5 * (turns[1:] + turns[:-1]))
    chords = chord_triads(np.diff(line.stations, axis=0))
    if case.mesh.axis == "chords":
        placement = chord_placement(spring, turns, chords, element.xi)
    else:
        to_normal = section.kind != "plane" or bool(case.past) or spring.section is not None
        placement = section_placement(spring, turns, chords, element.xi, to_normal)
        refuse_sharp_bends(placement, radius * (1.0 if spring.section is None else spring.section.high[0]), turns)
    rod = Rod(
        line,
        radius,
        law,
        rule,
        placement,
        case.temperature,
        section.kind,
        case.section_degree,
        Threads(threads),
        element,
    )
    return MeshedWire(turns, radius, placement, rod, warnings)


def build_heat(case: Case, rod: Rod) -> Any:
    """WireHeat of the rod, if the case requests it, else None."""
    spec = case.heat
    if spec is None:
        return None
    start = rod.temperature if spec.surroundings is None else spec.surroundings
    heat = package(HEAT, "heat that flows", "heat")
    return heat.WireHeat(rod, heat.heat_constants(rod.law, spec.conductivity, spec.convection, spec.tips, start))


def build_past(case: Case, rod: Rod) -> tuple[float | None, list[Warning]]:
    """Give the wire the stresses of its manufacture, if the case has one; collective.

    Returns:
        Mean diameter to which it was coiled, mm, None if it was not, and warnings.

    Raises:
        InputError: if it cannot be made so.
    """
    if not case.past:
        return None, []
    made = package(PAST, "wire with a past", f"spring.{case.past[0]}")
    return made.give_past(rod, case.spring), made.past_warnings(rod, case.spring)


def _deepest(case: Case, least_radius: float) -> float:
    """Penetration above which contacts are augmented or states rejected, mm, by that of the thinnest element."""
    return case.contact.penetration_limit * 2.0 * least_radius


def build_newton(case: Case, system: System, least_radius: float) -> Newton:
    """Newton's method, or the other one that the case names.

    Args:
        least_radius: of the elements, mm.
    """
    solver, contact = case.solver, case.contact
    control, wire_diameter = solver.control.newton, 2.0 * system.line.rod.largest_radius
    limit = ContactLimit(system, contact.penetration_limit * wire_diameter)
    tolerance, augmented = contact.augmentation_tolerance, np.inf
    if tolerance is None:  # a much deeper state is on the wrong side, or from too long a step
        tolerance = _deepest(case, least_radius)
        augmented = AUGMENTED * tolerance
    return Newton(
        system, build_method(case, system.line, solver.method), solver.tolerance, control, limit, tolerance, augmented
    )


def build_method(case: Case, layout: LineLayout, name: str) -> Method:
    """An iteration method with the case's options.

    Raises:
        InputError: if there is no such method.
    """
    # an arc by which every node moves by about the wire's radius
    arc = layout.rod.largest_radius * np.sqrt(len(layout.station_dofs))
    return rod_method(name, layout.comm.size, case.solver.options, arc)


def build_control(case: Case, spring: Spring, system: System, turns: np.ndarray) -> Heads:
    """The spring between its heads; `turns` of the stations."""
    clamped = case.ends == "clamped"
    holder: HeadsSpec | SeatsSpec = case.clamps if clamped else case.seats
    rotating = any(spec.tilt != "held" or spec.turn != "held" for spec in (holder.bottom, holder.top))
    driven = any(target.rotates for phase in case.loading for target in heads_of(phase).values())
    holding = Holding(clamped, case.seats.hold == "tips", (holder.bottom.held(), holder.top.held()))
    if clamped:
        stations = [int(np.argmin(np.abs(turns - held))) for held in spring.held]
        pulled = [tail is not None and tail.pulled for tail in spring.tails]
        points = [tail is not None and tail.on_point for tail in spring.tails]
        rotates = rotating or driven or any(points)
        holding = holding._replace(
            fix=package(LEVER, "a head that rotates", "heads").FixedStation if rotates else None,
            stations=(stations[0], stations[1]),
            at_station=(pulled[0], pulled[1]),
            on_point=(points[0], points[1]),
        )
    return Heads(system, spring.free_length, holding, float(spring.mean_radius(0.5 * spring.turns)))


def build_continuation(
    case: Case, newton: Newton, control: Heads, stability: Any | None, least_radius: float
) -> Continuation:
    """The steps along the path, with an estimate of their error unless the case wants none.

    Args:
        stability: Stability of Newton's iteration; None: unstable paths are not left.
        least_radius: of the elements, mm.
    """
    steps, accuracy = case.solver.control.steps, case.steps_error
    if not newton.system.is_symmetric:
        steps = replace(steps, largest=min(steps.largest, steps.largest_with_friction))
    error = branches = None
    if accuracy is not None and (estimate := installed("physics.accuracy.step_error")) is not None:
        error = estimate.StepError(control, accuracy, steps)
    if stability is not None and (switching := installed("physics.stability.branch_switching")) is not None:
        branches = partial(switching.Branches, stability)
    return Continuation(newton, steps, _deepest(case, least_radius), branches=branches, step_error=error)
