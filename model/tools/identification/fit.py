"""Identification of the law's constants from tests, in the order of the thesis (6.2.2).

1. Tension gives the hardening k²(b*): plastic work is integrated from the test itself, and without back stress the
   yield condition (3.1.4) makes k² = ⅔σ².
2. Torsion with reversal separates it into isotropic and kinematic hardening, ζ(b*).
3. Tension-torsion with an abrupt change gives the deviation from normality, κ(b*).

Finally all constants are fitted to all tests together, from several transition points b1* of k²; the uncertainties are
those of this step. From tension alone only k² is identified: hardening is then isotropic.
"""

import itertools
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.optimize import least_squares

from coilset.model.core.base.errors import InputError
from coilset.model.tools.identification.elastic_part import check_elastic
from coilset.model.tools.identification.experiments import Test
from coilset.model.tools.identification.fitted_law import KINEMATIC, NORMALITY, FittedLaw, moved_by
from coilset.model.tools.identification.hardening import (
    NO_BACK_STRESS,
    bend_starts,
    first_starts,
    hardening,
    kinematic_starts,
)
from coilset.model.tools.identification.result import Fit, Minimum, result

STEP = 1e-4  # of the logarithms of the variables, for derivatives
BENDS = 4  # starts with different transition points that are followed to their minima: those that fit best


def fit(tests: Iterable[Test], G: float, nu: float, saturates: bool | None = None, temperature: float = 293.15) -> Fit:
    """Identify the constants of k², ζ and κ; those of k² alone where there are only tension tests.

    Args:
        tests: `Test` objects: tension alone, or at least one each of tension, torsion with reversal, and
            tension-torsion.
        G, nu: elastic constants, measured before; N/mm².
        saturates: whether k² has its second branch, which the tests must reach; None: unless there is only tension.
        temperature: of the tests, K.

    Returns:
        A `Fit`.

    Raises:
        InputError: if a kind of test is missing, or strain is not a number, or stress not in N/mm², or a
            test's elastic part not that of G and nu.
        SolveError: if the constants cannot be determined from these tests.
    """
    tests = tuple(tests)
    for test in tests:
        check_elastic(test, float(G), float(nu))
    kinds = {kind: [test for test in tests if test.kind == kind] for kind in ("tension", "torsion", "combined")}
    isotropic = bool(tests) and len(kinds["tension"]) == len(tests)
    saturates = not isotropic if saturates is None else saturates
    model = FittedLaw(float(G), float(nu), saturates, isotropic)
    if isotropic:
        values, reach = hardening(model, tests, NO_BACK_STRESS, first_starts(model))
        values |= {name: 0.0 for name in NORMALITY}
        minima = _minima(model, bend_starts(model, values, tests, reach), model.names, tests)
        return result(model, minima, tests, float(temperature))
    for kind, use in (("tension", "k²"), ("torsion", "ζ"), ("combined", "κ")):
        if not kinds[kind]:
            raise InputError(f"there is no {kind} test among the data; without it {use} cannot be identified")
    proportional, names = kinds["tension"] + kinds["torsion"], [*model.hardening, *KINEMATIC]
    values, reach = hardening(model, kinds["tension"], NO_BACK_STRESS, first_starts(model))
    starts = _closest(model, kinematic_starts(model, values, proportional, reach), proportional, 2)
    values, _ = _minima(model, starts, names, proportional)[0]
    starts = [values | {"a": 10.0**n} for n in range(-7, 0)]
    values, _ = _minima(model, _closest(model, starts, kinds["combined"], 1), NORMALITY, kinds["combined"])[0]
    starts = _closest(model, bend_starts(model, values, proportional, reach), tests, BENDS)
    minima = _minima(model, starts, model.names, tests)
    return result(model, minima, tests, float(temperature))


def _adjust(model: FittedLaw, values: dict[str, float], names: Sequence[str], tests: Sequence[Test]) -> Minimum:
    """Least squares over the logarithms of the constants `names`, started at `values`."""
    start = {name: values[name] for name in names}

    def residual(x: np.ndarray) -> np.ndarray:
        return model.residual(values | moved_by(start, x), tests)

    def slopes(x: np.ndarray) -> np.ndarray:
        here = residual(x)
        return np.array([residual(x + step) - here for step in STEP * np.eye(x.size)]).T / STEP

    found = least_squares(residual, np.zeros(len(names)), slopes, bounds=(-12, 12), ftol=1e-7, xtol=1e-6, max_nfev=60)
    return values | moved_by(start, found.x), found


def _minima(
    model: FittedLaw, starts: Iterable[dict[str, float]], names: Sequence[str], tests: Sequence[Test]
) -> list[Minimum]:
    """Minima that `_adjust` finds from the starts, the lowest first, each once."""
    found = sorted((_adjust(model, start, names, tests) for start in starts), key=lambda pair: pair[1].cost)
    new = [i == 0 or pair[1].cost > found[i - 1][1].cost * (1 + 1e-4) for i, pair in enumerate(found)]
    return list(itertools.compress(found, new))


def _closest(
    model: FittedLaw, starts: Iterable[dict[str, float]], tests: Sequence[Test], number: int
) -> list[dict[str, float]]:
    """The starting points that fit best."""
    return sorted(starts, key=lambda start: np.sum(model.residual(start, tests) ** 2))[:number]
