"""A step control of one's own: steps that become longer by a constant factor along each phase.

scripts/coilset python examples/own/steps.py
"""

import numpy as np

from coilset.api import Case, solve
from coilset.model.core.equilibrium.path.step_sizes import Path, StepSizes

FIRST, FACTOR = 0.02, 1.5  # of a phase, and from step to step


class Growing(StepSizes):
    """Steps of 2 %, 3 %, 4.5 % … of a phase; after a cut the shorter step is made first."""

    def size(self, path: Path) -> float:
        """Size of the step to try now, in regular steps, of which a phase has `path.regular`."""
        allowed = super().size(path)
        done = self.position.done / path.regular
        number = np.log1p(done * (FACTOR - 1.0) / FIRST) / np.log(FACTOR)  # steps so far: a geometric series
        return min(path.regular * FIRST * FACTOR ** round(number), allowed)


spring = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
steps = {"solver": {"control": {"steps": {"largest": 10.0, "growth": 10.0}}}}
case = Case({"spring": spring, "material": "ck15", "loading": [{"to": {"travel": 14.0}}], **steps})
result = solve(case, steps=Growing)
length = np.diff([0.0, *result.travel])
print("steps of", *(f"{one:.2f}" for one in length), "mm")
assert abs(length[0] - 0.02 * 14.0) < 1e-9
assert np.allclose(length[1:4] / length[:3], FACTOR)
assert abs(result.travel[-1] - 14.0) < 1e-9
