"""Laws written for `coilset.api.Law`, independently of the built-in ones: Prager in both forms, Drucker, von Mises.

Linear kinematic hardening, |n| = k, Ḃ = ζ ḋ, ṅ = ė − (c + ζ) ḋ, with ḋ = λ n for constant λ and ė, has the solution

    n = φ n₀ + (1 − φ)/(s Λ) e,    φ = exp(−s Λ),    s = c + ζ,    |n(Λ)| = k,

with c = ⅔ E for the axial component of a fibre and 2 G for all others. Λ is found by Newton's method; the tangent
follows from |n|² = k² by the implicit function theorem, including the fraction β of the increment that stays elastic.
"""

import numpy as np

from coilset.model.core.runtime.kernels import njit

COMPILED = njit(cache=True, error_model="numpy")


@COMPILED
def _prager(n0, e, c, weight, ζ, k2, n, dn):  # type: ignore[no-untyped-def]
    """n at the end and ∂n/∂e of an increment e of the elastic deviator; the elastic fraction β is taken off before."""
    size = len(n0)
    trial = n0 + e
    if (weight * trial * trial).sum() <= k2 * (1.0 + 1e-12):
        n[:] = trial
        for i in range(size):
            for j in range(size):
                dn[i, j] = 1.0 if i == j else 0.0
        return False
    ee, ne, nn = (weight * e * e).sum(), (weight * n0 * e).sum(), (weight * n0 * n0).sum()
    β = max((-ne + np.sqrt(max(ne * ne - ee * (nn - k2), 0.0))) / ee, 0.0) if nn < k2 * (1.0 - 1e-12) else 0.0
    if β == 0.0 and ne < 0.0:  # from the surface through the inside
        β = -2.0 * ne / ee
    start, rest = n0 + β * e, (1.0 - β) * e
    s, Λ = c + ζ, 0.0
    φ, ψ, slope = np.ones(size), np.ones(size), np.zeros(size)
    for _iteration in range(100):
        x = s * Λ
        for i in range(size):
            φ[i] = np.exp(-x[i])
            ψ[i] = -np.expm1(-x[i]) / x[i] if x[i] > 1e-8 else 1.0 - 0.5 * x[i]
            dψ = (φ[i] - ψ[i]) / x[i] if x[i] > 1e-4 else -0.5 + x[i] / 3.0
            slope[i] = s[i] * (-φ[i] * start[i] + dψ * rest[i])
        n[:] = φ * start + ψ * rest
        length = np.sqrt((weight * n * n).sum())
        change = (1.0 / length - 1.0 / np.sqrt(k2)) / ((weight * n * slope).sum() / length**3)
        Λ += change
        if abs(change) <= 1e-15 * abs(Λ):
            break
    dβ = np.zeros(size)
    if β > 0.0:  # |n₀ + β e|² = k²
        dβ = -β * weight * start / (weight * start * e).sum()
    for j in range(size):
        for i in range(size):
            dn[i, j] = (φ[i] - ψ[i]) * e[i] * dβ[j]
        dn[j, j] += φ[j] * β + ψ[j] * (1.0 - β)
    down = (weight * n * slope).sum()
    for j in range(size):
        dΛ = -(weight * n * dn[:, j]).sum() / down
        for i in range(size):
            dn[i, j] += slope[i] * dΛ
    return True


@COMPILED
def _decay(x):  # type: ignore[no-untyped-def]
    """φ = exp(−x), ψ = (1 − φ)/x and dψ/dx."""
    less = np.expm1(-x)
    φ, ψ = 1.0 + less, -less / x if x > 1e-8 else 1.0 - 0.5 * x
    return φ, ψ, (φ - ψ) / x if x > 1e-4 else -0.5 + x / 3.0


@COMPILED
def kinematic(stress, state, strain, parameters, new_stress, new_state, tangent):  # type: ignore[no-untyped-def]
    """Prager's law of a fibre, with the arithmetic of the built-in one; parameters E, G, k², ζ.

    As `_prager`, but number by number: tuples of three are numbers to the compiler, small arrays are not.
    """
    E, G, k2, ζ = parameters
    c, weight, over = (E / 1.5, 2.0 * G, 2.0 * G), (1.5, 2.0, 2.0), (1.5, 1.0, 1.0)  # over: σ by its deviator
    e = (E * strain[0] / 1.5, G * strain[1], G * strain[2])
    n0 = (stress[0] / 1.5 - state[0], stress[1] - state[1], stress[2] - state[2])
    ee = ne = nn = 0.0
    for i in range(4):
        new_state[i] = state[i]
    for i in range(3):
        ee, ne, nn = ee + weight[i] * e[i] * e[i], ne + weight[i] * n0[i] * e[i], nn + weight[i] * n0[i] * n0[i]
        new_stress[i] = over[i] * (n0[i] + e[i] + state[i])
        for j in range(3):
            tangent[i, j] = 0.0
    tangent[0, 0], tangent[1, 1], tangent[2, 2] = E, G, G
    if nn + 2.0 * ne + ee <= k2 * (1.0 + 1e-12):
        return True
    β = max((-ne + np.sqrt(max(ne * ne - ee * (nn - k2), 0.0))) / ee, 0.0) if nn < k2 * (1.0 - 1e-12) else 0.0
    if β == 0.0 and ne < 0.0:  # from the surface through the inside
        β = -2.0 * ne / ee
    rest, crossing, Λ = 1.0 - β, ne + β * ee, 0.0
    start = (n0[0] + β * e[0], n0[1] + β * e[1], n0[2] + β * e[2])
    for _iteration in range(100):
        φa, ψa, slope_a = _decay((c[0] + ζ) * Λ)
        φc, ψc, slope_c = _decay((c[1] + ζ) * Λ)
        φ, ψ, s = (φa, φc, φc), (ψa, ψc, ψc), (c[0] + ζ, c[1] + ζ, c[2] + ζ)
        n1, n2 = φa * start[0] + ψa * rest * e[0], φc * start[1] + ψc * rest * e[1]
        n = (n1, n2, φc * start[2] + ψc * rest * e[2])
        slope = (
            s[0] * (slope_a * rest * e[0] - φa * start[0]),
            s[1] * (slope_c * rest * e[1] - φc * start[1]),
            s[2] * (slope_c * rest * e[2] - φc * start[2]),
        )
        square, down = 1.5 * n[0] ** 2 + 2.0 * (n[1] ** 2 + n[2] ** 2), 0.0
        for i in range(3):
            down += weight[i] * n[i] * slope[i]
        change = (np.sqrt(square / k2) - 1.0) * square / down
        Λ -= change
        if abs(change) <= 1e-10 * abs(Λ):
            n = (n[0] - slope[0] * change, n[1] - slope[1] * change, n[2] - slope[2] * change)
            break
    plastic = 0.0
    for i in range(3):
        p = (n0[i] + e[i] - n[i]) / s[i]
        plastic += weight[i] * p * p
        new_state[i] = state[i] + ζ * p
        new_stress[i] = over[i] * (n[i] + new_state[i])
    new_state[3] = state[3] + np.sqrt(k2 * plastic)
    for j in range(3):
        dβ = -β * weight[j] * start[j] / crossing if β > 0.0 else 0.0
        own = φ[j] * β + ψ[j] * rest
        along = weight[j] * n[j] * own
        for i in range(3):
            along += weight[i] * n[i] * (φ[i] - ψ[i]) * e[i] * dβ
        for i in range(3):
            dn = (φ[i] - ψ[i]) * e[i] * dβ - slope[i] * along / down + (own if i == j else 0.0)
            flow = ((1.0 if i == j else 0.0) - dn) / s[i]
            tangent[i, j] = over[i] * (dn + ζ * flow) * (E / 1.5 if j == 0 else G)
    return True


@COMPILED
def kinematic_3d(stress, state, strain, parameters, new_stress, new_state, tangent):  # type: ignore[no-untyped-def]
    """Prager's law of six stresses; parameters E, G, k², ζ; the state is B11, B22, B33, b, B12, B13, B23."""
    E, G, k2, ζ = parameters
    weight, c, back = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0]), np.full(6, 2.0 * G), np.array([0, 1, 2, 4, 5, 6])
    K = E * G / (3.0 * (3.0 * G - E))
    e, deviator, B = np.empty(6), stress.copy(), np.empty(6)
    mean, grown = (stress[0] + stress[1] + stress[2]) / 3.0, strain[0] + strain[1] + strain[2]
    for i in range(6):
        B[i] = state[back[i]]
        e[i] = 2.0 * G * (strain[i] - grown / 3.0) if i < 3 else G * strain[i]
        deviator[i] -= mean if i < 3 else 0.0
    n, dn = np.empty(6), np.empty((6, 6))
    n0 = deviator - B
    new_state[:] = state
    if _prager(n0, e, c, weight, ζ, k2, n, dn):
        p = (n0 + e - n) / (2.0 * G + ζ)
        for i in range(6):
            B[i] += ζ * p[i]
            new_state[back[i]] = B[i]
        new_state[3] = state[3] + np.sqrt(k2) * np.sqrt((weight * p * p).sum())
    for i in range(6):
        new_stress[i] = n[i] + B[i] + (mean + K * grown if i < 3 else 0.0)
    row = np.empty(6)
    for i in range(6):
        for j in range(6):
            same = 1.0 if i == j else 0.0
            row[j] = dn[i, j] + ζ * (same - dn[i, j]) / (2.0 * G + ζ)
        average = (row[0] + row[1] + row[2]) / 3.0
        for j in range(6):
            tangent[i, j] = 2.0 * G * (row[j] - average) if j < 3 else G * row[j]
            if i < 3 and j < 3:
                tangent[i, j] += K
    return True


@COMPILED
def drucker(stress, state, strain, parameters, new_stress, new_state, tangent):  # type: ignore[no-untyped-def]
    """Ideal plasticity with √(σ² + 3 τ²) + α σ = k, flow normal to it; parameters E, G, k, α.

    Backward Euler: σ = (σ_tr − α E μ)/(1 + E μ/q), τ = τ_tr/(1 + 3 G μ/q), q = √(σ² + 3 τ²), with unknowns μ/q and q.
    """
    E, G, k, α = parameters
    trial = stress + np.array([E, G, G]) * strain
    new_state[:] = state
    q = np.sqrt(trial[0] ** 2 + 3.0 * (trial[1] ** 2 + trial[2] ** 2))
    C = np.diag(np.array([E, G, G]))
    if q + α * trial[0] <= k * (1.0 + 1e-12):
        new_stress[:] = trial
        tangent[:] = C
        return True
    x = np.array([trial[0], trial[1], trial[2], 0.0])  # stress and multiplier
    J, r = np.zeros((4, 4)), np.empty(4)
    for _iteration in range(60):
        q = np.sqrt(x[0] ** 2 + 3.0 * (x[1] ** 2 + x[2] ** 2))
        m = np.array([x[0] / q + α, 3.0 * x[1] / q, 3.0 * x[2] / q])
        g = np.array([x[0], 3.0 * x[1], 3.0 * x[2]]) / q
        r[:3] = (x[:3] - trial) / np.diag(C) + x[3] * m
        r[3] = q + α * x[0] - k
        for i in range(3):
            for j in range(3):
                J[i, j] = x[3] * ((1.0 if i == 0 else 3.0) * (1.0 if i == j else 0.0) - g[i] * g[j]) / q
            J[i, i] += 1.0 / C[i, i]
            J[i, 3] = J[3, i] = m[i]
        step = np.linalg.solve(J, r)
        x -= step
        if np.abs(step[:3]).max() <= 1e-13 * k:
            break
    else:
        return False
    new_stress[:] = x[:3]
    new_state[3] = state[3] + k * x[3]
    inverse = np.linalg.inv(J)
    for i in range(3):
        for j in range(3):
            tangent[i, j] = inverse[i, j]
    return x[3] >= 0.0


@COMPILED
def mises(stress, state, strain, parameters, new_stress, new_state, tangent):  # type: ignore[no-untyped-def]
    """Von Mises of a fibre with linear isotropic hardening; parameters E, G, yield stress, H; state[4] is εp.

    Backward Euler: σ = σ_tr/(1 + E μ), τ = τ_tr/(1 + 3 G μ), μ = Δεp/q, with q (1 − H μ) = k + H εp. Written number by
    number, which numba compiles to faster code than slices and small arrays.
    """
    E, G, k, H = parameters
    s, t, u = stress[0] + E * strain[0], stress[1] + G * strain[1], stress[2] + G * strain[2]
    for i in range(5):
        new_state[i] = state[i]
    q = np.sqrt(s * s + 3.0 * (t * t + u * u))
    limit = k + H * state[4]
    if q <= limit * (1.0 + 1e-12):
        new_stress[0], new_stress[1], new_stress[2] = s, t, u
        tangent[0, 0], tangent[0, 1], tangent[0, 2] = E, 0.0, 0.0
        tangent[1, 0], tangent[1, 1], tangent[1, 2] = 0.0, G, 0.0
        tangent[2, 0], tangent[2, 1], tangent[2, 2] = 0.0, 0.0, G
        return True
    m = (q - limit) / (q * (3.0 * G + H))
    for _iteration in range(30):
        a, c = 1.0 / (1.0 + E * m), 1.0 / (1.0 + 3.0 * G * m)
        ss, tt = (a * s) ** 2, 3.0 * c * c * (t * t + u * u)
        q = np.sqrt(ss + tt)
        dq = -(ss * a * E + tt * c * 3.0 * G) / q
        step = (q * (1.0 - H * m) - limit) / (dq * (1.0 - H * m) - H * q)
        m -= step
        if abs(step) <= 1e-10 * m:
            break
    else:
        return False
    a, c = 1.0 / (1.0 + E * m), 1.0 / (1.0 + 3.0 * G * m)
    s, t, u = a * s, c * t, c * u
    q = np.sqrt(s * s + 3.0 * (t * t + u * u))
    new_stress[0], new_stress[1], new_stress[2] = s, t, u
    new_state[4] = state[4] + m * q
    new_state[3] = state[3] + m * q * q
    x, y, z = a * s / q * (1.0 - H * m), 3.0 * c * t / q * (1.0 - H * m), 3.0 * c * u / q * (1.0 - H * m)
    dq = -(s * s * a * E + 3.0 * (t * t + u * u) * c * 3.0 * G) / q
    g = dq * (1.0 - H * m) - H * q
    p0, p1, p2 = -x / g * E, -y / g * G, -z / g * G
    d0, d1, d2 = -E * a * s, -3.0 * G * c * t, -3.0 * G * c * u
    tangent[0, 0], tangent[0, 1], tangent[0, 2] = a * E + d0 * p0, d0 * p1, d0 * p2
    tangent[1, 0], tangent[1, 1], tangent[1, 2] = d1 * p0, c * G + d1 * p1, d1 * p2
    tangent[2, 0], tangent[2, 1], tangent[2, 2] = d2 * p0, d2 * p1, c * G + d2 * p2
    return True
