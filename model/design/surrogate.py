"""The uniform rod in place of a spring: estimates a run's results in milliseconds, as a first guess and for slopes.

A spring of another shape is replaced by the cylinder with the same compliance and mean wire diameter. Ends, contact and
bowing are neglected; the search learns their effect on the results.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite, pi, sqrt

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.base.errors import SolveError
from coilset.model.case.case import Case
from coilset.model.case.phases import Phase
from coilset.model.case.targets import check_targets
from coilset.model.design.conditions import Condition
from coilset.model.material import library
from coilset.model.material.law.law import Law
from coilset.model.section.rules import polar, upper_half
from coilset.model.standards.wires.law import case_law
from coilset.model.uniform.rod import UniformState, press

STEPS = 6  # of a phase
PROBE = 1e-3  # of the free length, for the initial rate
RULE = upper_half(polar(5, 12, staggered=False))
TORSION = 2  # of the sections' N, Q₃, Mt, M₃


@dataclass(frozen=True)
class Guess:
    """Estimate by the uniform rod.

    Attributes:
        values: of the conditions, shape (m,); NaN for those that the uniform rod cannot compute.
        torque: maximum torque in the wire over that at which its surface yields; 0 for an elastic law.
    """

    values: np.ndarray
    torque: float


def coil(spring: Spring) -> np.ndarray:
    """Wire diameter, mean diameter, pitch (mm) and turns of the equivalent cylinder, shape (4,).

    Its turns are the active ones, its compliance ∝ ∫ D³/d⁴ dt that of the spring.
    """
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    t = np.linspace(start, end, 257)
    middle = 0.5 * (t[1:] + t[:-1])
    d = spring.wire_diameter(middle)
    mean = float(d.mean())
    D = float(np.mean((2.0 * spring.mean_radius(middle)) ** 3 / d**4) * mean**4) ** (1.0 / 3.0)
    pitch = float(spring.height(end) - spring.height(start)) / (end - start)
    return np.array([mean, D, pitch, end - start])


def guess(case: Case, conditions: Sequence[Condition], load: Callable[[str], Law] = library.load) -> Guess:
    """Take the uniform rod through the load program of a case.

    Args:
        case, conditions: to run, and the results that are needed.
        load: gives the law of a material's name.

    Raises:
        InputError: if spring or material cannot be built, or the spring cannot reach a target.
    """
    spring = case.spring.build()
    law = load(case.material) if isinstance(case.material, str) else case_law(case, spring)
    check_targets(case, spring, law.G)
    unknown = np.full(len(conditions), np.nan)
    try:
        found, torque = _press(case, spring, law)
    except SolveError:
        return Guess(unknown, 0.0)
    values = [found.get(one.short_name if one.phase is None else f"force {one.phase}", np.nan) for one in conditions]
    return Guess(np.array(values), torque)


def _press(case: Case, spring: Spring, law: Law) -> tuple[dict[str, float], float]:
    length, free = spring.free_length, case.ends_turn
    one, temperature = coil(spring), case.temperature
    found = {"free_length_before_mm": length, "block_height_mm": spring.block_height}
    probe, _ = press(one, law, travels=np.array([PROBE * length]), rule=RULE, free_ends=free, temperature=temperature)
    found["rate_N_per_mm"] = float(probe[0, 0]) / (PROBE * length)
    state: UniformState | np.ndarray = one
    travel, force, greatest, torque = 0.0, 0.0, 0.0, 0.0
    for number, phase in enumerate(case.loading):
        # time passes or a head moves sideways: the uniform rod knows neither
        if not isinstance(phase, Phase) or not phase.drives_axially:
            continue
        kind, end = phase.goal(length, spring.block_height)
        begin, end = (force, end) if kind == "force" else (travel, length - end)
        way = np.linspace(begin, end, STEPS + 1)[1:]
        travels, forces = (None, way) if kind == "force" else (way, None)
        _, state = press(state, law, travels, forces, RULE, free, temperature)
        travel, force = float(state.travel[0]), float(state.force[0])
        greatest = max(greatest, abs(force))
        torque = max(torque, abs(float(state.sections[0, TORSION])))
        found[f"force {number}"] = force
    found["force_max_N"] = greatest
    if force == 0.0 or abs(force) < 1e-6 * greatest:
        found |= {"free_length_after_mm": length - travel, "set_mm": travel}
    # τ = √(k²/2) in torsion (3.1.4), T = π d³ τ / 16
    yielding = law.first_yield(temperature) / sqrt(3.0) * pi * one[0] ** 3 / 16.0
    return found, torque / yielding if isfinite(yielding) else 0.0
