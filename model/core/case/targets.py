"""Load programs judged before a run: seats only press, hooks only pull, no coil comes nearer than its wire allows."""

import numpy as np

from coilset.meshes.springs.ends import touching_pitch
from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case.case import Case
from coilset.model.core.case.phases import Phase, Target, TimePhase
from coilset.model.core.material.law.law import Law

SLACK = 1e-9  # of the free length: rounding of a height that was computed
BORNE = 2.0  # times the elastic force at which all coils are in contact: a target beyond it is not reasonable


def check_targets(case: Case, spring: Spring, shear_modulus: float) -> None:
    """Refuse targets that no spring can reach, with G of its material in MPa.

    Raises:
        InputError: with the numbers: seats that would have to pull, hooks that would press, a spring without travel
            that would be pressed, a height below block, or a force far above the one at which all coils are in contact.
    """
    check_travel(case, spring)
    lowest = lowest_height(case, spring)
    greatest = BORNE * closing_force(spring, shear_modulus)
    for number, phase in enumerate(case.loading):
        if isinstance(phase, Phase) and isinstance(phase.to, Target):
            place = f"loading.{number}.to"
            if case.ends == "seats":
                _only_press(phase.to, spring.free_length, place)
            if case.tails == "hooks":
                _only_pull(phase.to, spring.free_length, place)
            _not_below(phase.to, spring.free_length, lowest, place)
            if phase.to.force is not None and phase.to.force > greatest:
                raise InputError(
                    f"is {phase.to.force:g} N, but all coils of this spring are in contact at about "
                    f"{greatest / BORNE:.4g} N, or less if it yields; give block, or a smaller force",
                    f"{place}.force",
                )


def check_travel(case: Case, spring: Spring) -> None:
    """Refuse a load program that presses a spring whose coils lie on each other; see `check_pressed`."""
    if any(_presses(phase, spring) for phase in case.targets):
        check_pressed(spring)


def check_pressed(spring: Spring) -> None:
    """Refuse to press a spring whose coils lie on each other.

    Raises:
        InputError: with its lengths.
    """
    if spring.wound_solid and not spring.has_tails:
        raise InputError(
            f"there is no travel: the free length is {spring.free_length:.4g} mm, the block length "
            f"{spring.block_height:.4g} mm; wind it longer, or pull or turn it, as in "
            "{to: {force: 0, top: {turn: 90}}}",
            "spring",
        )


def check_working(case: Case, spring: Spring, shear_modulus: float) -> None:
    """Refuse working lengths and forces that no such spring can have; arguments and errors as of `check_targets`."""
    lowest, greatest = lowest_height(case, spring), BORNE * closing_force(spring, shear_modulus)
    highest, slack = spring.free_length if case.ends == "seats" else np.inf, SLACK * spring.free_length
    for place, target in case.working.targets if case.working else ():
        if target.height is not None and not lowest - slack <= target.height <= highest + slack:
            ends = f"the block height of {lowest:.6g} mm and the free length of {spring.free_length:.6g} mm"
            raise InputError(f"is {target.height:g} mm; must be between {ends}", place)
        if target.force is not None and not (0.0 if case.ends == "seats" else -np.inf) <= target.force <= greatest:
            limit = f"0 and {greatest:.4g} N, twice the force at which all coils are in contact"
            raise InputError(f"is {target.force:g} N; must be between {limit}", place)


def lowest_height(case: Case, spring: Spring) -> float:
    """The minimum height of a target, mm: at block, or 0 between seats for which the block height is unknown."""
    flat = case.ends == "clamped" or {case.seats.bottom.shape, case.seats.top.shape} == {"flat"}
    return spring.block_height if flat else 0.0


def check_steps(case: Case) -> None:
    """Refuse automatic steps whose errors, which they follow, are not estimated.

    Raises:
        InputError: with the phase.
    """
    for number, phase in enumerate(case.loading):
        if case.steps_error is None and phase.steps == "auto":
            problem = "automatic steps follow the error that accuracy: none leaves unknown"
            raise InputError(
                f"{problem}; give a number of steps, as in steps: 12, or an accuracy such as 0.2 %",
                f"loading.{number}.steps",
            )


def check_times(case: Case, law: Law) -> None:
    """Refuse a temperature outside the material's table, and phases in time of a rate-independent material.

    Raises:
        InputError: with the entry.
    """
    check_known(law, case.temperature, "temperature")
    if case.heat and not law.is_adiabatic:
        raise InputError(f"plastic work does not warm '{law.name}'; give a material with heating", "heat")
    if case.heat:
        check_known(law, case.heat.surroundings, "heat.surroundings")
    for number, phase in enumerate(case.loading):
        if isinstance(phase, Phase) and phase.seconds is not None and not case.heat and law.data.rate is None:
            raise InputError(
                f"no heat flows, and '{law.name}' does not depend on the rate; give the entry heat, or "
                "leave seconds out",
                f"loading.{number}.seconds",
            )
        if not isinstance(phase, TimePhase):
            continue
        word = "heat" if phase.heat else "hold"
        if law.data.creep is None and case.heat:
            raise InputError(
                f"'{law.name}' does not creep; to let heat flow give a target and seconds, as in "
                "{to: {force: 0}, seconds: 600}",
                f"loading.{number}.{word}",
            )
        if law.is_adiabatic and not case.heat:
            raise InputError(
                f"plastic work heats '{law.name}', and in time this heat flows away; give the entry "
                "heat, or a material without heating",
                f"loading.{number}.{word}",
            )
        if law.data.creep is None and (phase.heat or law.data.rate is None):
            raise InputError(
                f"'{law.name}' does not creep, so that time changes nothing; give a material with creep, "
                "or leave it out",
                f"loading.{number}.{word}",
            )
        if phase.heat:
            check_known(law, phase.heat.to, f"loading.{number}.heat.to")


def check_known(law: Law, temperature: float | None, place: str) -> None:
    """Refuse a temperature outside the material's table.

    Raises:
        InputError: with the entry of the case, where the law would name its own file.
    """
    if temperature is not None:
        try:
            law.known(temperature)
        except InputError as error:
            raise InputError(error.problem, place) from None


def closing_force(spring: Spring, shear_modulus: float) -> float:
    """Force at which the last coil of an elastic spring closes, from the torsion of its wire, N.

    A coil that rises by p over the rise p0 at contact closes at F = G d⁴ (p − p0)/(8 D³). A spring
    of less than a turn has no coils to close: infinite.
    """
    if spring.turns <= 1.0:
        return np.inf
    t = np.linspace(0.0, spring.turns, 16 * int(np.ceil(min(spring.turns, 1000.0))) + 1)
    d, play = spring.wire_diameter(t), spring.pitch(t) - touching_pitch(spring.wire_diameter(t), spring.slope(t))
    return float((shear_modulus * d**4 * np.maximum(play, 0.0) / (64.0 * spring.mean_radius(t) ** 3)).max())


def _presses(phase: Phase, spring: Spring) -> bool:
    """Whether a phase goes to block, or compresses a spring that has no travel."""
    kind, value = phase.goal(spring.free_length, spring.block_height)
    return phase.to == "block" or (value > 0.0 if kind == "force" else value < (1.0 - SLACK) * spring.free_length)


def _only_press(target: Target, free_length: float, place: str) -> None:
    pull = "seats cannot pull; give 0 or more, or ends: clamped"
    if target.force is not None and target.force < 0.0:
        raise InputError(f"is {target.force:g} N, but {pull}", f"{place}.force")
    if target.travel is not None and target.travel < -SLACK * free_length:
        raise InputError(f"is {target.travel:g} mm, but {pull}", f"{place}.travel")
    if target.height is not None and target.height > (1.0 + SLACK) * free_length:
        raise InputError(
            f"is {target.height:g} mm, above the free length of {free_length:.6g} mm, but seats cannot "
            "pull; give a height up to it, or ends: clamped",
            f"{place}.height",
        )


def _only_pull(target: Target, free_length: float, place: str) -> None:
    for name, pressed in (("force", 0.0), ("travel", 0.0), ("height", -free_length)):
        value = getattr(target, name)
        if value is not None and (-value if name == "height" else value) > pressed + SLACK * free_length:
            bound = f"{free_length:.6g} mm or more" if name == "height" else "0 or less"
            raise InputError(f"is {value:g}, but hooks are only pulled; give {bound}", f"{place}.{name}")


def _not_below(target: Target, free_length: float, lowest: float, place: str) -> None:
    travel, slack = free_length - lowest, SLACK * free_length
    if target.travel is not None and target.travel > travel + slack:
        end = (
            f"to its block height of {lowest:.6g} mm; give block, or less"
            if lowest
            else "which is its free length; give less"
        )
        raise InputError(
            f"is {target.travel:g} mm, but the spring can only be compressed by {travel:.6g} mm, {end}",
            f"{place}.travel",
        )
    if target.height is not None and target.height < lowest - slack:
        raise InputError(
            f"is {target.height:g} mm, below the block height of {lowest:.6g} mm; give block, or more",
            f"{place}.height",
        )


def check_own_law(case: Case, keeps_direction: bool) -> None:
    """Reject what a law of one's own cannot do.

    Args:
        case: it.
        keeps_direction: whether the law is the same in all directions across the wire.

    Raises:
        InputError: an entry that needs a material of a file, or sections whose directions across the wire are arbitrary
            under a law that has directions.
    """
    if not isinstance(case.material, str):
        raise InputError("a named wire has its own law; give material: elastic with a law of one's own", "material")
    if case.past:
        raise InputError(
            "coiling and peening need a material of a file, not a law of one's own", f"spring.{case.past[0]}"
        )
    if case.mesh.section.spin:
        raise InputError("a law of one's own brings its own rates; leave spin out", "mesh.section.spin")
    if case.mesh.section.kind == "warping":
        raise InputError("a law of one's own has three stresses; give curved or plane", "mesh.section.kind")
    if case.mesh.section.kind == "plane" and not keeps_direction:
        raise InputError(
            "the law differs with the direction across the wire, which plane sections do not fix; give curved",
            "mesh.section.kind",
        )
