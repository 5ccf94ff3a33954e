"""Surge: a spring whose top head is driven over time, from the state at the end of its load program."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import InputError
from coilset.model.core.case.material import case_elastic
from coilset.model.core.contact.base import LEVEL
from coilset.model.core.equilibrium.system.heads import AXIAL
from coilset.model.physics.vibration.at_rest import AtRest
from coilset.model.physics.vibration.lift import Lift
from coilset.model.physics.vibration.surge import SPECTRAL_RADIUS, Energies, Motion

MOST_STEPS = 1_000_000
LIGHT = 1e-6  # of its density has a wire that is pressed slowly: its waves are a thousand times as fast
FEWEST = 8  # steps in a lift: with fewer the run with steps twice as long hardly sees it
A_PERIOD, AFTERWARDS = 20, 5.0  # steps in a period of the first axial mode, and periods after the lift, if not given


@dataclass(frozen=True)
class Surge:
    """A driven spring over time.

    Attributes:
        time: s, shape (steps + 1,); the first is the state at rest.
        height: between the heads or seats, mm, shape (steps + 1,).
        top, bottom: forces of the heads or seats on the spring along its axis, compression positive, N, shape
            (steps + 1,).
        level: height of the wire's stations above the bottom seat or head, mm, shape (steps + 1, stations).
        contacts: number of closed contact elements, shape (steps + 1,).
        kinetic, stored, supplied, lost: energies of Energies, N mm, shape (steps + 1,).
    """

    time: np.ndarray
    height: np.ndarray
    top: np.ndarray
    bottom: np.ndarray
    level: np.ndarray
    contacts: np.ndarray
    kinetic: np.ndarray
    stored: np.ndarray
    supplied: np.ndarray
    lost: np.ndarray

    def force_error(self, coarser: "Surge") -> float:
        """Estimated size of the error of both forces by the time step, N, from a run with steps twice as long.

        The largest difference at common times: the method is of second order for waves that the steps resolve, but the
        largest errors, of waves that they do not, fall little faster than the step. Where coils clash, the times of
        impact differ, and it is an estimate of that.
        """
        pairs = ((self.top, coarser.top), (self.bottom, coarser.bottom))
        return float(max(np.abs(fine[::2] - coarse).max() for fine, coarse in pairs))


@dataclass(frozen=True)
class Driven:
    """A lift and what it is compared with.

    Attributes:
        fine: Surge; coarse: the same with steps twice as long; slow: the same steps as coarse, without inertia.
        step: of time of the fine one, s.
        axial: frequency of the first axial mode at the beginning, Hz.
    """

    fine: Surge
    coarse: Surge
    slow: Surge
    step: float
    axial: float

    @property
    def error(self) -> float:
        """Estimated size of the error of the forces by the time step, N."""
        return self.fine.force_error(self.coarse)


def driven(
    analysis: Callable[[], AtRest],
    lift: Lift,
    step: float | None = None,
    seconds: float | None = None,
    report: Callable[[str], object] = lambda line: None,
) -> Driven:
    """Drive a spring three times: slowly, with long steps of time, and with steps half as long; collective.

    Args:
        analysis: a spring at rest after its load program; called for each run.
        step: of time, s; default is a 20th of the period of the first axial mode.
        seconds: duration; default is that of the lift and five periods more.
        report: called with a line before each run.

    Raises:
        InputError: the lift is beyond the height of the spring, or a number has no meaning.
        SolveError: no equilibrium was found.
    """
    from coilset.model.physics.vibration.modes import loaded_modes  # it loads SLEPc

    last = analysis()
    rest = last.control.height
    if not lift.greatest < rest:
        raise InputError(f"{lift.greatest:g} mm is more than the height of the spring, {rest:.4g} mm", "--lift")
    modes = loaded_modes(last, A_PERIOD)
    axial = float(modes.frequencies[modes.masses[:, 2].argmax()])
    step = 1.0 / (A_PERIOD * axial) if step is None else step
    seconds = lift.seconds + AFTERWARDS / axial if seconds is None else seconds
    _check(seconds, 2.0 * step, "--step")
    if lift.seconds < FEWEST * step * (1.0 - 1e-9):
        raise InputError(
            f"{step:.3g} s, but the lift is over in {lift.seconds:.3g} s; give {lift.seconds / FEWEST:.3g} s or less",
            "--step",
        )
    pairs = int(np.ceil(seconds / (2.0 * step)))
    density, found = case_elastic(last.case, last.law).density, []
    kinds = (("slowly", 2, LIGHT), ("with long steps", 2, 1.0), ("with short steps", 1, 1.0))
    for words, length, part in kinds:
        report(f"{words}: {2 * pairs // length} steps of {1e3 * step * length:.3g} ms")
        spring = last if length == 1 else analysis()
        run = surge(
            spring, lambda time: rest - lift.travel(time), 2 * pairs * step, length * step, density=part * density
        )
        found.append(run)
    slow, coarse, fine = found
    return Driven(fine, coarse, slow, step, axial)


def _check(seconds: float, step: float, place: str) -> None:
    if not 0.0 < step <= seconds or not seconds / step <= MOST_STEPS:
        raise InputError(f"steps of {step:g} s in {seconds:g} s; give up to {MOST_STEPS:,} steps", place)


def surge(
    analysis: AtRest,
    height: Callable[[float], float],
    seconds: float,
    step: float,
    spectral_radius: float = SPECTRAL_RADIUS,
    density: float | None = None,
) -> Surge:
    """Drive the top head of a spring over time, from its last equilibrium at rest; collective.

    Args:
        analysis: the spring after its load program.
        height: between the heads or seats, mm, at a time, s; it should begin where the spring is.
        seconds: duration; step: Δt, s, cut where contacts require it.
        spectral_radius: ρ of `Motion`.
        density: kg/mm³; default is that of the case's wire.

    Raises:
        InputError: duration or step have no meaning.
        SolveError: no equilibrium was found.
    """
    _check(seconds, step, "step")
    if not 0.0 <= spectral_radius <= 1.0:
        raise InputError(f"{spectral_radius:g} is not possible; give 0 to 1", "spectral_radius")
    system, control = analysis.system, analysis.control
    density = case_elastic(analysis.case, analysis.law).density if density is None else density
    motion = Motion(system, analysis.newton, density, spectral_radius=spectral_radius)
    rows: list[tuple] = []

    def keep() -> None:
        reactions, clamped = control.reactions("equilibrium"), control.clamped
        inertia = [motion.inertia_at(int(control.dofs[freedom])) if clamped else 0.0 for freedom in (AXIAL, LEVEL)]
        level = system.line.gather(system.state["x"].equilibrium)[:, 2].copy()
        energies: Energies = motion.energies
        forces = -(reactions[AXIAL] + inertia[0]), reactions[LEVEL] + inertia[1]
        numbers = energies.kinetic, energies.stored, energies.supplied, energies.lost
        rows.append((motion.time, control.height, *forces, level, system.last.closed, *numbers))

    system.restore()
    keep()
    for k in range(1, round(seconds / step) + 1):
        motion.go(lambda time: control.to_height(height(time)), k * step)
        keep()
    return Surge(*(np.array(column) for column in zip(*rows, strict=True)))
