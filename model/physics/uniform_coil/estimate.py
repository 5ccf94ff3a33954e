"""Results of a case estimated by the uniform rod, in milliseconds: for designs, large sweeps and control variates.

A spring of another shape is replaced by the cylinder with the same compliance and mean wire diameter. Ends, contact and
bowing are neglected.
"""

from contextlib import suppress
from dataclasses import dataclass
from math import isfinite, pi, sqrt

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import SolveError
from coilset.model.core.case.case import Case
from coilset.model.core.case.phases import Phase
from coilset.model.core.case.targets import check_targets, check_working
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.records.releases import FREE
from coilset.model.core.section.rules import polar, upper_half
from coilset.model.physics.uniform_coil.equivalent import coil
from coilset.model.physics.uniform_coil.rod import UniformState, press
from coilset.model.physics.working.entries import WorkingSpec

STEPS = 6  # of a phase
PROBE = 1e-3  # of the free length, for the initial rate
RULE = upper_half(polar(5, 12, staggered=False))
TORSION = 2  # of the sections' N, Q₃, Mt, M₃


@dataclass(frozen=True)
class Estimate:
    """A case by the uniform rod.

    Attributes:
        numbers: entries of the summary that it has, and `force k`, the force at the end of phase k.
        torque: maximum torque in the wire over that at which its surface yields; 0 for an elastic law.
    """

    numbers: dict[str, float]
    torque: float


def estimate(case: Case, spring: Spring, law: Law) -> Estimate:
    """Take the uniform rod through the load program of a case.

    Args:
        case, spring, law: the case, its spring and its material, built.

    Raises:
        InputError: if the spring cannot reach a target.
        SolveError: if no equilibrium is found.
    """
    check_targets(case, spring, law.G)
    check_working(case, spring, law.G)
    length, free = spring.free_length, case.ends_turn
    one, temperature = coil(spring), case.temperature
    found = {"free_length_before_mm": length, "block_height_mm": spring.block_height}
    probe, _ = press(one, law, travels=np.array([PROBE * length]), rule=RULE, free_ends=free, temperature=temperature)
    found["rate_N_per_mm"] = float(probe[0, 0]) / (PROBE * length)
    state: UniformState | np.ndarray = one
    travel, force, greatest, torque = 0.0, 0.0, 0.0, 0.0
    for number, phase in enumerate(case.loading):
        # time passes or a head moves sideways: the uniform rod models neither
        if not isinstance(phase, Phase) or not phase.drives_axially:
            continue
        kind, end = phase.goal(length, spring.block_height)
        begin, end = (force, end) if kind == "force" else (travel, length - end)
        way = np.linspace(begin, end, STEPS + 1)[1:]
        travels, forces = (None, way) if kind == "force" else (way, None)
        _, state = press(state, law, travels, forces, RULE, free, temperature)
        travel, force = float(state.travel[0]), float(state.force[0])
        greatest = max(greatest, force, key=abs)
        torque = max(torque, abs(float(state.sections[0, TORSION])))
        found[f"force {number}"] = force
    found["force_max_N"] = greatest
    if force == 0.0 or abs(force) < FREE * abs(greatest):
        if case.release == "free":
            with suppress(SolveError):  # a coil wound solid that is pulled may have none: it stays between its ends
                _, freed = press(state, law, None, np.zeros(1), RULE, True, temperature)
                state, travel = freed, float(freed.travel[0])
        found |= {"free_length_after_mm": length - travel, "set_mm": travel}
    if case.working is not None:
        found |= _working(case.working, state, law, free, temperature, length)
    # τ = √(k²/2) in torsion (3.1.4), T = π d³ τ / 16
    yielding = law.first_yield(temperature) / sqrt(3.0) * pi * one[0] ** 3 / 16.0
    return Estimate(found, torque / yielding if isfinite(yielding) else 0.0)


def _working(
    working: WorkingSpec,
    state: UniformState | np.ndarray,
    law: Law,
    free: bool,
    temperature: float | None,
    length: float,
) -> dict[str, float]:
    """Forces at the working lengths and lengths under the working forces, each from the end of the load program."""
    found = {}
    for at in working.lengths:
        forces, _ = press(state, law, np.array([length - at]), None, RULE, free, temperature)
        found[f"force_at_{at:g}_N"] = float(forces[0, 0])
    for at in working.forces:
        travels, _ = press(state, law, None, np.array([at]), RULE, free, temperature)
        found[f"length_at_{at:g}_mm"] = length - float(travels[0, 0])
    return found
