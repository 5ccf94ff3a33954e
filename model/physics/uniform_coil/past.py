"""The uniform coil of a wire that was coiled and stress-relieved, at rest before its first load.

In few increments, and in two attempts at its shape: what they leave is smooth in the constants of the law, and small
beside what the uniform coil lacks of a spring anyway.
"""

import numpy as np

from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point.over_step import law_over_step
from coilset.model.core.section.rules import polar, upper_half
from coilset.model.physics.manufacture.coiling import bent
from coilset.model.physics.manufacture.entries import Relief
from coilset.model.physics.manufacture.initial_state import relief_intervals
from coilset.model.physics.manufacture.wire import Wire
from coilset.model.physics.uniform_coil.rod import UniformState, unloaded

INCREMENTS, INTERVALS, ATTEMPTS = 10, 4, 2
TIGHTER = 1.1  # as which the wire is bent at first, over the spring's curvature
DISK = polar(6, 16, staggered=False)  # of its upper half are the points that `press` takes by default
MIRRORED = (1, 4)  # τ₁₂ and B₁₂: y points outward in the uniform coil, towards the centre where wire is coiled


def coiled(one: np.ndarray, law: Law, relief: Relief | None, temperature: float | None = None) -> UniformState:
    """One coil at rest with the stresses that coiling and stress relief leave.

    Args:
        one: wire diameter, mean diameter, pitch in mm, number of turns, shape (4,).
        law: material that the return map suffices for, but for its creep.
        relief: entries of a case; None: it was not relieved.
        temperature: of the spring, K; default is the law's reference temperature.

    Raises:
        SolveError: if a section finds no equilibrium.
    """
    at = law.reference_temperature if temperature is None else temperature
    parameters = law.parameters(at)
    intervals = relief_intervals(law, parameters, at, relief, INTERVALS)
    virgin = law_over_step(law, parameters, at, 3).unstressed()
    d, D, pitch, _ = one
    wanted = np.array([0.5 * D, pitch / (2.0 * np.pi)])
    wanted /= wanted @ wanted  # curvature and torsion
    turned = TIGHTER * wanted
    for _ in range(ATTEMPTS):
        wire = Wire.of_disk(parameters, DISK, 0.5 * d, True, virgin, np.empty((0, 2)))
        wire, _, _ = bent(wire, turned, wanted[0], intervals, INCREMENTS)
        turned = turned - (wire.curvature - wanted)
    rule = upper_half(DISK)
    outward = DISK.points * [-1.0, 1.0]
    state = unloaded(one, law, rule, temperature)
    state.points[0] = wire.states[[int(np.argmin(np.hypot(*(outward - point).T))) for point in rule.points]]
    state.points[0][:, MIRRORED] *= -1.0
    return state
