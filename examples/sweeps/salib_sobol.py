"""SALib samples and analyses, coilset computes: what part of the set's variance each tolerance causes.

    scripts/coilset python examples/sweeps/salib_sobol.py [FOLDER] [SAMPLES]

SAMPLES is a power of 2; (inputs + 2) × SAMPLES springs are computed.
"""

import sys
from pathlib import Path

import numpy as np
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

from coilset.api import Study

folder = sys.argv[1] if len(sys.argv) > 1 else "results/sobol"
samples = int(sys.argv[2]) if len(sys.argv) > 2 else 64

names = ["spring.wire_diameter", "spring.mean_diameter", "spring.pitch"]
problem = {"num_vars": 3, "names": names, "bounds": [[4.95, 5.05], [39.5, 40.5], [11.7, 12.3]]}
points = sampling.sample(problem, samples, calc_second_order=False, seed=1)

springs = Study(Path(__file__).with_name("scatter.yaml"), folder)
trials = springs.ask(values=[dict(zip(names, map(float, point), strict=True)) for point in points])
found = springs.evaluate(trials, jobs=2)
springs.close()

sets = np.array([np.nan if summary is None else summary["set_mm"] for summary in found])
indices = analysis.analyze(problem, sets, calc_second_order=False, seed=1)
for name, first, total in zip(names, indices["S1"], indices["ST"], strict=True):
    print(f"{name:24s} first {first:5.2f}, total {total:5.2f}")
# the set of a spring pressed to block is nearly additive in these small tolerances: first-order indices sum to one
assert abs(indices["S1"].sum() - 1.0) < 0.1
