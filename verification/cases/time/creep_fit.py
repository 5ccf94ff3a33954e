"""Constants of creep from made-up relaxation tests: as many intervals hold the truth as they say

Losses of load are computed from known constants by other means than the fit's own quadratures (`relaxing`):

- torsion of a bar, Norton-Bailey, time hardening: the closed form ₂F₁ of `references/relaxing_bar`;
- wire in tension, Norton-Bailey and sinh, strain hardening: du/dt = φ(σ₀ − E u^p)^(1/p) with u = c^(1/p), by scipy's
  DOP853.

Three stresses, three temperatures and seven times give 63 readings. Without scatter the constants come back. Then many
series get normal noise with a standard deviation of 0.4 % of the load, each is fitted, and for each constant those are
counted whose 95 % interval holds the truth: of 200 series 190 on average, with a standard deviation of 3.1.

Tolerance: without scatter, 0.1 %; three standard deviations of the number of intervals: right intervals miss them with
a chance of 0.4 % for each constant, and of 200 series intervals so wide that they always held would miss them, too.
Fits of sinh take long, so that there are only 40 series of them, too few to tell intervals that are too wide. The seeds
are fixed.
"""

from dataclasses import replace

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.tools.identification import creep_fit
from coilset.model.tools.identification.relaxation_tests import Readings
from coilset.verification.references import relaxing_bar
from coilset.verification.study import Study

SCATTER = 0.4  # %, of the load
GAS = 8.31446261815324  # J/(mol K)
HOURS = np.array([1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0])
TEMPERATURES = np.array([353.15, 383.15, 413.15])
AT = 383.15  # K, of the constants below
NORTON = {"strain": 4e-4, "stress": 800.0, "exponent": 6.0, "time_exponent": 0.2, "activation_energy": 150000.0}
SINH = {"strain": 4e-5, "stress": 350.0, "exponent": 2.0, "time_exponent": 0.2, "activation_energy": 150000.0}
STUDIES = (
    ("torsion", "norton_bailey", "time", NORTON, (300.0, 450.0, 600.0), 200),
    ("tension", "norton_bailey", "strain", NORTON, (500.0, 750.0, 1000.0), 200),
    ("tension", "garofalo", "strain", SINH, (300.0, 700.0, 1100.0), 40),
)


def shear_modulus(temperature: float) -> float:
    """G of the library's `creeping`, linear between its two temperatures, N/mm²."""
    return 79000.0 - 7900.0 * (temperature - 293.15) / 280.0


def worth(temperature: float, constants: dict[str, float]) -> float:
    """Hours at AT that an hour at a temperature is worth."""
    return float(np.exp(-constants["activation_energy"] / GAS * (1.0 / temperature - 1.0 / AT)))


def twisted(stress: float, temperature: float, k: dict[str, float]) -> np.ndarray:
    """Loss of torque at HOURS, %; γ = A τ^N t^p with A = √3^(N+1) c₀/σ₀^N."""
    N, p = k["exponent"], k["time_exponent"]
    A = 3.0 ** (0.5 * (N + 1.0)) * k["strain"] / k["stress"] ** N
    z = (N - 1.0) * shear_modulus(temperature) * A * (worth(temperature, k) * HOURS) ** p * stress ** (N - 1.0)
    return 100.0 * (1.0 - relaxing_bar.virgin(N, z))


def stretched(stress: float, temperature: float, k: dict[str, float], form: str) -> np.ndarray:
    """Loss of the force of a wire at HOURS, %."""
    E, p = 2.0 * 1.29 * shear_modulus(temperature), k["time_exponent"]

    def rate(log_time: float, log_u: np.ndarray) -> np.ndarray:
        x = (stress - E * np.exp(p * log_u)) / k["stress"]
        x = x if form == "norton_bailey" else np.sinh(x)
        return (k["strain"] * np.maximum(x, 0.0) ** k["exponent"]) ** (1.0 / p) * np.exp(log_time - log_u)

    ends = np.log(worth(temperature, k) * HOURS)
    x = stress / k["stress"]
    first = k["strain"] * (x if form == "norton_bailey" else np.sinh(x)) ** k["exponent"]
    start = min(ends[0] - 1.0, np.log(1e-6 * stress / E / first) / p)  # here the stress is still that of the start
    path = solve_ivp(
        rate, (start, ends[-1]), [np.log(first) / p + start], t_eval=ends, method="DOP853", rtol=1e-9, atol=1e-9
    )
    return 100.0 * E * np.exp(p * path.y[0]) / stress


def readings(kind: str, form: str, constants: dict[str, float], stresses: tuple[float, ...]) -> Readings:
    """All readings without scatter."""
    places = [(stress, temperature) for stress in stresses for temperature in TEMPERATURES]
    loss = [twisted(*place, constants) if kind == "torsion" else stretched(*place, constants, form) for place in places]
    stress, temperature = (np.repeat(column, len(HOURS)) for column in np.array(places).T)
    return Readings(kind, stress, temperature, np.tile(HOURS, len(places)), np.concatenate(loss))


def truth(constants: dict[str, float], fit: creep_fit.CreepFit) -> dict[str, float]:
    """The constants as the fit states them: c₀ at its own temperature and, of the power law, at its own stress."""
    strain = constants["strain"] * worth(fit.constants["temperature"], constants) ** constants["time_exponent"]
    if fit.form == "norton_bailey":
        strain *= (fit.constants["stress"] / constants["stress"]) ** constants["exponent"]
    return constants | {"strain": strain}


def run(study: Study) -> None:
    """Three kinds of tests."""
    law, rows, shares = library.load("creeping"), [], {}
    for seed, (kind, form, hardening, constants, stresses, series) in enumerate(STUDIES):
        what, clean = f"{kind}, {form}, {hardening} hardening", readings(kind, form, constants, stresses)
        found = creep_fit.fit_creep(law, (clean,), form, hardening)
        true = truth(constants, found)
        for name in found.interval:
            study.check(f"{what}: {name}", found.constants[name], true[name], "the constants of the data", 1e-3)
        rng, inside, scatter = np.random.default_rng(seed), dict.fromkeys(found.interval, 0), []
        for _ in range(series):
            noisy = replace(clean, loss=clean.loss + rng.normal(0.0, SCATTER, clean.loss.size))
            found = creep_fit.fit_creep(law, (noisy,), form, hardening)
            for name, (low, high) in found.interval.items():
                inside[name] += low <= true[name] <= high
            scatter.append(found.scatter)
        for name, count in inside.items():
            study.check(
                f"{what}: intervals of {name} with the truth, of {series}",
                count,
                0.95 * series,
                "95 % confidence",
                3.0 * np.sqrt(0.95 * 0.05 * series),
                "absolute",
            )
        study.check(f"{what}: mean scatter found, %", np.mean(scatter), SCATTER, "scatter of the data", 0.03)
        rows.append([what, float(clean.loss.min()), float(clean.loss.max()), float(np.mean(scatter))])
        shares[what] = {name: 100.0 * count / series for name, count in inside.items()}
    study.table("Losses in the data, %", ["tests", "least", "greatest", "scatter found"], rows)
    study.figure("creep_fit", figure(shares))


def figure(shares: dict[str, dict[str, float]]) -> Figure:
    """Part of the intervals that hold the truth."""
    with mpl.rc_context(STYLE):
        picture = Figure(figsize=(8.0, 3.6), layout="constrained")
        axes = picture.subplots()
        names = max((list(one) for one in shares.values()), key=len)
        for k, (what, share) in enumerate(shares.items()):
            axes.plot([names.index(name) + 0.12 * (k - 1) for name in share], list(share.values()), "o", label=what)
        axes.axhline(95.0, color="0.5", lw=0.8)
        axes.axhspan(90.4, 99.6, color="0.92", zorder=0)  # three standard deviations of 200 series
        axes.set_xticks(range(len(names)), [name.replace("_", " ") for name in names])
        axes.set(ylabel="intervals that hold the truth in %", ylim=(86, 101), title="Intervals say what they hold")
        axes.legend(loc="lower left")
    return picture
