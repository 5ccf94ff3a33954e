"""Warnings of a run, derived from its records, so that a resumed run gives the same ones."""

from collections.abc import Iterator
from itertools import pairwise
from math import degrees

from coilset.model.compose.parts import parts
from coilset.model.core.base.warning import Warning
from coilset.model.core.results import surface
from coilset.model.core.results.records.closing import VERTICAL, stands_on_wall, steepness
from coilset.model.core.results.records.labels import CAUSES, NUMBERS, TURNED, apart, listed
from coilset.model.core.results.records.part import WarningsOf, place_of
from coilset.model.core.results.records.rates import FEW, tensions
from coilset.model.core.results.records.record import Result, Setup, Snapshot, Step
from coilset.model.core.results.records.releases import (
    FREE,
    NOTICED,
    is_turned,
    last_release,
    set_of,
    turned_radius,
)
from coilset.model.core.results.records.units import unit_of
from coilset.model.core.results.stresses import shear_inside

SLIPPED = 0.7  # of the rise to touch: coils of one wire that lie so are shifted sideways by 0.71 of their diameter
WALL_FORCE = 0.002  # of the force, for which the warning states the height where no accuracy is required
LONGER = 1e-3  # of the free length: a negative set beyond it is not rounding
ROUNDING = 1e-3  # by which a limit that is given with few digits may be exceeded
# Of the accuracy for residual stresses: they follow the strains, which converge by an order less than heights, and a
# diffractometer resolves some MPa.
STRESS = 5.0


def run_warnings(setup: Setup, result: Result) -> list[Warning]:
    """All warnings of a run, complete or not, on rank 0: about its case, its steps, and its results."""
    checks = (*FOUND, *(check for part in parts() for check in part.found))
    found = [warning for check in checks for warning in check(setup, result)]
    return [*setup.warnings, *result.warnings, *step_warnings(setup, result), *found]


def step_warnings(setup: Setup, result: Result) -> list[Warning]:
    """Warnings that the steps alone show, at the first step that shows them."""
    checks = (*SEEN, *(check for part in parts() for check in part.seen))
    return [warning for check in checks for warning in check(setup, result)]


def accuracy_warning(
    error: float, required: float, place: str, of: str = "the force", size: str = ""
) -> Warning | None:
    """A step whose estimated error exceeds the requested accuracy; both are relative.

    Args:
        error, required: parts of 1.
        place: where the error is.
        of: the quantity with this error; size: the error in words.
    """
    if error <= required:
        return None
    found, allowed = apart(100 * error, 100 * required)
    message = (
        f"{of} is uncertain by about {found} %{size and f', {size},'} because of the step size, more than "
        f"the case's accuracy of {allowed} %; a smaller accuracy or more steps reduce it"
    )
    return Warning("step error", place, message, error, required)


def beyond_validity(greatest: float, limit: float, material: str, place: str) -> Warning:
    """Plastic work beyond the range in which the material's constants are valid, N/mm²; `place` is where it began."""
    message = (
        f"the plastic work b* reaches {greatest:.4g} N/mm², but the constants of {material} are valid up to "
        f"{limit:.4g} N/mm² only; exceeded since {place}"
    )
    return Warning("plastic work", place, message, greatest, limit, "N/mm²")


# ---- from the steps --------------------------------------------------------------------------------------------------


def _plastic_work(setup: Setup, result: Result) -> Iterator[Warning]:
    """Since the start if the wire's past went that far."""
    limit = setup.limits.plastic_work
    first = next((step for step in result.steps if step.plastic_work_max_N_per_mm2 > limit), None)
    if first is not None:
        greatest = max(step.plastic_work_max_N_per_mm2 for step in result.steps)
        past = any(_work(shot) > limit for shot in result.snapshots[:1])
        yield beyond_validity(greatest, limit, setup.material, "the start" if past else place_of(first))


def _lift_off(setup: Setup, result: Result) -> Iterator[Warning]:
    lifted = [step for step in result.steps if step.lift_off_mm > 0.0]
    if lifted:
        greatest, place = max(step.lift_off_mm for step in lifted), place_of(lifted[0])
        message = (
            f"the spring lifts off a seat at {place}, by up to {greatest:.4g} mm: seats cannot pull, so they carry "
            "no force there; weak springs at its tips hold it in place"
        )
        yield Warning("lift-off", place, message, greatest, 0.0, "mm")


def _slipped(setup: Setup, result: Result) -> Iterator[Warning]:
    first = next((step for step in result.steps if _rise(step) < SLIPPED), None)
    if first is not None:
        least, place = min(_rise(step) for step in result.steps), place_of(first)
        message = (
            f"coils have slipped past each other since {place}: the rise from one to the next is {least:.2g} of that "
            "of coils stacked on each other; friction between coils (contact.friction.coils) may hold them"
        )
        yield Warning("coils slipped", place, message, least, SLIPPED)


def _wall(setup: Setup, result: Result) -> Iterator[Warning]:
    """At the end of a compression, but to block, where it is no result; a free spring that cools also gets shorter."""
    accuracy, free = setup.limits.accuracy or WALL_FORCE, FREE * result.greatest_force
    for before, step in pairwise(result.steps):
        travel = step.travel_mm - before.travel_mm
        ends = step.phase == before.phase and step.progress >= 1.0 and travel > 0.0 and step.force_N > free
        ends &= setup.phases[step.phase] != "block"
        if not ends or setup.is_force_given(step):  # the steeper it is, the smaller is the error of the height there
            continue
        rate = (step.force_N - before.force_N) / travel
        percent = steepness((before.travel_mm, step.travel_mm), (before.force_N, step.force_N), 1)
        if percent > VERTICAL:
            height = accuracy * step.force_N / abs(rate)
            message = (
                f"at {place_of(step)} the force changes by {rate:.3g} N/mm: the characteristic is "
                f"nearly vertical, as coils are closed or slip, and {100 * accuracy:.2g} % of the force correspond to "
                f"{height:.2g} mm of height"
            )
            yield Warning("wall", place_of(step), message, percent, VERTICAL)


def _rise(step: Step) -> float:
    return 1.0 if step.least_rise is None else step.least_rise


def _penetration(setup: Setup, result: Result) -> Iterator[Warning]:
    deepest, limit = max(result.steps, key=lambda step: step.penetration_mm, default=None), setup.limits.penetration
    if deepest is not None and deepest.penetration_mm > limit:
        depth, place = deepest.penetration_mm, place_of(deepest)
        message = f"coils or seats penetrate each other by {depth:.3g} mm at {place}, more than {limit:.3g} mm"
        yield Warning("penetration", place, message, depth, limit, "mm")


# ---- from what was found ---------------------------------------------------------------------------------------------


def _strength(setup: Setup, result: Result) -> Iterator[Warning]:
    strength = setup.limits.strength
    if strength is None or not result.snapshots:
        return
    greatest, shot = max(((_equivalent(shot), shot) for shot in result.snapshots), key=lambda pair: pair[0])
    if greatest > strength:
        message = (
            f"the equivalent stress is {greatest:.4g} MPa at {shot.name}, above the wire's minimum "
            f"tensile strength Rm of {strength:.4g} MPa"
        )
        yield Warning("strength", shot.name, message, greatest, strength, "MPa")


def _work(shot: Snapshot) -> float:
    return float(surface.component(shot.surface_state, shot.components, "b").max(initial=0.0))


def _equivalent(shot: Snapshot) -> float:
    return float(surface.equivalent(shot.surface_state, shot.components).max())


def _step_error(setup: Setup, result: Result) -> Iterator[Warning]:
    """The larger of the errors of maximum force and set; or that the former could not be estimated."""
    required = setup.limits.accuracy
    top = result.top
    if required is None or top is None or not top.force_N:
        return
    if is_turned(setup, result.steps) or stands_on_wall(setup, result.steps):
        return  # a force along the axis, here close to zero, or one that is no result
    if top.steps_force_error_N is None:
        if not abs(top.force_N) <= FREE * result.rate * setup.spring.free_length:  # also where the rate is not known
            message = (
                f"the step-size error of the maximum force could not be estimated ({place_of(top)}); "
                "compare the force with that of smaller steps"
            )
            yield Warning("unknown error", place_of(top), message, None, required)
        return
    worst, place = required * abs(top.steps_force_error_N) / allowed_force(setup, result), place_of(top)
    of = (f"the {force_in_words(setup, result)}", "")
    release = last_release(setup, result)
    error = None if release is None else release.set_error
    noticed = error is not None and abs(error) > NOTICED * setup.spring.free_length
    if release and error is not None and noticed and release.set > 0.0 and abs(error) > worst * release.set:
        worst, place, of = abs(error) / release.set, "set", ("the set", f"{abs(error):.2g} mm")
    warning = accuracy_warning(worst, required, place, *of)
    if warning is not None:
        yield warning


def _creep(setup: Setup, result: Result) -> Iterator[Warning]:
    """Time that passes hotter, at more stress or for longer than in the tests that the constants of creep are from."""
    tests = setup.limits.creep
    if tests is None:
        return
    before = [0.0, *(step.hours for step in result.steps)]
    timed = [step for step, hours in zip(result.steps, before, strict=False) if step.hours > hours]
    if not timed:
        return
    shots = [result.snapshots[phase] for phase in {step.phase for step in timed} if phase < len(result.snapshots)]
    reached = (
        ("temperature", "K", max(step.temperature_K for step in timed), tests.temperature),
        ("equivalent stress", "N/mm²", max((_equivalent(shot) for shot in shots), default=0.0), tests.stress),
        ("time", "h", timed[-1].hours, tests.hours),
    )
    for name, unit, value, (least, most) in reached:
        if value > most * (1.0 + ROUNDING):
            message = (
                f"the {name} is {value:.5g} {unit}, but the constants of creep are from tests of {least:g} to {most:g} "
                f"{unit}: the load loss is extrapolated"
            )
            yield Warning("creep", name, message, value, most, unit)


MORE = {
    "mesh": "more mesh.elements_per_turn reduce it",
    "section": "more points, mesh.section.radial and angular, reduce it",
    "contact": "a greater contact.bedding reduces it",
    "warping": "mesh.section.kind: warping reduces it",
    "steps": "a smaller accuracy or more steps reduce it",
}
"""What makes an error smaller, by its cause."""


def _more(cause: str, setup: Setup) -> str:
    if cause == "warping" and setup.sections.kind == "warping":
        return "a greater mesh.section.degree reduces it"
    return MORE[cause]


def allowed_force(setup: Setup, result: Result) -> float:
    """The error of the maximum force by the requested accuracy, N.

    Where the load program gives that force, the height under it is what was computed: it may be wrong by the accuracy
    of its travel, and the force at one height by as much as that changes it, which near block is more.
    """
    required, radius = setup.limits.accuracy or 0.0, turned_radius(setup, result.steps)
    top = max(result.steps, key=lambda step: abs(step.measured(radius)[1]), default=None)
    if top is None:
        return 0.0
    travel, allowed = map(abs, top.measured(radius))
    force, height = top.steps_force_error_N, top.steps_height_error_mm
    given = setup.is_torque_given(top) if radius else setup.is_force_given(top)
    if given and force and height:
        allowed = max(allowed, abs(travel * force / height))
    return required * allowed


def force_in_words(setup: Setup, result: Result) -> str:
    """What the error of the maximum force is one of."""
    if is_turned(setup, result.steps):
        return TURNED["force_N"]
    return "travel at the maximum force" if result.top and setup.is_force_given(result.top) else NUMBERS["force_N"]


def allowed_errors(setup: Setup, result: Result) -> dict[str, float]:
    """Errors by the requested accuracy of the numbers that it governs, by their names in Errors: of a set, at least
    one that is noticed; of the residual stress inside, STRESS times the accuracy of the largest stress there, and none
    in torsion.
    """
    required, release = setup.limits.accuracy or 0.0, last_release(setup, result)
    radius, found = turned_radius(setup, result.steps), {"force_N": allowed_force(setup, result)}
    if stands_on_wall(setup, result.steps):  # that force is no result
        del found["force_N"]
    left = 0.0 if release is None else set_of(release, radius)
    if left > 0.0 or (left and radius):
        found["set_mm"] = max(required * abs(left), NOTICED * setup.spring.free_length)
    if left > 0.0 and not radius:
        largest = max(abs(shear_inside(setup, one)[0]) for one in result.snapshots)
        found["residual_shear_inside_MPa"] = STRESS * required * largest
    return {name: error for name, error in found.items() if error > 0.0}


def _whole_error(setup: Setup, result: Result) -> Iterator[Warning]:
    """The numbers whose error by all causes is above the required accuracy."""
    required, errors = setup.limits.accuracy, result.errors
    if required is None or errors is None:
        return
    worst, words, radius = dict[str, float](), list[str](), turned_radius(setup, result.steps)
    for name, allowed in allowed_errors(setup, result).items():
        error = getattr(errors.total, name)
        if error is None:
            message = (
                f"the error of the {NUMBERS[name]} by mesh, section points, contact and warping could not be "
                "estimated; compare with a run of more mesh.elements_per_turn"
            )
            yield Warning("unknown error", "mesh", message, None, required)
            return
        if error > allowed:
            worst[name] = required * error / allowed
            is_force, size = name == "force_N", f"{error:.2g} {unit_of(name)}"
            if is_force:
                size = f"{apart(100 * worst[name], 100 * required)[0]} %"
            elif radius:
                size = f"{degrees(error / radius):.2g}°"
            words.append(f"{size} of the {force_in_words(setup, result) if is_force else NUMBERS[name]}")
    if worst:
        largest = max(worst, key=lambda name: worst[name])
        cause = errors.largest(largest)
        message = (
            f"the estimated error is {listed(words)}, mostly because of the {CAUSES[cause]}, more than the "
            f"case's accuracy of {100 * required:.2g} % allows; {result.finer or _more(cause, setup)}"
        )
        yield Warning("error", "mesh" if cause != "contact" else "contact", message, worst[largest], required)


def _errors(setup: Setup, result: Result) -> Iterator[Warning]:
    """The errors by all causes with the largest one; those by the steps where others are not known."""
    by_steps, whole = list(_step_error(setup, result)), list(_whole_error(setup, result))
    known = {"step error"}.issuperset(one.name for one in by_steps) and any(one.name == "error" for one in whole)
    yield from whole if known or not by_steps else by_steps


def _longer(setup: Setup, result: Result) -> Iterator[Warning]:
    """A spring that was only compressed and is longer afterwards; wire with stresses from coiling may lengthen."""
    release, limit = last_release(setup, result), LONGER * setup.spring.free_length
    if release is None or release.set >= -limit or setup.coiling_diameter is not None:
        return
    if any(step.force_N < -FREE * result.greatest_force or step.travel_mm < -limit for step in result.steps[:-1]):
        return
    tilt = max((end.tilt_rad for seats in result.seats[-1:] for end in (seats.bottom, seats.top)), default=0.0)
    if tilt * setup.spring.end_radius > -release.set:  # measured between seats that are not parallel
        return
    message = (
        f"the spring is {-release.set:.3g} mm longer after it was only compressed: either fixed ends yield in bending "
        "(compare with ends: seats), or the mesh is too coarse where coils close (compare with more "
        "mesh.elements_per_turn)"
    )
    yield Warning("negative set", "set", message, release.set, 0.0, "mm")


def _tension(setup: Setup, result: Result) -> Iterator[Warning]:
    """Of wound coils whose opening too few steps show."""
    if not (setup.initial_tension and result.complete and any(step.force_N < 0.0 for step in result.steps)):
        return
    first, after = tensions(result, last_release(setup, result))
    for held, when in ((first, "first pull"), (after, "last release")):
        if held is not None and held.points < FEW:
            state = "cannot be determined" if held.force is None else "has no known error"
            message = (
                f"the initial tension of the {when} {state}: coils are open in {held.points} of its steps, {FEW} "
                "are needed; give more steps, or pull further"
            )
            yield Warning("initial tension", when, message, held.points, FEW)


SEEN: tuple[WarningsOf, ...] = (_plastic_work, _lift_off, _slipped, _wall, _penetration)
FOUND: tuple[WarningsOf, ...] = (_strength, _creep, _errors, _longer, _tension)
