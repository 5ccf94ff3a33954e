"""The thesis's integrator (5.2.5): a modified Heun scheme with automatic sub-steps, for the rod and for the full stress
state.

In each sub-step the yield and the loading condition (5.2.41) decide between the elastic and the elastic-plastic rate
equations. Where an elastic sub-step would leave the yield surface it is cut at the surface. The difference between the
Euler and the Heun result estimates the error: it controls the size of the sub-steps and, added to the Euler result,
corrects it. The remaining drift from the yield surface is removed along n.

Both forms are written for one vector y = (t, B, b*, T, σm): t is the deviator's components that the form carries (⅔σ11,
τ12, τ13 or all six), with metric w and elastic moduli c of each (3/2, 2, 2 and ⅔E, 2G, 2G; or 1 and 2, all 2G), σm the
mean stress (in the rod it follows from t and is not used).
"""

import math
from functools import partial

import numpy as np

from coilset.model.core.material.law.functions import (
    CHANGE,
    HEATING,
    N_ROWS,
    ROW_LENGTH,
    SPIN,
    TEMPERATURE,
    elasticity,
    functions,
    inside_table,
    row_functions,
    table_place,
)
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point.local import TOO_HOT, yield_crossing
from coilset.model.core.material.point.points import refuse
from coilset.model.core.material.point.points import update as update_points
from coilset.model.core.runtime.kernels import KERNEL, njit
from coilset.model.tools.identification import programs
from coilset.model.tools.identification.programs import History, Program

MAX_SUBSTEPS = 20000
MAX_CUTS = 8
ROD_METRIC = (1.5, 2.0, 2.0)
SOLID_METRIC = (1.0, 1.0, 1.0, 2.0, 2.0, 2.0)
ELASTIC, PLASTIC, BY_LOADING = 0, 1, 2


@njit(**KERNEL)
def _thermal_slope(p: np.ndarray, b: float, temperature: float) -> float:
    """∂k²/∂T at fixed b*, N²/(mm⁴ K)."""
    if p[N_ROWS] == 1.0:
        return 0.0
    o, _ = table_place(p, temperature)
    u = o + ROW_LENGTH
    return (row_functions(p, u, b)[0] - row_functions(p, o, b)[0]) / (p[u] - p[o])


@njit(**KERNEL)
def _yield_excess(p: np.ndarray, y: np.ndarray, w: np.ndarray) -> float:
    """F/k² = n:n/k² − 1."""
    m = w.shape[0]
    nn = 0.0
    for i in range(m):
        n = y[i] - y[m + i]
        nn += w[i] * n * n
    return nn / functions(p, y[2 * m], y[2 * m + 1])[0] - 1.0


@njit(**KERNEL)
def _onto_surface(p: np.ndarray, y: np.ndarray, w: np.ndarray) -> None:
    """Remove the drift: n → n k/|n| at fixed B and b*."""
    m = w.shape[0]
    factor = 1.0 / math.sqrt(1.0 + _yield_excess(p, y, w))
    for i in range(m):
        y[i] = y[m + i] + factor * (y[i] - y[m + i])


@njit(**KERNEL)
def _neutral_kappa(kappa: float, a: float, c: float, axial: float, rest: float, spin: float, half: float) -> float:
    """The κ below the material's for which F = 0 stays with λ = 0: spin + (1 − κ half) (axial x_a + rest x_c) = 0.

    Here a = ζ + c_a, c = ζ + c_c, x = 1/(1 + κ a) or 1/(1 + κ c), half = ½k²′.
    """
    # Multiplied by (1 + κ a)(1 + κ c): a quadratic equation q2 κ² + q1 κ + q0 = 0.
    cross = axial * c + rest * a
    q2, q1, q0 = spin * a * c - half * cross, spin * (a + c) + cross - half * (axial + rest), spin + axial + rest
    root = q1 * q1 - 4.0 * q2 * q0
    if root < 0.0:
        return kappa
    q = -0.5 * (q1 + math.copysign(math.sqrt(root), q1))
    found = kappa
    for candidate in (q / q2 if q2 != 0.0 else math.inf, q0 / q):
        if 0.0 <= candidate < found:
            found = candidate
    return found


@njit(**KERNEL)
def _rates(
    p: np.ndarray,
    y: np.ndarray,
    w: np.ndarray,
    d: np.ndarray,
    volume: float,
    warming: tuple[float, float, float],
    mode: int,
    rate: np.ndarray,
) -> bool:
    """Rates of y for the strain rate `d` (tensor components, deviatoric in the solid) and the rate of volume strain.

    `warming` is the rise of temperature per plastic work, its prescribed rate, and the tolerance of `integrate`.

    Returns:
        Whether the point loads plastically.
    """
    m = w.shape[0]
    rod = m == 3
    E, G, alpha = elasticity(p, y[2 * m + 1])
    cc = 2.0 * G
    ca = E / 1.5 if rod else cc
    heating, change, _ = warming
    _, dk2, zeta, _, kappa, _ = functions(p, y[2 * m], y[2 * m + 1])
    for i in range(2 * m + 2):
        rate[i] = 0.0
    if rod and p[SPIN] != 0.0:  # (5.2.33), γ1j = 2 d1j; in terms of t11 = ⅔σ11, and of 3/2 B11 = B11 − B22
        for j in range(1, 3):
            g = 2.0 * d[j]
            rate[0] -= g * y[j] / 1.5
            rate[j] += 0.75 * g * y[0]
            rate[3] -= g * y[3 + j]
            rate[3 + j] += 0.75 * g * y[3]
    axial = rest = spin = axial_nn = rest_nn = 0.0
    for i in range(m):
        n = y[i] - y[m + i]
        spin += w[i] * n * (rate[i] - rate[m + i])
        if i == 0:
            axial, axial_nn = w[i] * n * ca * d[i], w[i] * n * n
        else:
            rest += w[i] * n * cc * d[i]
            rest_nn += w[i] * n * n
        rate[i] += (ca if i == 0 else cc) * d[i]
    if change != 0.0:  # the yield surface itself moves: n:ṅ = ½ (k²′ ḃ* + ∂k²/∂T Ṫ)
        rate[2 * m + 1] = change
        spin -= 0.5 * change * _thermal_slope(p, y[2 * m], y[2 * m + 1])
    bulk = E * G / (3.0 * (3.0 * G - E))
    rate[2 * m + 2] = bulk * volume
    loading = (2.0 - kappa * dk2) * (axial + rest + spin) > 0.0  # (5.2.41)
    if mode == ELASTIC or (mode == BY_LOADING and not loading):
        return False

    # The multiplier μ of n in (1 + κζ) D_pl = κ Ť + μ n follows from n:n = k². `warm` is d e11/db*, from thermal
    # strain.
    xa, xc = 1.0 / (1.0 + kappa * (zeta + ca)), 1.0 / (1.0 + kappa * (zeta + cc))
    warm = -ca * alpha * heating if rod else 0.0
    n0 = y[0] - y[m]
    thermal = w[0] * n0 * xa * warm
    xe = xa * axial + xc * rest
    xnn = xa * axial_nn + xc * rest_nn
    cxnn = (ca + zeta) * xa * axial_nn + (cc + zeta) * xc * rest_nn
    half = (0.5 * dk2 - thermal) / (1.0 - kappa * thermal)
    mu = (spin + xe * (1.0 - kappa * half)) / (cxnn + xnn * half)
    work = (kappa * xe + mu * xnn) / (1.0 - kappa * thermal)
    work = max(work, 0.0)  # with spin, at the edge of the cone of `local`, it may be slightly negative
    if mode == BY_LOADING and mu < 0.0:  # neutral loading, see `local`
        kappa = _neutral_kappa(kappa, zeta + ca, zeta + cc, axial, rest, spin, 0.5 * dk2)
        xa, xc = 1.0 / (1.0 + kappa * (zeta + ca)), 1.0 / (1.0 + kappa * (zeta + cc))
        mu, work = 0.0, max(kappa * (xa * axial + xc * rest), 0.0)
    for i in range(m):
        c, x = (ca, xa) if i == 0 else (cc, xc)
        e = c * d[i] + (warm * work if i == 0 else 0.0)
        plastic = x * (kappa * e + mu * (y[i] - y[m + i]))
        rate[i] += e - c * d[i] - c * plastic
        rate[m + i] += zeta * plastic  # (3.1.8)
    rate[2 * m] = work  # (3.1.7)
    rate[2 * m + 1] += heating * work
    rate[2 * m + 2] -= 3.0 * bulk * alpha * heating * work
    return True


@njit(**KERNEL)
def _heun(
    p: np.ndarray,
    y: np.ndarray,
    w: np.ndarray,
    d: np.ndarray,
    volume: float,
    warming: tuple[float, float, float],
    h: float,
    mode: int,
    work: np.ndarray,
) -> bool:
    """One Heun step of size `h` from y to work[2]; work[0] becomes the rate at y, work[1] the Euler result.

    Returns:
        Whether it was plastic.
    """
    plastic = False
    size = y.shape[0]
    for i in range(size):
        work[1, i] = y[i]
        work[2, i] = y[i]
    for stage in range(2):
        loads = _rates(p, work[1], w, d, volume, warming, mode, work[3])
        if stage == 0:
            plastic = loads
            mode = mode if plastic else ELASTIC
            for i in range(size):
                work[0, i] = work[3, i]
                work[1, i] = y[i] + h * work[3, i]
        for i in range(size):
            work[2, i] += 0.5 * h * work[3, i]
    return plastic


@njit(**KERNEL)
def _elastic_part(
    p: np.ndarray,
    y: np.ndarray,
    w: np.ndarray,
    d: np.ndarray,
    volume: float,
    warming: tuple[float, float, float],
    h: float,
    work: np.ndarray,
) -> float:
    """Largest elastic step up to `h` that does not leave the yield surface; its end is left in work[2]."""
    m = w.shape[0]
    k2 = functions(p, y[2 * m], y[2 * m + 1])[0]
    for _ in range(MAX_CUTS):
        _heun(p, y, w, d, volume, warming, h, ELASTIC, work)
        if _yield_excess(p, work[2], w) <= 1e-12:
            break
        # |n + β e|² = k² + β Δk². The spin and the temperature bend the path a little, hence the repetition.
        nn = ne = ee = 0.0
        for i in range(m):
            n = y[i] - y[m + i]
            e = work[2, i] - work[2, m + i] - n
            nn += w[i] * n * n
            ne += w[i] * n * e
            ee += w[i] * e * e
        change = functions(p, y[2 * m], work[2, 2 * m + 1])[0] - k2
        h *= max(yield_crossing(nn, ne - 0.5 * change, ee, k2), 1e-6)
    if _yield_excess(p, work[2], w) > -1e-9:
        _onto_surface(p, work[2], w)
    return h


@njit(**KERNEL)
def integrate(
    p: np.ndarray, y: np.ndarray, w: np.ndarray, d: np.ndarray, volume: float, warming: tuple[float, float, float]
) -> tuple[int, bool]:
    """Advance y over the strain increment `d` in sub-steps.

    Returns:
        Number of sub-steps (-1: too many; -2: too hot for the table; 0: all of it elastic), and whether the last one
        was plastic.
    """
    work = np.empty((4, y.shape[0]))
    m = w.shape[0]
    done, h, steps, plastic, yielded = 0.0, 1.0, 0, False, False
    while done < 1.0:
        steps += 1
        if steps > MAX_SUBSTEPS:
            return -1, plastic
        rest = 1.0 - done
        step = min(h, rest)
        plastic = _yield_excess(p, y, w) > -1e-12 and _heun(p, y, w, d, volume, warming, step, BY_LOADING, work)
        if plastic:
            error = 0.0
            for i in range(m):
                error += w[i] * (work[2, i] - work[1, i]) ** 2
            error = math.sqrt(error / functions(p, y[2 * m], y[2 * m + 1])[0]) / warming[2]
            factor = 0.9 / math.sqrt(error) if error > 0.0 else 5.0
            h = step * min(max(factor, 0.1), 5.0)
            if error > 1.0:
                continue
            _onto_surface(p, work[2], w)
            yielded = True
        else:
            step = _elastic_part(p, y, w, d, volume, warming, rest, work)
        for i in range(y.shape[0]):
            y[i] = work[2, i]
        done = 1.0 if step == rest else done + step
    if warming[0] > 0.0 and not inside_table(p, y[2 * m + 1]):
        return TOO_HOT, plastic
    return steps if yielded else 0, plastic


@njit(**KERNEL)
def _rod(p: np.ndarray, old: np.ndarray, de: np.ndarray, new: np.ndarray, C: np.ndarray, tolerance: float) -> int:
    """The thesis's integrator for the rod: arguments as of `increment.advance`.

    The relative error of stress allowed in a sub-step is `tolerance`; if it is infinite, the plastic
    part of the increment is one step. C is the tangent of the rate equations at the end (3.2.4).

    Returns:
        Number of sub-steps, 0 for an elastic increment, -1 if there were too many, -2 if too hot for the table.
    """
    w = np.array(ROD_METRIC)
    d = np.array((de[0], 0.5 * de[1], 0.5 * de[2]))
    y = np.zeros(9)
    thermal = old.shape[0] > 7
    warming = (p[HEATING], 0.0, tolerance) if thermal else (0.0, p[CHANGE], tolerance)
    y[0] = old[0] / 1.5
    y[1:7] = old[1:7]
    y[7] = old[7] if thermal else p[TEMPERATURE] - p[CHANGE]
    steps, plastic = integrate(p, y, w, d, 0.0, warming)
    new[:] = old
    if steps >= 0:
        new[0] = 1.5 * y[0]
        new[1:7] = y[1:7]
        if thermal:
            new[7] = y[7]
    rate = np.empty(9)
    for j in range(3):
        d[:] = 0.0
        d[j] = 1.0 if j == 0 else 0.5
        _rates(p, y, w, d, 0.0, (warming[0], 0.0, 0.0), PLASTIC if plastic else ELASTIC, rate)
        C[0, j], C[1, j], C[2, j] = 1.5 * rate[0], rate[1], rate[2]
    return steps


@njit(**KERNEL)
def _solid(p: np.ndarray, old: np.ndarray, dD: np.ndarray, new: np.ndarray, C: np.ndarray, tolerance: float) -> int:
    """The thesis's integrator for the full stress state: as `_rod`."""
    w = np.array(SOLID_METRIC)
    thermal = old.shape[0] > 13
    warming = (p[HEATING], 0.0, tolerance) if thermal else (0.0, p[CHANGE], tolerance)
    y = np.zeros(15)
    mean = (old[0] + old[1] + old[2]) / 3.0
    for i in range(6):
        y[i] = old[i] - (mean if i < 3 else 0.0)
    y[6:13] = old[6:13]
    y[13] = old[13] if thermal else p[TEMPERATURE] - p[CHANGE]
    y[14] = mean
    d = np.empty(6)
    steps, plastic = integrate(p, y, w, d, _split(dD, d), warming)
    new[:] = old
    if steps >= 0:
        for i in range(6):
            new[i] = y[i] + (y[14] if i < 3 else 0.0)
        new[6:13] = y[6:13]
        if thermal:
            new[13] = y[13]
    rate = np.empty(15)
    unit = np.zeros(6)
    for j in range(6):
        unit[:] = 0.0
        unit[j] = 1.0
        _rates(p, y, w, d, _split(unit, d), (warming[0], 0.0, 0.0), PLASTIC if plastic else ELASTIC, rate)
        for i in range(6):
            C[i, j] = rate[i] + (rate[14] if i < 3 else 0.0)
    return steps


@njit(**KERNEL)
def _split(dD: np.ndarray, d: np.ndarray) -> float:
    """Write the deviator of a strain increment to `d`, tensor components, and return its volume strain."""
    volume = dD[0] + dD[1] + dD[2]
    for i in range(3):
        d[i] = dD[i] - volume / 3.0
        d[3 + i] = 0.5 * dD[3 + i]
    return volume


@njit(**KERNEL)
def _points(
    p: np.ndarray,
    state: np.ndarray,
    increments: np.ndarray,
    new: np.ndarray,
    tangent: np.ndarray,
    count: np.ndarray,
    tolerance: float,
) -> None:
    for i in range(state.shape[0]):
        if increments.shape[1] == 3:
            count[i] = _rod(p, state[i], increments[i], new[i], tangent[i], tolerance)
        else:
            count[i] = _solid(p, state[i], increments[i], new[i], tangent[i], tolerance)


def update(
    law: Law,
    state: np.ndarray,
    increments: np.ndarray,
    temperature: float | tuple[float, float] | None = None,
    tolerance: float | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Advance points by strain increments, as `coilset.model.core.material.point.points.update`.

    Args:
        law, state, increments, temperature: as there; k², ζ, κ, heating and spin.
        tolerance: error of stress, relative to the yield stress, allowed in a sub-step, None: 1e-4; inf: one step.

    Returns:
        The new state, the tangent of the rate equations, and the number of sub-steps, 0 where a point stayed elastic.
    """
    tolerance = 1e-4 if tolerance is None else tolerance
    start, end = temperature if isinstance(temperature, tuple) else (temperature, temperature)
    p, (points, components) = law.parameters(end), increments.shape
    if start is not None and end is not None and start != end:
        p[CHANGE] = end - start
        normals = np.arange(components) < (1 if components == 3 else 3)
        increments = increments - law.thermal_strain(start, end) * normals
    new, tangent = np.empty_like(state), np.empty((points, components, components))
    count = np.empty(points, dtype=np.int64)
    _points(p, np.ascontiguousarray(state), np.ascontiguousarray(increments, float), new, tangent, count, tolerance)
    refuse(law, count)
    return new, tangent, count


def run(law: Law, program: Program, tolerance: float = 1e-4) -> History:
    """Drive one point through a program."""
    return programs.run(law, program, partial(update, tolerance=tolerance), 0.1 * min(tolerance, 1e-2))


# Both, by name, for what compares them.
UPDATES = {"return_mapping": update_points, "heun": update}
RUNS = {"return_mapping": programs.run, "heun": run}
