"""Release to zero force of a body that is driven by displacements: first along its rate, then by secants."""

from collections.abc import Callable

import numpy as np

from coilset.model.base.errors import SolveError

MAX_SECANTS = 20
PROBE = 0.01  # part of the travel by which the rate of release is measured


def release(go: Callable[[float], float], travel: float, force: float, steps: int, limit: float) -> None:
    """Go back to zero force.

    Args:
        go: goes to a travel, mm, and returns the force there, N.
        travel, force: where the release begins, mm and N.
        steps: equal ones to where the rate of release brings the force to zero, after a small one that shows the rate.
        limit: force that may be left, N.

    Raises:
        SolveError: if the force does not come to zero, or as `go`.
    """
    first = travel * (1.0 - PROBE)
    before, last = (travel, force), (first, go(first))
    rate = (before[1] - last[1]) / (before[0] - last[0])
    reach = last[1] / rate
    for part in np.arange(1, steps + 1) / steps:
        target = first - reach * part
        before, last = last, (target, go(target))
    for _secant in range(MAX_SECANTS):
        if abs(last[1]) <= limit:
            return
        secant = (last[1] - before[1]) / (last[0] - before[0])
        target = last[0] - last[1] / np.clip(secant, 0.5 * rate, 1.5 * rate)
        before, last = last, (target, go(target))
    raise SolveError(f"the force does not come below {limit:g} N on release")
