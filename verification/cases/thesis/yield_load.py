"""Yield load of a spring of 7.5 turns against that of 2.5 turns (thesis, 7.2.2)

"Völlige Übereinstimmung der Fließlast": springs of the same wire yield under the same load, whatever their number of
turns, because the torque F D/2 is the same in all of them; only their ends differ. The thesis reads its yield load off
a characteristic that continues at almost constant load. Ours is defined like Rp0.2 of a tension test, as the force at
which the characteristic is offset from its initial line by 0.2 % shear strain at the wire surface: with the strain γ =
d f/(π D² n) of an elastic spring this is f − F/c = 0.002 π D² n/d, 2 mm per turn. Tolerance: 2 %.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.verification.study import Study

FAST = True
WIRE, DIAMETER, PITCH = 5.0, 40.0, 12.0  # mm
TURNS = (2.5, 7.5)
OFFSETS = (0.001, 0.002)  # of shear strain
TRAVEL, STEPS = 6.0, 30  # mm per turn: 1 mm before the coils touch


def press(turns: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Travel per turn (mm), force (N) and initial rate (N/mm) of a spring compressed until shortly before block."""
    spring = {"wire_diameter": WIRE, "mean_diameter": DIAMETER, "turns": turns, "pitch": PITCH}
    mesh = {"section": {"kind": "plane"}}  # the thesis's
    loading = [{"to": {"travel": TRAVEL * turns}, "steps": STEPS}]
    entries = {"spring": spring, "material": "ck15", "loading": loading, "mesh": mesh, "accuracy": "none"}
    result = Analysis(check(entries)).run()
    curve = [(0.0, 0.0), *((step.travel_mm / turns, step.force_N) for step in result.steps)]
    travels, forces = np.array(curve).T
    return travels, forces, result.rate


def yield_load(travel: np.ndarray, force: np.ndarray, rate: float, turns: float, offset: float) -> tuple[float, float]:
    """Force at `offset` beside the initial line, N, and its travel per turn, mm."""
    beside = travel - force / (rate * turns) - offset * np.pi * DIAMETER**2 / WIRE
    return np.interp(0.0, beside, force), np.interp(0.0, beside, travel)


def run(study: Study) -> None:
    """Yield loads of both springs."""
    curves = {turns: press(turns) for turns in TURNS}
    for offset in OFFSETS:
        short, long = (yield_load(*curves[turns], turns, offset)[0] for turns in TURNS)
        study.check(f"yield load at {100 * offset:g} %, 7.5 turns, N", long, short, "2.5 turns", 0.02)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes = figure.add_subplot()
        for turns, style in zip(TURNS, ("C0-", "C3--"), strict=True):
            travel, force, rate = curves[turns]
            axes.plot(travel, force, style, lw=1.3, label=f"{turns} turns")
            load, at = yield_load(*curves[turns], turns, OFFSETS[-1])
            axes.plot(at, load, "o", color=style[:2], mfc="none", label=f"yield load {load:.2f} N")
        beside = OFFSETS[-1] * np.pi * DIAMETER**2 / WIRE
        reach = force.max() / (rate * turns)
        axes.plot([beside, beside + reach], [0.0, force.max()], "k:", lw=0.9, label="initial line and 0.2 % of shear")
        axes.set(xlabel="travel per turn in mm", ylabel="axial force in N", title="Yield load and turns, Ck 15")
        axes.legend(fontsize=8)
        axes.grid(lw=0.3)
        study.figure("yield_load", figure)
