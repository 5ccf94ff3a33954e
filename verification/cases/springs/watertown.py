"""Sixteen springs closed once at Watertown Arsenal in 1900, and the steels that would have set as much: a comparison

*Report of the Tests of Metals … at Watertown Arsenal* for 1900, helical springs, page 387: springs for the 8-inch
carriage. Bar 0.50 in, outer diameter 2.80 in, height 6.30 in, 0.40 in between the coils, 3 pounds 4 ounces; closed
down at 2,600, 2,740 and 3,000 pounds, then 5.93 to 6.12 in high. The scan was read by machine: three loads, ten closed
and fifteen final heights are legible in it. The steel is not stated, so this proves nothing: it says which yield
stress, with how much hardening, explains the set, and whether the force at closing fits as well.

The active turns follow from heights and gaps, (6.30 − 4.16)/0.40. The uniform rod is compressed until its coils touch
and released, with G = 79,300 N/mm² (an estimate for steel), stress σ₀ + H εᵖ and no Bauschinger effect; then the rod
with closed and ground ends between seats, whose turns follow from the weight and whose ground tips from the closed
height.

That rod is pressed with the greatest of the loads read, and closes where it comes to stand on a wall
(`coilset.model.core.results.records.closing`): where one per cent of travel takes more than 20 per cent of force, at
12,010 to 12,250 N with 10, 20 and 32 elements a turn and contact stiffnesses of E/4 and 4 E. The force at the
geometry's block height is no result: it is beyond the closing and the contacts' own, 12,320 N with E/40 and 22,320 N
with E/4.

What is judged is what the yield stress was not fitted to: the force at closing must lie between the loads read (the
mean of 2,600 and 3,000 pounds, ± half their difference), and the gap that follows from weight and heights must be the
one stated, within 5 %. The height afterwards is what the yield stress was fitted to, to 0.1 mm.
"""

import tempfile
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import yaml
from matplotlib.figure import Figure
from mpi4py import MPI
from scipy.optimize import brentq

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import Case, check
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.records.closing import VERTICAL
from coilset.model.core.results.records.record import Result
from coilset.model.physics.uniform_coil.rod import press
from coilset.verification.study import Study

FAST = False
INCH, POUND, POUND_FORCE = 25.4, 0.45359237, 4.4482216  # mm, kg, N
WIRE, DIAMETER, HEIGHT, GAP = 0.50 * INCH, 2.30 * INCH, 6.30 * INCH, 0.40 * INCH
WEIGHT = 3.25 * POUND
LOADS = np.array([2600.0, 2740.0, 3000.0]) * POUND_FORCE
CLOSED = np.array([4.17, 4.20, 4.16, 4.26, 4.16, 4.11, 4.09, 4.15, 4.15, 4.15]) * INCH
AFTER = np.array([6.03, 6.00, 6.10, 6.05, 6.10, 6.11, 6.12, 6.03, 6.12, 5.95, 6.10, 5.93, 6.00, 6.05, 5.96]) * INCH
TRAVEL = HEIGHT - CLOSED.mean()
TURNS = TRAVEL / GAP
SHEAR_MODULUS, POISSON, DENSITY = 79300.0, 0.29, 7.85e-6  # N/mm², 1, kg/mm³
HARDENING = (0.0, 5000.0, 20000.0)  # dσ/dεᵖ, N/mm²
YIELD = (900.0, 1800.0)  # N/mm², between which it is sought
END = 0.3  # plastic strain up to which stress rises
NEAR, STEPS = 2.0, 60  # above the closed height, mm, from where the coils close; steps of the load from there


def steel(yield_stress: float, hardening: float) -> dict[str, Any]:
    """Data of a material file with a straight curve."""
    curve = {
        "law": "table",
        "strain": [0.0, END],
        "stress": [yield_stress, yield_stress + hardening * END],
        "strains": "plastic",
    }
    return {
        "name": "steel of 1900",
        "description": "Straight hardening",
        "source": "assumed",
        "units": "N, mm, K",
        "validity": {"plastic_work": 100.0, "remark": "assumed"},
        "temperatures": [
            {
                "temperature": 293.15,
                "elasticity": {"G": SHEAR_MODULUS, "nu": POISSON},
                "isotropic": curve,
                "kinematic": "none",
                "non_normality": "none",
            }
        ],
    }


def closed_once(yield_stress: float, hardening: float) -> tuple[float, float]:
    """Force at closing, N, and height after it, mm, of the uniform rod."""
    law = Law(MaterialFile.model_validate(steel(yield_stress, hardening)))
    coil = np.array([WIRE, DIAMETER, WIRE + GAP, TURNS])
    forces, state = press(coil, law, travels=np.linspace(0.0, TRAVEL, 13)[1:], free_ends=True)
    force = float(forces[0, -1])
    travels, _ = press(state, law, forces=np.linspace(force, 0.0, 4)[1:], free_ends=True)
    return force, HEIGHT - float(travels[0, -1])


def explaining(after: float, hardening: float) -> float:
    """Yield stress with which the spring is `after` mm high, N/mm²."""
    return float(brentq(lambda stress: closed_once(stress, hardening)[1] - after, *YIELD, xtol=1e-3))


def whole_spring(path: Path, yield_stress: float, hardening: float) -> Case:
    """The spring between seats; its turns make the weight, its ground tips the height when closed."""
    path.write_text(yaml.safe_dump(steel(yield_stress, hardening)), encoding="utf-8")

    def case(turns: float, tip: float) -> Case:
        spring = {
            "wire_diameter": WIRE,
            "mean_diameter": DIAMETER,
            "turns": turns,
            "free_length": HEIGHT,
            "end_coils": {"form": "closed and ground", "tip": tip},
        }
        return check(
            {
                "spring": spring,
                "material": str(path),
                "loading": [
                    {"to": {"height": float(CLOSED.mean()) + NEAR}},
                    {"to": {"force": float(LOADS.max())}, "steps": STEPS},
                    {"to": {"force": 0}},
                ],
                "mesh": {"elements_per_turn": 10, "section": {"radial": 4, "angular": 12}},
            }
        )

    def closed(tip: float, turns: float) -> float:
        return float(case(turns, tip).spring.build().block_height)

    turns = brentq(lambda n: case(n, 0.5).spring.build().volume * DENSITY - WEIGHT, 6.0, 9.0)
    tip = brentq(lambda part: closed(part, turns) - CLOSED.mean(), 0.1, 0.95)
    return case(turns, tip)


def run(study: Study) -> None:
    """Yield stresses that explain the heights after closing."""
    mean, rows = float(AFTER.mean()), []
    middle, half = 0.5 * float(LOADS.max() + LOADS.min()), 0.5 * float(np.ptp(LOADS))
    for hardening in HARDENING:
        stresses = [explaining(float(after), hardening) for after in (AFTER.min(), mean, AFTER.max())]
        force = closed_once(stresses[1], hardening)[0]
        rows.append([f"uniform rod, H = {hardening:g}", *map(round, stresses), round(force)])
        study.shown(
            f"force at closing, uniform rod, H = {hardening:g} N/mm², N",
            force,
            middle,
            "Watertown Arsenal 1900, loads",
            "its ends carry no load",
        )
    stress, after, force, gap = rod_explaining(mean)
    rows.append([f"rod, H = {HARDENING[1]:g}", None, round(stress), None, round(force)])
    study.check(
        "gap between the coils from weight and heights, mm",
        gap,
        GAP,
        "Watertown Arsenal 1900, distance between coils",
        0.05,
    )
    study.check(
        "height afterwards, rod with the yield stress that explains it, mm",
        after,
        mean,
        "Watertown Arsenal 1900, heights",
        0.1,
        "absolute",
    )
    study.check(
        "force at closing, rod with this yield stress, N",
        force,
        middle,
        "Watertown Arsenal 1900, loads",
        half,
        "absolute",
    )
    study.table(
        "Yield stress, N/mm², for minimum, mean and maximum height after; force at closing for the mean, N",
        ["H in N/mm²", "minimum", "mean", "maximum", "force"],
        rows,
    )
    study.figure("watertown", draw(after, force, stress))


def closing(result: Result) -> float:
    """Force from which the rod stands on a wall, in its second phase, N; NaN where it never does."""
    travels, forces = np.array([(step.travel_mm, step.force_N) for step in result.steps if step.phase == 1]).T
    solid = np.diff(forces) / forces[1:] > VERTICAL * np.diff(travels) / travels[1:]
    return float(forces[np.argmax(solid)]) if solid.any() else np.nan


def rod_explaining(mean: float) -> tuple[float, float, float, float]:
    """Yield stress with which the whole spring comes to a height; height and force then, and the gap of its coils.

    Three runs: with the uniform rod's stress, with its slope, and by the secant of both.
    """
    hardening = HARDENING[1]
    stress, step = explaining(mean, hardening), 1.0
    slope = closed_once(stress + step, hardening)[1] - closed_once(stress, hardening)[1]
    seen: list[tuple[float, float, float]] = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(3):
            case = whole_spring(Path(folder) / "steel.yaml", stress, hardening)
            analysis = Analysis(case, MPI.COMM_SELF)
            result = analysis.run()
            summary = summarise(analysis.setup, result)
            force = closing(result)
            seen.append((stress, summary["free_length_after_mm"], force))
            if len(seen) > 1:
                slope = (seen[-1][1] - seen[-2][1]) / (seen[-1][0] - seen[-2][0])
            stress -= (seen[-1][1] - mean) / slope
        spring = case.spring.build()
    return *seen[-1], float(spring.pitch(0.5 * spring.turns)) - WIRE


def draw(height: float, force_closed: float, stress_found: float) -> Figure:
    """Force at closing over the height after, along the yield stress; the springs; the rod with the stress found."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.8, 3.8), layout="constrained")
        axes = figure.add_subplot()
        stresses = np.arange(1000.0, 1801.0, 100.0)
        for number, hardening in enumerate(HARDENING):
            force, after = np.array([closed_once(stress, hardening) for stress in stresses]).T
            axes.plot(after, 1e-3 * force, f"C{number}.-", lw=1, label=f"uniform rod, H = {hardening:g} N/mm²")
            if number == 0:
                for x, y, stress in list(zip(after, 1e-3 * force, stresses, strict=True))[::2]:
                    axes.annotate(f"{stress:g}", (x, y), (3, -10), textcoords="offset points", fontsize=8)
        low, high = 1e-3 * LOADS.min(), 1e-3 * LOADS.max()
        axes.fill_between([AFTER.min(), AFTER.max()], low, high, color="0.85", label="the springs of 1900")
        axes.plot(height, 1e-3 * force_closed, "k*", ms=9, label=f"rod between seats, {stress_found:.0f} N/mm²")
        axes.vlines(AFTER.mean(), low, high, "0.5", lw=1)
        axes.set(
            xlabel="height after closing in mm (6.30 in = 160.02 mm before)",
            ylabel="force at closing in kN",
            title="Yield stresses in N/mm² that explain the set",
        )
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    return figure
