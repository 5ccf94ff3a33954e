"""Errors of mesh, section rule and contact, estimated by a companion: the same run on half of the elements.

The companion takes the steps that the run has taken, so that both have nearly the same error by their steps, and what
they differ by shows the error of the **mesh**: the difference is as large as the run's own error where that falls with
the first power of the elements' length, and three times as large where it falls with the second. Which part of it is
stated was measured: FORCE, SET and SHEAR. Where the largest residual stress is at the last section of the middle turns,
its change up to their end is added.

**Section**: a few of its sections are followed with a finer rule (`accuracy/followed_sections.py`). SECTION times
as much is stated.

**Warping**: `curved` sections of wire that is not round keep the elastic warping as they yield. Sections of four
elements, evenly spread, are followed in the same way as ones that warp freely, and SECTION times as much is stated. Of
those that do, the degree of the polynomials is followed: by how much HIGHER ones differ from the same with the finer
rule, DEGREE times.

**Contact**: bodies that lie in each other by p under pressures q hold the energy U = ½ Σ q p. Rigid ones hold none, and
by the principle of minimum potential energy their spring's is greater by U to first order: its force is greater by
dU/ds at the same travel, of which RIGID times as much is stated: U is taken again at a small further travel, so that it
does not depend on how long steps are. The wire is compressed by p = 2U/F less than the travel says, which bounds the
error of the set. Where coils stand on each other, the bedding takes a part ρ of all further travel, F ρ = dU/ds; the
stiffness of rigid ones is greater by 1/(1 − ρ) there, and with it the error of the force.
"""

import itertools
import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from coilset.meshes.springs.shapes import Table
from coilset.meshes.springs.stations import LEAST
from coilset.model.compose.load_history import LoadHistory
from coilset.model.core.base.agreement import sum_of_ranks
from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.case import Case
from coilset.model.core.case.case import SectionSpec
from coilset.model.core.case.warping import keeps_elastic_warping, warping_can_be_estimated
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.results.records.record import Errors, Result, RunErrors, Setup, Step, Working
from coilset.model.core.results.records.releases import FREE, Release, last_release, set_of, turned_radius
from coilset.model.core.results.stresses import change_of_sign, jump, shear_inside, to_the_end
from coilset.model.core.section.rules import polar
from coilset.model.physics.accuracy.followed_sections import FollowedSections
from coilset.model.tools.further_runs.working import working_states

log = logging.getLogger("coilset.steps")

FOLLOWED = 8  # elements whose sections are followed with the finer rule
RINGS, ANGLES = 12, 48  # of the finer rule at least
FINER_OUTLINE = 3  # times the points, of a section that is no disk
WARPING = 4  # elements whose sections are followed as ones that warp freely
HIGHER = 2  # by so many degrees, polynomials of sections that warp
STILL = 1e-9  # of the free length: a step of less travel is one of force or time
# Error by the mesh over the difference to the companion: a third by the second order, all of it by the first. In twelve
# springs with 8, 16 and 64 elements per turn the error at 16 was 0.00 to 0.7 of the difference of the forces, 0.01 to
# 1.8 of that of the sets, 0.05 to 0.9 of that of the residual stresses.
FORCE, SET, SHEAR = 0.75, 1.0, 1.0
# Of the jump between elements beside the largest residual stress. Where coils touch at single stations, it moves
# with the mesh, and two meshes may agree by chance: in the README's spring -70.7 to -71.0 MPa with 14 to 28 elements a
# turn, -71.4 to -71.5 with 40 to 130, beside jumps of 1.4 to 2.1 MPa. The largest error is 0.44 of the jump, and the
# shares of the other causes exceed the rest. In 25 springs of `verify stated-error` the difference to the companion is
# larger, or smaller by 0.1 of 147 MPa at most.
JUMP = 0.4
# A mesh of FINER times the elements leaves half of an error of first order and a quarter of one of second order. In
# twelve springs with ground ends the error at 16 elements per turn was 0.6 to 1.5 times the difference to it.
FINER, RATE = 2.0, 2.0
MANY = 10_000  # stations: no finer mesh
BESIDE = 0.01  # of the travel of the first touch
SECTION = 1.25  # of the difference to the finer rule, or to free warping, which have an error of their own
# Of the difference to the higher polynomials: kinks converge slowly. In rectangles at D/d = 3.2 to 10, far beyond
# yield, the error of the force with degree 8 was 2.1 to 3.4 of what degree 10 changes.
DEGREE = 3.0
RIGID = 1.5  # of dU/ds: with forty times the bedding, forces of seven springs rose by 0.9 to 1.5 times as much
TAKEN = 0.9  # part of the travel that the bedding takes at most: beyond, the force has no limit with rigid contacts
FURTHER = 1e-5  # of the free length: a travel over which the contacts' energy changes in proportion
BALANCE = FREE  # of the companion: with less of it, its released spring might not count as free of load
NOT_KNOWN = Errors(None, None, None)


def estimated(analysis: LoadHistory) -> Result:
    """The result of a complete run with the errors of its numbers; collective.

    Where the companion finds no equilibrium, only the error by the steps is known, and the log says so.
    """
    result, comm = analysis.result, analysis.comm
    radius = turned_radius(analysis.setup, result.steps)
    try:
        companion = LoadHistory(coarse_case(analysis.case, result.steps), comm, False)
        watch = _Watch(companion, radius)
        companion.run(watch)
        surfaces = watch.surface_errors()
        twins = working_states(companion, watch)
    except CoilsetError as error:
        log.info("mesh, section and contact: errors not estimated, the companion on half of the elements: %s", error)
        errors = RunErrors(_of_steps(analysis.setup, result), *[NOT_KNOWN] * 4)
        return replace(result, errors=errors)
    judged = _judged(analysis, companion, watch, surfaces) if comm.rank == 0 else None
    steps, errors = comm.bcast(judged)
    working = result.working and twins and _working(result.working, twins, watch)
    rate_error = None if radius else _rate_error(analysis)
    return replace(result, steps=steps, errors=errors, working=working, rate_error=rate_error)


def _rate_error(analysis: LoadHistory) -> float | None:
    """Error of the initial rate by mesh and contact, N/mm, None where it is not known; collective.

    Ends that are closed or ground first touch where the mesh lets them, and two coarse meshes may agree by chance: a
    finer one shows the error. Of very many elements it would need too much memory.
    """
    if len(analysis.setup.turns) > MANY:
        return None
    try:
        finer = LoadHistory(remeshed(analysis.case, FINER), analysis.comm, False)
        finer.settle_coils()
        by_mesh = RATE * abs(finer.initial_rate() - analysis.result.rate)
    except CoilsetError as error:
        log.info("initial rate: error not estimated, finer mesh: %s", error)
        return None
    control, continuation = finer.control, finer.continuation
    travel = continuation.control.probe * finer.spring.free_length

    def touched(travel: float) -> tuple[float, float]:
        load = control.to_height(control.height - travel)
        return continuation.probe(load, lambda: (control.trial_force, energy_of_contacts(finer)))[1]

    (force, energy), (_, after) = (touched(part * travel) for part in (1.0, 1.0 + BESIDE))
    return _known(by_mesh + _with_rigid_contacts((after - energy) / (BESIDE * travel), force) / travel)


def remeshed(case: Case, factor: float) -> Case:
    """A case with so many times the elements, at least the fewest that there may be."""
    mesh = case.mesh
    density = mesh.elements_per_turn
    if isinstance(density, Table):
        values = tuple(max(LEAST, factor * value) for value in density.values)
        made: Any = density.model_copy(update={"values": values})
    else:
        made = max(float(LEAST), factor * density)
    sagitta = None if mesh.sagitta is None else mesh.sagitta / factor**2
    return case.model_copy(update={"mesh": mesh.model_copy(update={"elements_per_turn": made, "sagitta": sagitta})})


def coarse_case(case: Case, steps: Sequence[Step]) -> Case:
    """The case of the companion: half of the elements, the steps of the run, no estimates, a balance of its own."""
    loading = []
    for number, phase in enumerate(case.loading):
        marks = [step.progress for step in steps if step.phase == number]
        if any(after <= before for before, after in itertools.pairwise(marks)):
            raise CoilsetError(f"phase {number + 1} was given another target on its way, which is not repeated")
        loading.append(phase.model_copy(update={"steps": [*marks[:-1], 1.0] if marks else 1}))
    update = {
        "loading": loading,
        "solver": case.solver.model_copy(update={"tolerance": BALANCE}),
        "accuracy": "none",
    }
    return remeshed(case, 0.5).model_copy(update=update)


@dataclass(frozen=True)
class _Seen:
    """The companion after one of its steps.

    Attributes:
        step: Step.
        section, warping, contact: error of the force by the section rule, by the warping and by contact, N.
        taken: travel that the bedding has taken, mm; 0 without a force.
    """

    step: Step
    section: float
    warping: float
    contact: float
    taken: float


def energy_of_contacts(history: LoadHistory) -> float:
    """Energy of the contacts' bedding at the last evaluation, N mm; collective."""
    layout, energy = history.system.layout, 0.0
    assert isinstance(layout, LineLayout)
    for part in history.system.last.contributions:
        counted = part.bears & layout.begins_here(part.dofs)  # contacts that join two ranks' parts are on both
        energy += 0.5 * float(part.pressure[counted] @ part.penetration[counted])
    return sum_of_ranks(history.comm, energy)


class _Watch:
    """Follows the companion's sections and notes the energy of its contacts; collective.

    Args:
        companion: that is followed.
        radius: by which travel and force are measured, see Step.
    """

    def __init__(self, companion: LoadHistory, radius: float) -> None:
        self.companion, self.comm, self.radius = companion, companion.comm, radius
        section, rule = companion.case.mesh.section, companion.rod.rule
        finer = polar(max(RINGS, 3 * section.radial // 2), max(ANGLES, 3 * len(rule) // (2 * section.radial)))
        outline, case = rule.outline, companion.case
        if outline is not None:
            finer = outline.rule(FINER_OUTLINE * len(rule))
        warps = outline is not None and section.kind == "warping"
        self.warps, self.left_out = warps, DEGREE if warps else SECTION
        past = case.spring if case.past else None
        follow = partial(FollowedSections, companion.rod, past, companion.setup.inside)
        self.finer = follow(WARPING if warps else FOLLOWED, section.kind, finer, case.section_degree)
        self.warping: FollowedSections | None = None
        if warps:
            self.warping = follow(WARPING, section.kind, finer, case.section_degree + HIGHER)
        elif (
            outline and keeps_elastic_warping(case, companion.spring) and warping_can_be_estimated(case, companion.law)
        ):
            usual, shape = SectionSpec(kind="warping"), case.wire_shape
            finer = outline.rule(max(len(usual.build(shape=shape)), len(rule)))
            self.warping = follow(WARPING, "warping", finer, usual.polynomials(shape))
        self.coil, self.greatest = 0.5 * companion.setup.spring.mean_diameter, 0.0
        self.seen, self.at = list[_Seen](), dict[int, int]()  # and which of them is that of a step, by its number

    def __call__(self, step: Step) -> None:
        self.greatest = max(self.greatest, step.load(self.coil))
        if not (self.seen and step.rests(self.seen[-1].step, self.greatest, self.coil)):
            self.seen.append(self._look_at(step))
        self.at[step.number] = len(self.seen) - 1

    def _look_at(self, step: Step) -> _Seen:
        """The companion after a step that loads or relaxes it; collective."""
        travel, force = step.measured(self.radius)
        travel -= self.seen[-1].step.measured(self.radius)[0] if self.seen else 0.0
        still = abs(travel) < STILL * self.companion.spring.free_length
        section = self.finer.follow(travel, still)
        warping = self.warping.follow(travel, still) if self.warping else 0.0
        warping = self.left_out * (warping - section if self.warps else warping)
        energy, loaded = self._energy(), abs(force) > FREE * self.greatest
        contact = _with_rigid_contacts(self._slope(force, energy), abs(force) if loaded else math.inf)
        return _Seen(step, section, warping, contact, 2.0 * energy / abs(force) if loaded else 0.0)

    def _energy(self) -> float:
        """Energy of the contacts' bedding at the last evaluation, N mm; collective."""
        return energy_of_contacts(self.companion)

    def _slope(self, force: float, energy: float) -> float:
        """Change of the energy over a travel that makes the force greater, N; not a number if none is found;
        collective."""
        control, continuation = self.companion.control, self.companion.continuation
        further = math.copysign(FURTHER * control.free_length, force)
        for travel in (further, -further):
            outcome, after = continuation.probe(control.to_travel(travel), self._energy)
            if outcome.converged:
                return math.copysign(1.0, travel * further) * (after - energy) / abs(travel)
        return math.nan

    def surface_errors(self) -> tuple[float, float]:
        """Errors of the shear stress at the inside by the section rule and by the warping, MPa; collective."""
        warping = self.left_out * self.warping.surface_error() if self.warping else 0.0
        return SECTION * self.finer.surface_error(), warping


@dataclass(frozen=True)
class _StepErrors:
    """Errors of one step by mesh, section rule, contact and warping: of the force, N, and of the height, mm."""

    forces: tuple[float, ...]
    heights: tuple[float, ...]


def _judged(
    analysis: LoadHistory, companion: LoadHistory, watch: _Watch, surfaces: tuple[float, float]
) -> tuple[tuple[Step, ...], RunErrors]:
    """The steps with their total errors, and the errors of the run's numbers; on rank 0."""
    setup, result, seen, radius = analysis.setup, analysis.result, watch.seen, watch.radius
    at = {_place(step): watch.at[step.number] for step in companion.result.steps}
    steps, found = list[Step](), list[_StepErrors]()
    coil = 0.5 * setup.spring.mean_diameter
    greatest = max(step.load(coil) for step in result.steps)
    before, stiffness = (0.0, 0.0), result.rate
    for step in result.steps:
        now = step.measured(radius)
        way, rise = now[0] - before[0], now[1] - before[1]
        rests, before = bool(steps) and step.rests(steps[-1], greatest, coil), now
        if not rests and rise and abs(way) > STILL * analysis.spring.free_length:
            stiffness = abs(rise / way)
        found.append(found[-1] if rests else _step_errors(step, watch, at.get(_place(step)), stiffness))
        steps.append(_with_errors(step, found[-1]))
    top = steps.index(max(steps, key=lambda step: abs(step.measured(radius)[1])))
    forces, release = [_known(value) for value in found[top].forces], last_release(setup, result)
    sets: list[float | None] = [None] * 4
    shears: list[float | None] = [None] * 4
    mine = _of_steps(setup, result)
    theirs = last_release(companion.setup, companion.result)
    if release is not None and theirs is not None:
        number = result.steps.index(release.step)
        by_mesh = abs(set_of(theirs, radius) - set_of(release, radius))
        sets = [SET * by_mesh, *map(_known, found[number].heights[1:])]
        sets[2] = _by_contact(seen, abs(set_of(release, radius)), radius)
    if release is not None and theirs is not None and not radius:
        slope, other = _shear_slope(setup, result, release), shear_inside(companion.setup, theirs.snapshot)[0]
        shears = [None if one is None else slope * one for one in sets]
        by_mesh = SHEAR * abs(other - shear_inside(setup, release.snapshot)[0])
        by_mesh = max(by_mesh, JUMP * jump(setup, release.snapshot))
        by_mesh += to_the_end(setup, release.snapshot)
        for k, surface in zip((1, 3), surfaces, strict=True):
            shears[k] = None if (shear := shears[k]) is None else shear + surface
        by_mesh += change_of_sign(setup, release.snapshot, by_mesh + sum(one or 0.0 for one in shears[1:]))
        shears[0] = by_mesh
    return tuple(steps), RunErrors(mine, *(Errors(*values) for values in zip(forces, sets, shears, strict=True)))


def _working(working: Working, twins: Working, watch: _Watch) -> Working:
    """Working states with their errors, by the companion's, its `twins`."""
    states = []
    for state, twin in zip(working.states, twins.states, strict=True):
        if state.step and twin.step:
            errors = _step_errors(state.step, watch, watch.at[twin.step.number], abs(state.rate))
            state = replace(state, step=_with_errors(state.step, errors))
        states.append(state)
    return replace(working, states=tuple(states))


def _with_errors(step: Step, errors: _StepErrors) -> Step:
    """A step with the sums of its errors."""
    force, height = (
        _total(own, others)
        for own, others in (
            (step.steps_force_error_N, errors.forces),
            (step.steps_height_error_mm, errors.heights),
        )
    )
    return replace(step, estimated_force_error_N=force, estimated_height_error_mm=height)


def _place(step: Step) -> tuple[int, float]:
    return step.phase, round(step.progress, 9)


def _known(value: float) -> float | None:
    return abs(value) if math.isfinite(value) else None


def _total(steps: float | None, others: Sequence[float]) -> float | None:
    return None if steps is None else _known(abs(steps) + sum(map(abs, others)))


def _step_errors(step: Step, watch: _Watch, number: int | None, stiffness: float) -> _StepErrors:
    """The errors of a step, which the companion has taken as its step `number`; not numbers where it has not."""
    if number is None:
        return _StepErrors((math.nan,) * 4, (math.nan,) * 4)
    one = watch.seen[number]
    (travel, force), (there, found) = (each.measured(watch.radius) for each in (step, one.step))
    mesh = FORCE * (abs(found - force) + abs(there - travel) * stiffness)
    forces = mesh, SECTION * one.section, one.contact, one.warping
    return _StepErrors(forces, tuple(value / stiffness if stiffness else math.nan for value in forces))


def _with_rigid_contacts(slope: float, force: float) -> float:
    """By how much the force is greater with rigid contacts: RIGID dU/ds / (1 − ρ), N."""
    return RIGID * abs(slope) / (1.0 - min(max(slope / force, 0.0), TAKEN))


def _by_contact(seen: Sequence[_Seen], most: float, radius: float) -> float | None:
    """Bound of the error of the set by what the bedding has taken at the maximum force, mm, and at most the set: where
    wire flows, all of it stays. None of a spring without a force."""
    top = max(seen, key=lambda one: abs(one.step.measured(radius)[1]))
    return min(top.taken, most) if top.step.measured(radius)[1] else None


def _shear_slope(setup: Setup, result: Result, release: Release) -> float:
    """Change of the shear stress at the inside over the height of the release, MPa/mm; 0 of one that was not loaded."""
    number = next(k for k, shot in enumerate(result.snapshots) if shot is release.snapshot)
    free = FREE * result.greatest_force
    loaded = next((shot for shot in result.snapshots[number - 1 :: -1] if abs(shot.force) > free), release.snapshot)
    way = release.step.seat_height_mm - loaded.height
    return abs((shear_inside(setup, release.snapshot)[0] - shear_inside(setup, loaded)[0]) / way) if way else 0.0


def _of_steps(setup: Setup, result: Result) -> Errors:
    """Errors by the length of the steps."""
    radius, release = turned_radius(setup, result.steps), last_release(setup, result)
    force = max(result.steps, key=lambda step: abs(step.measured(radius)[1])).steps_force_error_N
    error = None if release is None else release.set_error
    known = release is not None and error is not None
    shear = _shear_slope(setup, result, release) * abs(error) if release and error is not None and not radius else None
    return Errors(None if force is None else abs(force), abs(error) if known and error is not None else None, shear)
