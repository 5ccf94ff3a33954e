"""What there is to think about in a case before it runs: its entries and its spring; the checks judge its loads."""

from collections.abc import Iterator

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.warning import Warning
from coilset.model.core.case import Case
from coilset.model.core.case.case import SectionSpec
from coilset.model.core.case.phases import TimePhase
from coilset.model.core.case.warping import keeps_elastic_warping, warping_can_be_estimated
from coilset.model.core.material.law.law import Law
from coilset.model.tools.limits.spring_warnings import spring_warnings
from coilset.model.tools.wires.wire import ROOM_TEMPERATURE

COARSE = 0.1  # an accuracy that is rather meant in per cent


def case_warnings(case: Case, spring: Spring, law: Law) -> tuple[Warning, ...]:
    """Warnings about a case, before it runs."""
    return (
        *_renamed(case),
        *_accuracy(case),
        *_estimated(case),
        *_undetermined(law),
        *warm_warnings(case, law, None if isinstance(case.material, str) else case.material.wire),
        *_supports(case, spring),
        *_warping(case, spring, law),
        *spring_warnings(spring),
    )


def _renamed(case: Case) -> Iterator[Warning]:
    for notice in case.notices():
        yield Warning("earlier name", notice.partition(":")[0], notice)


def _accuracy(case: Case) -> Iterator[Warning]:
    allowed = case.steps_error
    if allowed is not None and allowed >= COARSE:
        message = f"errors of {100.0 * allowed:g} % of force and set are allowed; 0.2 % is 0.002, or '0.2 %'"
        yield Warning("accuracy", "accuracy", message, allowed, COARSE)


def _estimated(case: Case) -> Iterator[Warning]:
    if not isinstance(case.material, str):
        name = case.material.wire
        yield Warning(
            "estimate",
            "material.wire",
            f"the hardening of {name} is an estimate from its minimum tensile "
            "strength; a test of the wire gives its own (coilset material fit)",
        )


def _undetermined(law: Law) -> Iterator[Warning]:
    if names := law.data.validity.undetermined:
        yield Warning(
            "not determined",
            "material",
            f"the tests of {law.name} do not determine {', '.join(names)}: other values fit them as well, and the ± of "
            "force and set, which are of the computation, leave out what these would change",
        )


def warm_warnings(case: Case, law: Law, wire_name: str | None) -> Iterator[Warning]:
    """Warnings of a spring whose moduli are those of its temperature, but whose strength is not.

    Args:
        case, law: the law is the case's.
        wire_name: standard wire whose numbers are used; None if there is none.
    """
    if wire_name and case.temperature not in (None, ROOM_TEMPERATURE):
        yield Warning(
            "temperature",
            "temperature",
            f"at {case.temperature:g} K G and E of {wire_name} follow the standard's slope of G, but the strength "
            "is that of 20 °C: how it decreases is unknown, so that a warm spring sets more than computed",
        )
    tested = law.data.validity.temperature
    reached = [case.temperature, *(phase.temperature for phase in case.loading if isinstance(phase, TimePhase))]
    other = [one for one in reached if one is not None and one != tested]
    if tested is not None and other:
        yield Warning(
            "temperature",
            "material",
            f"yield and hardening of {law.name} were tested at {tested:g} K only and stay so at {max(other):g} K: how "
            "they decrease is unknown, so that a warm spring sets more than computed",
        )


def _supports(case: Case, spring: Spring) -> Iterator[Warning]:
    """Supports that no spring with these ends has; the ends of a measured wire have no form that could be checked."""
    if spring.measured_axis is not None:
        return
    for end, name in ((spring.bottom, "bottom"), (spring.top, "top")):
        if case.ends == "clamped" and end.is_closed:
            message = (
                f"the {name} end is {end.form}, but clamped ends fix the section at its tip, which no support of "
                "such a spring does; give ends: seats, or open end_coils for a wire that is welded in"
            )
            yield Warning("support", "ends", message)
        elif case.ends == "seats" and case.seats.hold == "groove" and not end.is_closed:
            message = (
                f"the {name} end is open, but a groove supports an end coil that rests on its seat; "
                "give closed end_coils, or seats: {hold: tips}"
            )
            yield Warning("support", "seats.hold", message)


def _warping(case: Case, spring: Spring, law: Law) -> Iterator[Warning]:
    """What no error states. The numbers are of `any-wire`."""
    stated = case.steps_error is not None and warping_can_be_estimated(case, law)
    if keeps_elastic_warping(case, spring) and not stated:
        yield Warning(
            "elastic warping",
            "mesh.section.kind",
            f"{case.mesh.section.kind} sections keep the warping of the elastic wire as it yields, and no stated "
            "error contains that: beyond yield the force was up to 3 % too high in ovals 2:1, 6 % in rectangles "
            "and 15 % in tubes; give kind: warping",
        )
    least = SectionSpec().polynomials(case.wire_shape)
    if spring.section is not None and case.mesh.section.kind == "warping" and case.section_degree < least:
        yield Warning(
            "warping degree",
            "mesh.section.degree",
            f"polynomials of degree {case.section_degree} do not follow the warping of this wire, and no stated error "
            f"contains that: with 3 the rate of a rectangle 2:1 was 12 % too high; leave degree out or give {least}",
        )
