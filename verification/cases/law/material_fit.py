"""Identification of Ck 15's constants from synthetic tests with 1 % noise: each within its stated uncertainty

Four tests of the law itself (tension to 50 %, reversed torsion, tension then torsion, torsion then tension), driven
through one point by Heun's method with a tolerance of 1e-6. Normally distributed noise of 1 % of the maximum stress of
the test is added to every stress reading. The stated uncertainty should hold for all constants together with 95 %
confidence, which is 2.81 standard deviations for ten free constants: a constant outside is to be expected in one series
out of twenty. Such tests determine b1*, where the two branches of k² meet, least well. The data in
examples/material/fit/ are those of seed 1.
"""

from collections.abc import Iterable, Iterator

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.tools.identification import fit, programs
from coilset.model.tools.identification.experiments import Test
from coilset.verification.references import heun
from coilset.verification.study import Study

NOISE = 0.01  # of the maximum stress of each test
SERIES = 10
PROGRAMS = {  # targets and increments
    "tension": (({"eps11": 0.02}, 200), ({"eps11": 0.5}, 480)),
    "reversed_torsion": (
        ({"gamma12": 0.03}, 200),
        ({"gamma12": 0.1}, 100),
        ({"gamma12": 0.07}, 200),
        ({"gamma12": -0.05}, 150),
    ),
    "tension_torsion": (({"eps11": 0.06}, 200), ({"gamma12": 0.02}, 150), ({"gamma12": 0.1}, 150)),
    "torsion_tension": (({"gamma12": 0.1}, 200), ({"eps11": 0.012}, 150), ({"eps11": 0.06}, 150)),
}


def clean_tests() -> Iterator[Test]:
    """The tests without noise, after the unloaded start."""
    law = library.load("ck15", spin=True)
    for name, pieces in PROGRAMS.items():
        steps = [{"to": to, "increments": increments} for to, increments in pieces]
        history = heun.run(law, programs.Program.model_validate({"name": name, "steps": steps}), 1e-6)
        yield Test(name, history.strain[1:, :2], history.stress[1:, :2])


def noisy(tests: Iterable[Test], seed: int) -> Iterator[Test]:
    """The same with noise."""
    rng = np.random.default_rng(seed)
    for test in tests:
        scatter = NOISE * np.abs(test.stress).max() * rng.normal(size=test.stress.shape)
        yield Test(test.name, test.strain, test.stress + scatter)


def true_constants() -> dict[str, float]:
    """Ck 15's, by the names of `fit`."""
    law = library.load("ck15")
    return {name: value for name, (value, _) in law.constants(law.reference_temperature)}


def run(study: Study) -> None:
    """Fit every series; judge how often and how far the constants lie outside."""
    law, tests, true = library.load("ck15"), list(clean_tests()), true_constants()
    fits = [fit.fit(noisy(tests, seed), law.G, law.nu) for seed in range(SERIES)]
    names = list(fits[0].constants)
    value, standard, stated = (
        np.array([[getattr(one, kind)[name] for name in names] for one in fits])
        for kind in ("constants", "standard", "uncertainty")
    )
    known = np.array([true[name] for name in names])
    off = np.abs(value - known) / stated
    study.check(
        "series with a constant outside its uncertainty",
        (off > 1).any(axis=1).sum(),
        2,
        "0.5 of 10 expected",
        kind="at_most",
    )
    study.check(
        "maximum deviation over the stated uncertainty", off.max(), 1.5, "3 to 4 standard deviations", 0.0, "at_most"
    )
    for k, name in enumerate(names):
        if name in ("k0_squared", "a1", "a3", "a5", "a7", "a"):
            study.check(f"{name}, mean of {SERIES} series", value[:, k].mean(), known[k], "constant of the tests", 0.03)
    rows = [
        [
            name,
            known[k],
            value[:, k].mean(),
            value[:, k].std(ddof=1),
            standard[:, k].mean(),
            stated[:, k].mean(),
            int((off[:, k] > 1).sum()),
        ]
        for k, name in enumerate(names)
    ]
    study.table(
        f"{SERIES} series of four tests",
        ["constant", "true", "mean", "their scatter", "standard deviation", "± stated", "outside"],
        rows,
    )
    _draw(study, names, value / known, stated / known)


def _draw(study: Study, names: list[str], value: np.ndarray, stated: np.ndarray) -> None:
    inside = int((np.abs(value - 1.0) <= stated).sum())
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 4.2), layout="constrained")
        axes = figure.add_subplot()
        shift = np.linspace(-0.3, 0.3, len(value))
        for one, width, dx in zip(value, stated, shift, strict=True):
            axes.errorbar(np.arange(len(names)) + dx, one, width, fmt="o", ms=3, lw=0.8, color="C0")
        axes.plot([], [], "o-", color="C0", label=f"{len(value)} series of tests with 1 % noise, ± stated uncertainty")
        axes.axhline(1.0, color="k", lw=0.8, label="constants of the thesis, 6.2.2, with which the tests were made")
        axes.set_xticks(np.arange(len(names)), names, rotation=30)
        found = f"{inside} of {value.size} constants lie within their stated uncertainty"
        axes.set(ylabel="identified over true constant", title=found, ylim=(-0.5, 3))
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("material_fit", figure)
