"""Hardening directly from the tests, and starting points for the fit."""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
from scipy.optimize import least_squares

from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law import functions as fn
from coilset.model.core.runtime.kernels import njit
from coilset.model.tools.identification.experiments import Test
from coilset.model.tools.identification.fitted_law import KINEMATIC, NORMALITY, FittedLaw, Variables, moved_by

FLOWING = 5e-4  # length of the plastic path from which a reading tells k²: before it, the elastic moduli decide
READINGS = 10  # that a fit needs at least
NO_BACK_STRESS = {"start": 0.0, "rest": 0.0, "a7": 1.0}
Starts = Callable[[float, float], Iterable[dict[str, float]]]  # variables from reach, N/mm², and maximum k², N²/mm⁴


@njit(**fn.KERNEL)
def _follow(
    start: float, rest: float, a7: float, plastic: np.ndarray, stress: np.ndarray, work: np.ndarray, k2: np.ndarray
) -> None:
    """Plastic work and n:n along a measured path, with the back stress of (3.1.7) and (3.1.8).

    `plastic` are the plastic strains ε11 and γ12; ζ is (rest + start exp(−a7 b*)) sqrt(6 n:n), with the measured n.
    """
    back, b, nn = np.zeros(2), 0.0, 0.0
    for i in range(plastic.shape[0]):
        if i > 0:
            zeta = (rest + start * math.exp(-a7 * b)) * math.sqrt(6.0 * nn)
            de, dg = plastic[i, 0] - plastic[i - 1, 0], plastic[i, 1] - plastic[i - 1, 1]
            b += 1.5 * (stress[i, 0] / 1.5 - back[0]) * de + (stress[i, 1] - back[1]) * dg
            b = max(b, 0.0)
            back[0] += zeta * de
            back[1] += 0.5 * zeta * dg
        nn = 1.5 * (stress[i, 0] / 1.5 - back[0]) ** 2 + 2.0 * (stress[i, 1] - back[1]) ** 2
        work[i], k2[i] = b, nn


def hardening(
    model: FittedLaw, tests: Sequence[Test], kinematic: Variables, starts: Starts, held: Sequence[str] = ()
) -> tuple[dict[str, float], float]:
    """k² over the plastic work as the tests themselves have it, for given ζ; `held` variables stay; and its reach."""
    moduli = np.array([2 * model.G * (1 + model.nu), model.G])
    points = []
    for test in tests:
        plastic = test.strain - test.stress / moduli
        work, k2 = np.empty(len(plastic)), np.empty(len(plastic))
        _follow(*(kinematic[name] for name in KINEMATIC), plastic, test.stress, work, k2)
        length = np.linalg.norm(np.diff(plastic, axis=0, prepend=0), axis=1).cumsum()
        flows = (length > FLOWING) & (work > 0) & (k2 > 0.85 * np.maximum.accumulate(k2))
        points.append((work[flows], k2[flows]))
    work, k2 = np.hstack(points)
    if work.size < READINGS:
        names = ", ".join(test.file or test.name for test in tests)
        none = "no yielding is seen; are G and the unit of stress, N/mm², right, and the readings in the test's order?"
        few = f"{work.size} readings beyond a plastic strain of {100 * FLOWING:g} %, and {READINGS} are needed"
        problem = f"{few}; give more, or the curve as a table" if work.size else none
        raise InputError(f"{names}: {problem}")
    values = np.empty((6, work.size))

    def moved(start: dict[str, float], x: np.ndarray) -> dict[str, float]:
        return start | moved_by({name: value for name, value in start.items() if name not in held}, x)

    def residual(x: np.ndarray, start: dict[str, float]) -> np.ndarray:
        fn.many(model.parameters(moved(start, x)), work, 0.0, values)
        return (values[0] - k2) / k2.max()

    found = [
        (least_squares(residual, np.zeros(len(start) - len(held)), args=(start,), bounds=(-6, 6), max_nfev=100), start)
        for start in starts(work.max(), k2.max())
    ]
    best, start = min(found, key=lambda pair: pair[0].cost)
    return moved(start, best.x) | dict(kinematic), float(work.max())


def first_starts(model: FittedLaw) -> Starts:
    """Starting points of k² for step 1."""

    def starts(reach: float, top: float) -> Iterator[dict[str, float]]:
        for a3, fraction in itertools.product((3, 10, 30), (0.3, 0.5, 0.7) if "b1" in model.hardening else (1.0,)):
            start = {"k0": 0.5 * top, "a1": 0.5 * top, "a2": 1 / reach, "a3": a3 / reach}
            yield start | ({"b1": fraction * reach, "gain": 0.2 * top} if "b1" in model.hardening else {})

    return starts


def kinematic_starts(
    model: FittedLaw, values: Variables, tests: Sequence[Test], reach: float
) -> Iterator[dict[str, float]]:
    """Starting points for step 2: back stresses of several sizes, with the k² that the tests give for each."""
    base = {name: values[name] for name in model.hardening}
    for size, a7, rest in itertools.product((0.05, 0.2, 0.6), (5 / reach, 25 / reach, 125 / reach), (0.02, 0.2)):
        k = math.sqrt(values["k0"])
        kinematic = {"start": size * a7 * k, "rest": rest * k / reach, "a7": a7}
        yield hardening(model, tests, kinematic, lambda *_: [base])[0]


def bend_starts(
    model: FittedLaw, values: dict[str, float], tests: Sequence[Test], reach: float
) -> Iterator[dict[str, float]]:
    """Other transition points b1* of k²: least squares does not find a distant one."""
    yield values
    others = {name: values[name] for name in (*KINEMATIC, *NORMALITY)}
    for fraction in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8) if "b1" in values else ():
        base = {name: values[name] for name in model.hardening} | {"b1": fraction * reach}
        yield hardening(model, tests, others, lambda *_, base=base: [base], ["b1"])[0]
