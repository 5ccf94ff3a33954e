"""The straight part of a test, in which the wire is still elastic: whether its slope is that of the elastic constants.

A fit takes what the moduli do not explain for plastic strain. The elongation of a machine without an extensometer on
the wire, slack at the start and moduli of another wire would so become yield: in a made-up wire 2 % of the slope, or a
strain of 1e-4, move the yield stress by 3 to 4 %, and twice as much moves it by 10 to 20 %.

The straight part is sought among all runs of readings of the first loading. The scatter of the readings gives each
slope its error; the run whose slope is steepest for certain is straight, and of all that may be as steep the one with
the most certain slope is taken. What comes before it is slack that is taken up, what comes after it yield.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from coilset.model.core.base.errors import InputError
from coilset.model.tools.identification.experiments import COMPONENTS, Test

LOADED = 0.1  # of the maximum stress: readings below it may be of a machine that settles
SOFTEST = 0.03  # of the elastic modulus, at the first reading above that; strain in per cent gives 0.01
SLOPE, OFFSET = 0.02, 1e-4  # of the modulus, and strain: more of either is refused
BACK, REACH = 2e-4, 0.02  # strain by which the first loading ends as it goes back, and plastic strain up to which
SPAN = 0.2  # of the stress in this range, which a straight part has at least
ENDS = 240  # of runs that are tried; of more readings some
STEEP, ALIKE = 3.0, 1.5  # standard errors: a slope less these is certain; intervals of so many overlap
SURE = 5.0  # standard errors by which a deviation is none of scatter: more than 3, as the run was chosen for its slope
NORMAL = 1.4826  # standard deviation over the median of absolute deviations
TESTER = {"compliance": "mm²/N", "offset": ""}
"""Properties of the tester that lie in a strain, with their units: it is that of the wire + offset + compliance · σ."""


@dataclass(frozen=True)
class ElasticPart:
    """The straight part of a test, σ = slope (ε − offset); the absolute values of a test that goes backwards.

    Attributes:
        component: 0 in tension, 1 in torsion.
        first: row of its first reading.
        low, high: stresses of its first and last reading, N/mm².
        slope, slope_error: N/mm², with its standard error.
        offset, offset_error: strain, of the sense of the test.
    """

    component: int
    first: int
    low: float
    high: float
    slope: float
    slope_error: float
    offset: float
    offset_error: float


def check_elastic(test: Test, G: float, nu: float) -> None:
    """Refuse a test that is not in the units, or whose elastic part is not that of the elastic constants.

    Args:
        test: the test; what was taken off its strain, or given, is not questioned.
        G, nu: elastic constants, N/mm².

    Raises:
        InputError: which slope or slack it has, and what to give.
    """
    moduli = 2.0 * G * (1.0 + nu), G
    for component in COMPONENTS[test.kind]:
        strain, stress = np.abs(test.strain[:, component]), np.abs(test.stress[:, component])
        first = int(np.argmax(stress >= LOADED * stress.max()))
        if stress[first] < SOFTEST * moduli[component] * strain[first]:
            raise test.error(
                f"at a stress of {stress[first]:.4g} its strain is {strain[first]:.4g}, far more than the elastic "
                f"{stress[first] / moduli[component]:.2g}; give strain as a number, 0.02 for 2 %, and stress in N/mm²"
            )
    part = elastic_part(test, moduli)
    if part is None:
        return
    problems = []
    if "compliance" not in test.tester:
        problems.append(_slope_problem(part, moduli[part.component]))
    if "offset" not in test.tester and abs(part.offset) > OFFSET + SURE * part.offset_error:
        problems.append(
            f"its straight part begins at a strain of {part.offset:.3g}, as with slack or a zero set under load, and "
            f"more than {OFFSET:g} moves the yield stress: give --tester offset, which takes it off"
        )
    if any(problems):
        raise test.error("; ".join(filter(None, problems)))


def _slope_problem(part: ElasticPart, modulus: float) -> str:
    """Why the slope is not that of a modulus; empty if it is."""
    off = part.slope / modulus - 1.0
    if abs(off) <= SLOPE + SURE * part.slope_error / modulus:
        return ""
    name = "G" if part.component else "2 G (1 + nu)"
    beyond = f"{100.0 * abs(off):.2g} % {'above' if off > 0.0 else 'below'}"
    give = "--known compliance=0 to fit it as it is"
    if off < 0.0:
        give = "--tester compliance, which takes the machine's elongation off"
    return (
        f"where it is straight, between {part.low:.4g} and {part.high:.4g} N/mm², its slope is {part.slope:.0f} N/mm², "
        f"{beyond} {name} = {modulus:.0f} and more than the {100.0 * SLOPE:g} % that hardly move the yield stress: "
        f"give G and nu of this wire, or {give}"
    )


def corrected(test: Test, G: float, nu: float, known: Mapping[str, float], found: Sequence[str] = ()) -> Test:
    """A test with the strain of the wire alone: offset and compliance of the tester are taken off.

    Args:
        test: of one direction; of engineering strain and stress before these become true ones.
        G, nu: elastic constants, N/mm².
        known: `TESTER` properties that are given.
        found: those that make the test's elastic part that of the constants. With an offset the readings before this
            part are left out.

    Raises:
        InputError: another property, a test of tension and torsion, one without a straight part, or a slope above that
            of the constants, which no compliance makes.
    """
    for option, names in (("--known", known), ("--tester", found)):
        for name in names:
            if name not in TESTER:
                raise InputError(f"'{name}' is none of {', '.join(TESTER)}, which tests of wire have", option)
    if not known and not found:
        return test
    if len(COMPONENTS[test.kind]) > 1:
        raise test.error("is of tension and torsion; offset and compliance are taken off tests in one direction")
    component, moduli = COMPONENTS[test.kind][0], (2.0 * G * (1.0 + nu), G)
    wanted = [name for name in found if name not in known]
    part = elastic_part(_without(test, component, known), moduli)
    if part is None and wanted:
        raise test.error(f"has no straight part that gives its {' and '.join(wanted)}; give --known NAME=VALUE")
    if part is None:
        return replace(_without(test, component, known), tester=known)
    compliance = 1.0 / part.slope - 1.0 / moduli[component]
    if "compliance" in wanted and compliance < 0.0 and (problem := _slope_problem(part, moduli[component])):
        raise test.error(problem)
    measured = {"compliance": max(compliance, 0.0), "offset": part.offset}
    tester = {**known, **{name: measured[name] for name in wanted}}
    rest = _without(test, component, tester)
    first = part.first if "offset" in tester else 0  # slack is taken up before it
    return replace(rest, strain=rest.strain[first:], stress=rest.stress[first:], tester=tester)


def _without(test: Test, component: int, tester: Mapping[str, float]) -> Test:
    strain = test.strain.copy()
    strain[:, component] -= tester.get("offset", 0.0) + tester.get("compliance", 0.0) * test.stress[:, component]
    return replace(test, strain=strain)


def elastic_part(test: Test, moduli: tuple[float, float]) -> ElasticPart | None:
    """The straight part of a test's first loading, in the direction that is loaded first; None if it has none.

    Args:
        test: the test.
        moduli: of tension and torsion, N/mm², which say up to which plastic strain it is sought.
    """
    size = np.abs(test.stress) * (1.0, math.sqrt(3.0))
    row = int(np.argmax(size.max(axis=1) >= LOADED * size.max()))
    component = int(np.argmax(size[row]))
    sense = 1.0 if test.stress[row, component] > 0.0 else -1.0
    strain, stress = sense * test.strain[:, component], sense * test.stress[:, component]
    plastic = strain - stress / moduli[component]
    ends = (np.maximum.accumulate(strain) - strain > BACK) | (plastic - plastic[0] > REACH)
    rows = int(np.argmax(ends)) if ends.any() else len(strain)
    strain, stress, before = strain[:rows], stress[:rows], 0
    if stress[0] > LOADED * stress.max():  # the virgin state is a reading, where the others begin under load
        strain, stress, before = np.append(0.0, strain), np.append(0.0, stress), 1
    best = _straightest(strain, stress)
    if best is None:
        return None
    first, last, slope, slope_error, offset, offset_error = best
    low, high = float(stress[first]), float(stress[last])
    return ElasticPart(component, max(first - before, 0), low, high, slope, slope_error, sense * offset, offset_error)


def _straightest(strain: np.ndarray, stress: np.ndarray) -> tuple[int, int, float, float, float, float] | None:
    """First and last reading of the straight run, its slope and offset, each with its standard error; None without."""
    at = np.unique(np.linspace(0, len(strain), min(len(strain), ENDS) + 1).astype(int))
    i, j = at[np.array(np.triu_indices(len(at), 1))]
    spans = (j - i > 1) & (stress[j - 1] - stress[i] >= SPAN * stress.max())
    i, j = i[spans], j[spans]
    e, s = strain - strain.mean(), stress - stress.mean()
    sums = [np.append(0.0, np.cumsum(one)) for one in (e, s, e * e, e * s, s * s)]
    n, (x, y, xx, xy, yy) = j - i, (one[j] - one[i] for one in sums)
    xx, xy, yy = xx - x * x / n, xy - x * y / n, yy - y * y / n
    possible = (xx > 0.0) & (xy > 0.0)
    if not possible.any():
        return None
    i, j, n, x, y, xx, xy, yy = (one[possible] for one in (i, j, n, x, y, xx, xy, yy))
    slopes = xy / xx
    left = np.maximum(yy - slopes * xy, 0.0) / np.maximum(n - 2, 1)
    each = np.sqrt(np.maximum(left, _scatter(strain, stress) ** 2))  # of a few readings the residuals say little
    errors = each / np.sqrt(xx)
    steepest = int(np.argmax(slopes - STEEP * errors))
    alike = slopes + ALIKE * errors >= slopes[steepest] - ALIKE * errors[steepest]
    k = np.flatnonzero(alike)[np.argmin((errors / slopes)[alike])]
    slope, error, middle = float(slopes[k]), float(errors[k]), float(y[k] / n[k] + stress.mean())
    offset = float(x[k] / n[k] + strain.mean()) - middle / slope
    offset_error = math.hypot(float(each[k]) / slope / math.sqrt(n[k]), middle * error / slope**2)
    return int(i[k]), int(j[k]) - 1, slope, error, offset, offset_error


def _scatter(strain: np.ndarray, stress: np.ndarray) -> float:
    """Standard deviation of the stresses, N/mm², by their deviations from the chords of their neighbours."""
    if len(strain) < 3:
        return 0.0
    across = strain[2:] - strain[:-2]
    part = np.divide(strain[1:-1] - strain[:-2], across, out=np.full(len(across), 0.5), where=across != 0.0)
    off = stress[1:-1] - (1.0 - part) * stress[:-2] - part * stress[2:]
    return NORMAL * float(np.median(np.abs(off) / np.sqrt(1.0 + part**2 + (1.0 - part) ** 2)))
