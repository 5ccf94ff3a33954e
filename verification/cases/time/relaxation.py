"""Torque that virgin and preset bars lose at constant twist, and how steady creep redistributes stress, in closed form

A bar at constant twist creeps in pure shear, γ = A τ^N t^p by time hardening (N = 6, p = 0.3, A = 1e-20, G = 80,000
N/mm²), and each radius relaxes by itself. Where the stress grows with r, to τR = 700 N/mm² at the surface, the ratio of
the torque to its initial value is

    M/M₀ = ₂F₁(1/(N−1), 4/(N−1); 1 + 4/(N−1); −z),   z = (N − 1) G A t^p τR^(N−1).

A preset bar was twisted beyond yield (800 N/mm², no hardening), to three times the twist of the virgin one, released,
and twisted again to the same torque: an integral over r (`references/relaxing_bar`). Under a constant torque M steady
creep, p = 1, ends at τ = τR (r/R)^(1/N) with τR = (3 + 1/N) M/(2π R³).

Tolerance: 0.2 %, the error of 31 steps, equal in log t, and of the section's 16 rings. The deviations found are 0.03 %
for the virgin bar, 0.02 % for the preset one and 0.002 % for steady creep.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.meshes.springs.placement import straight
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import polar
from coilset.model.physics.time.creep.law import CreepLaw
from coilset.verification.references import relaxing_bar
from coilset.verification.study import Study

FAST = True
G, A, N, P = 80000.0, 1e-20, 6.0, 0.3  # N, mm, h; γ = A τ^N t^p
RIM, YIELD = 700.0, 800.0  # τ at the surface of the virgin bar, and of yield
R, WARM = 2.5, 293.15
HOURS = 10.0 ** np.linspace(-5, 5, 31)
JUDGED = (1.0, 1e3, 1e5)
BEYOND = 3.0  # twist of presetting over that of the virgin bar
EXPONENT, TORQUE = 4.0, 8000.0  # of steady creep


def law(yielding: bool = False, exponent: float = N, power: float = P) -> Law:
    """γ = A τ^N t^p in shear, which is c = A/√3^(N+1) σ^N t^p of equivalent values; without hardening."""
    plastic = {"k0_squared": 2.0 * YIELD**2} if yielding else "none"
    constants = {
        "temperature": WARM,
        "elasticity": {"G": G, "nu": 0.3},
        "isotropic": plastic,
        "kinematic": "none",
        "non_normality": "none",
    }
    creep = {
        "form": "norton_bailey",
        "strain": A * 500.0**exponent / 3.0 ** (0.5 * (exponent + 1.0)),
        "stress": 500.0,
        "exponent": exponent,
        "time_exponent": power,
        "hardening": "time",
    }
    about = {
        "name": "closed",
        "description": "synthetic",
        "source": "synthetic",
        "units": "N, mm, K",
        "creep": creep,
        "validity": {"plastic_work": 100.0, "remark": "synthetic"},
        "temperatures": [constants],
    }
    return Law(MaterialFile.model_validate(about))


class Bar:
    """A section of a straight bar that is twisted as time goes on."""

    def __init__(self, material: Law) -> None:
        self.rule = polar(16, 12)
        self.sections = make_sections("plane", material, material.parameters(), self.rule, np.array([R]), straight(1))
        self.creep = CreepLaw(material.data.creep, material.parts()) if material.data.creep else None
        clock = {"clock": np.array([0.0, WARM, 0.0])}
        self.state = self.sections.initial_state() | {"strain": np.zeros((1, 2, 6))} | clock

    def torque(self, twist: float, hours: float = 0.0) -> tuple[float, float]:
        """Torque, N mm, and its slope in the twist per length (1/mm), after a step."""
        assert self.creep is not None
        trial = {name: values.copy() for name, values in self.state.items()}
        trial["clock"] = self.creep.clock(hours, WARM, self.state["clock"])
        trial["strain"][..., 3] = twist
        s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
        assert self.sections.update(trial["strain"], self.state, trial, s, D)
        self.trial = trial
        return float(s[0, 0, 3]), float(D[0, 0, 3, 3])

    def keep(self) -> None:
        """Go on from the last step."""
        self.state = self.trial


def relaxation(preset: bool) -> np.ndarray:
    """M/M₀ at HOURS, from the same torque for both bars."""
    bar, elastic = Bar(law(yielding=preset)), RIM / (G * R)
    if preset:
        for twist in np.linspace(0.0, BEYOND * elastic, 41)[1:]:
            greatest, _ = bar.torque(twist)
            bar.keep()
        twist = BEYOND * elastic - (greatest - 0.5 * np.pi * R**3 * RIM) / (0.5 * np.pi * G * R**4)
    else:
        twist = elastic
    start, _ = bar.torque(twist)
    bar.keep()
    found = []
    for hours in HOURS:
        found.append(bar.torque(twist, hours)[0] / start)
        bar.keep()
    return np.array(found)


def lapse(hours: np.ndarray, stress: float = RIM) -> np.ndarray:
    """z of the nominal stress, N/mm²."""
    return (N - 1.0) * G * A * np.asarray(hours) ** P * stress ** (N - 1.0)


def exact(preset: bool, hours: np.ndarray) -> np.ndarray:
    """M/M₀."""
    z = lapse(hours)
    return relaxing_bar.preset(N, z, YIELD / RIM, BEYOND) if preset else relaxing_bar.virgin(N, z)


def steady() -> tuple[np.ndarray, np.ndarray]:
    """Radii over R and τ over τR once creep is steady at a constant torque."""
    bar, twist = Bar(law(exponent=EXPONENT, power=1.0)), 0.0
    rim = TORQUE * (3.0 + 1.0 / EXPONENT) / (2.0 * np.pi * R**3)
    elastic = rim / (G * A * rim**EXPONENT)  # hours after which creep is as large as the elastic strain
    for hours in (0.0, *elastic * 10.0 ** np.linspace(-3, 2, 60)):
        for _iteration in range(30):
            torque, slope = bar.torque(twist, hours)
            twist += (TORQUE - torque) / slope
            if abs(TORQUE - torque) < 1e-9 * TORQUE:
                break
        else:
            raise SolveError(f"the bar finds no twist for its torque after {hours:g} h")
        bar.keep()
    rows = bar.state["point_state"][0, 0]
    return np.hypot(*bar.rule.points.T)[::12], np.hypot(rows[:, 1], rows[:, 2])[::12] / rim


def run(study: Study) -> None:
    """Bars, and steady creep."""
    bars = {preset: relaxation(preset) for preset in (False, True)}
    at = [int(np.argmin(np.abs(np.log(HOURS / hours)))) for hours in JUDGED]
    for preset, word, source in ((False, "virgin", "closed form"), (True, "preset", "integral over r")):
        for k, reference in zip(at, exact(preset, HOURS[at]), strict=True):
            study.check(f"{word} bar, M/M0 after {HOURS[k]:g} h", bars[preset][k], reference, source, 2e-3)
    radii, stress = steady()
    for k in (0, len(radii) // 2, -1):
        study.check(
            f"steady creep, stress at {radii[k]:.3f} R over that at the surface",
            stress[k],
            radii[k] ** (1.0 / EXPONENT),
            "closed form",
            2e-3,
        )
    study.figure("relaxation", figure(bars, radii, stress))


def figure(bars: dict[bool, np.ndarray], radii: np.ndarray, stress: np.ndarray) -> Figure:
    """Torque over time, and the steady stress over the radius."""
    with mpl.rc_context(STYLE):
        picture = Figure(figsize=(9, 3.8), layout="constrained")
        left, right = picture.subplots(1, 2)
        fine = np.geomspace(HOURS[0], HOURS[-1], 60)
        for preset, word, colour in ((False, "virgin", "C0"), (True, "preset", "C1")):
            left.semilogx(fine, exact(preset, fine), color=colour)
            left.semilogx(HOURS, bars[preset], "o", ms=4, color=colour, label=word)
        left.set(xlabel="time in h", ylabel="torque over that at the start", title="A preset bar loses less")
        left.legend(title="line: exact; dots: coilset")
        r = np.linspace(0.0, 1.0, 200)
        right.plot(r, r ** (1.0 / EXPONENT), label="(r/R)^(1/N)")
        right.plot(r, r * 4.0 / (3.0 + 1.0 / EXPONENT), "--", color="0.5", label="elastic, at the start")
        right.plot(radii, stress, "o", ms=4, color="C0", label="coilset")
        right.set(
            xlabel="r/R",
            ylabel="shear stress over that of steady creep at R",
            title="Steady creep evens out the stress",
        )
        right.legend()
    return picture
