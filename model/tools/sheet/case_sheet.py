"""The sheet of a case: the spring, its wire and its working lengths, as given by the case file."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from coilset.meshes.springs.spring import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import Case
from coilset.model.core.case.loading import is_turned, pulls, rotations, torques
from coilset.model.core.case.material import case_elastic, case_law
from coilset.model.core.case.targets import check_travel
from coilset.model.tools.sheet.from_results import Found
from coilset.model.tools.sheet.sheet import Sheet, pulled_lengths, working_lengths
from coilset.model.tools.standards.buckling import seating_of
from coilset.model.tools.standards.cylinder import Cylinder
from coilset.model.tools.standards.en15800 import Grade
from coilset.model.tools.standards.rate import OnPoint, hook_stress, tails_compliance
from coilset.model.tools.wires import wire
from coilset.model.tools.wires.law import warm_elastic


def case_sheet(
    case: Case,
    spring: Spring,
    run: Found | None,
    wire_name: str | None = None,
    lengths: Sequence[float] = (),
    grade: Grade = 2,
    surface: str = "as coiled",
    dynamic: bool = False,
) -> Sheet:
    """The sheet of a case.

    Args:
        case, spring: the spring is built from the case.
        run: results of a run of it, if there is one.
        wire_name: standard wire; None takes the case's, if it names one.
        lengths: working lengths, mm; if empty, those of the case, or else those that the load program goes to.
        grade, surface, dynamic: see Sheet.

    Raises:
        InputError: a spring that is not cylindrical, an unknown wire, a length that the spring cannot have, or a
            temperature outside the material's table.
    """
    check_travel(case, spring)
    law, cylinder, pulled = case_law(case, spring), Cylinder.of(spring), pulls(case, spring)
    named = wire_name or getattr(case.material, "wire", None)
    known = wire(named) if named else None
    elastic = warm_elastic(known, cylinder.d, case.temperature) if known else case_elastic(case, law)
    low, high = (cylinder.length, inf) if pulled else (cylinder.solid, cylinder.length)
    for length in lengths:
        if not low < length < high:
            between = f"between the block length {low:.4g} and the free length {high:.4g} mm"
            between = f"above the free length {low:.4g} mm, as the spring is pulled" if pulled else between
            raise InputError(f"{length:g} mm is no working length; must be {between}", "--length")
    E, G = elastic.young_modulus, elastic.shear_modulus
    made = Sheet(
        cylinder,
        elastic,
        helix=spring.wire_length,
        wire=known,
        lengths=tuple(lengths),
        grade=grade,
        surface=surface,
        dynamic=dynamic,
        found=run,
        held=not case.ends_turn,
        yield_stress=law.first_yield(case.temperature),
        strength=law.data.tensile_strength if isinstance(case.material, str) else None,
        pulled=pulled,
        turned=is_turned(case, spring),
        turns_to=rotations(case, spring),
        tension=getattr(case.spring, "initial_tension", None) or 0.0,
        beyond=tails_compliance(spring, E, G, is_turned(case, spring)),
        hook_stress=hook_stress(spring) if pulled else 0.0,
        on_point=OnPoint.of(spring, E, G),
        seating=seating_of(case),
    )
    made = replace(made, turns_to=(*made.turns_to, *(torque / made.turn_rate for torque in torques(case, spring))))
    if lengths:
        return made
    if case.working:
        given = (*case.working.lengths, *map(made.length, case.working.forces))
        return replace(made, lengths=tuple(one for one in given if low < one < high))
    if made.pulled:
        return replace(made, lengths=tuple(pulled_lengths(case, spring)))
    planned = working_lengths(case.targets, cylinder.length, made.rate, cylinder.solid)
    return replace(made, lengths=tuple(planned))
