"""From a case and its parts to the Setup of the records of its run."""

import math
from collections.abc import Sequence

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.compose.build import PENETRATION, MeshedWire
from coilset.model.compose.parts import installed, lacking
from coilset.model.core.base.package import package
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case
from coilset.model.core.case.head_freedoms import DamperSpec
from coilset.model.core.case.material import case_allowed, case_elastic, case_strength
from coilset.model.core.case.phases import Phase, heads_of
from coilset.model.core.contact.base import Contact
from coilset.model.core.results.records.drawn import Drawn, SectionPoints
from coilset.model.core.results.records.record import ContactRecord, ForceLine, Limit, Limits, Setup
from coilset.model.core.section.kinds import cut_points

LIMITS = "coilset.model.tools.limits.limits"  # the door to limits of results
DRAWN = 144  # points on the outline of a wire that is not round


def build_setup(
    case: Case,
    spring: Spring,
    wire: MeshedWire,
    contacts: Sequence[Contact],
    past: tuple[float | None, list[Warning]],
) -> Setup:
    """Setup of the records of a run; `past` as `build_past` gives it."""
    law, least_radius = wire.rod.law, float(wire.radius.min())
    records = tuple(
        ContactRecord(one.name, one.end, np.empty(0) if one.points is None else one.points.turns) for one in contacts
    )
    limits = Limits(
        law.data.validity.plastic_work,
        case_strength(case, spring),
        PENETRATION * 2.0 * least_radius,
        None if installed("physics.accuracy.step_error") is None else case.steps_error,
        *case_allowed(case, spring),
        creep=law.data.creep.tests if law.data.creep else None,
    )
    elastic, standards = case_elastic(case, law), installed("tools.limits.before_run")
    known = None if standards is None else standards.before_run(case, spring, law)
    warnings = (*(known.warnings if known else ()), *past[1], *wire.warnings, *lacking())
    bounds: tuple[Limit, ...] = ()
    if case.limits:
        bounds = package(LIMITS, "a limit", "limits").case_limits(case, spring, elastic.shear_modulus)
    return Setup(
        spring=_drawn(spring, wire.turns),
        material=law.name,
        ends=case.ends,
        phases=tuple(phase.label for phase in case.loading),
        forces_given=forces_given(case),
        torques_given=tuple(any(head.torque is not None for head in heads_of(one).values()) for one in case.loading),
        turns=wire.turns,
        wire_radius=wire.radius,
        contacts=records,
        sections=_section_points(case, wire),
        buckling_travel=known.buckling_travel if known else math.inf,
        nominal_stress=known.nominal_stress if known else (None, None),
        limits=limits,
        rates_at=tuple(case.rates_at),
        warnings=warnings,
        coiling_diameter=past[0],
        force_line=build_force_line(case),
        bounds=bounds,
        initial_tension=getattr(case.spring, "initial_tension", None) or 0.0,
        strength=None if case.endurance is None else case.endurance.strength(0.5 * law.E / law.G - 1.0),
    )


def _drawn(spring: Spring, turns: np.ndarray) -> Drawn:
    """A spring in numbers, `turns` of the stations."""
    axis = spring.measured_axis
    return Drawn(
        free_length=spring.free_length,
        block_height=spring.block_height,
        turns=spring.turns,
        middle=(spring.bottom.end_turns, spring.turns - spring.top.end_turns),
        hand=spring.hand,
        mean_diameter=2.0 * float(spring.mean_radius(0.5 * spring.turns)),
        end_radius=float(spring.mean_radius(0.0)),
        wire_diameter=spring.wire_diameter(turns),
        below=spring.seat_distance(turns, "bottom"),
        above=spring.seat_distance(turns, "top"),
        has_tails=spring.has_tails,
        is_straight=spring.axis is None,
        measured_axis=None if axis is None else (axis.offset, axis.tilt),
    )


def _section_points(case: Case, wire: MeshedWire) -> SectionPoints:
    """The sections of a wire in numbers."""
    rule, placement = wire.rod.rule, wire.placement
    return SectionPoints(
        kind=case.mesh.section.kind,
        rule=rule.name,
        abscissae=wire.rod.element.xi,
        points=rule.points,
        weights=rule.weights,
        curvature=placement.curvature,
        torsion=placement.torsion,
        cut=tuple(cut_points(rule, placement)),
        outline=None if rule.outline is None else rule.outline.boundary.points(DRAWN),
    )


def forces_given(case: Case) -> tuple[bool, ...]:
    """Of each phase, whether it ends at a force of the load program; time may pass under one."""
    given = [False]
    for phase in case.loading:
        given.append(phase.gives_force if isinstance(phase, Phase) else phase.duration.keep == "force" and given[-1])
    return tuple(given[1:])


def build_force_line(case: Case) -> ForceLine | None:
    """Where the case reports the force line; without a damper its moments are about the axis, at the bottom seat."""
    spec = case.force_line
    if spec is None:
        return None
    damper = spec.damper or DamperSpec(point=[0.0, 0.0, 0.0], direction=[0.0, 0.0, 1.0])
    guides = (tuple(damper.guides or ()), damper.friction or 0.0)
    return ForceLine(spec.lower, spec.upper, tuple(damper.point), tuple(damper.direction), *guides)
