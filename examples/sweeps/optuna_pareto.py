"""Optuna chooses springs, coilset computes them: small mass and small set at once (Pareto front).

    scripts/coilset python examples/sweeps/optuna_pareto.py [FOLDER] [TRIALS]

The study's folder keeps every result: started again, it goes on.
"""

import sys
from itertools import pairwise
from math import hypot, pi
from pathlib import Path

import optuna

from coilset.api import Study

DENSITY = 7.85e-6  # kg/mm³, of steel
folder = sys.argv[1] if len(sys.argv) > 1 else "results/pareto"
trials = int(sys.argv[2]) if len(sys.argv) > 2 else 60

optuna.logging.set_verbosity(optuna.logging.WARNING)
search = optuna.create_study(directions=["minimize", "minimize"], sampler=optuna.samplers.NSGAIISampler(seed=1))
springs = Study(Path(__file__).with_name("scatter.yaml"), folder)
for _ in range(trials // 10):
    asked = [search.ask() for _ in range(10)]
    values = [
        {
            "spring.wire_diameter": trial.suggest_float("wire diameter", 4.5, 5.5),
            "spring.mean_diameter": trial.suggest_float("mean diameter", 36.0, 44.0),
            "spring.pitch": trial.suggest_float("pitch", 10.0, 13.0),
        }
        for trial in asked
    ]
    found = springs.evaluate(springs.ask(values=values), jobs=2)
    for trial, given, summary in zip(asked, values, found, strict=True):
        if summary is None:
            search.tell(trial, state=optuna.trial.TrialState.FAIL)
            continue
        turn = hypot(pi * given["spring.mean_diameter"], given["spring.pitch"])
        mass = DENSITY * 2.5 * turn * pi * given["spring.wire_diameter"] ** 2 / 4.0
        search.tell(trial, [mass, summary["set_mm"]])
springs.close()

front = sorted(search.best_trials, key=lambda trial: trial.values[0])
for trial in front:
    print(f"{1e3 * trial.values[0]:6.1f} g, set {trial.values[1]:6.2f} mm: {trial.params}")
# none of the front is better in both: as mass rises, the set falls
assert all(a.values[1] >= b.values[1] for a, b in pairwise(front))
