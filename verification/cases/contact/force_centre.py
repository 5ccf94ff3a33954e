"""Where the force goes: from the wire's tip inwards as the end coils lie down, and back at lift-off

Springs with open and with closed ends between flat guided seats without friction; short grooves hold their tips
sideways and let them roll (docs/contact.md). What is known about them:

- The end coils bear unevenly, so the resultant is off the axis, and wanders as they roll down on the seats (thesis,
  7.1, figures 7.2 and 7.3, and 7.2.2, after Huhnen, Draht 17 and 18, 1966/67, and Grueber, 1981). While they lie down
  the rate grows, and below a certain load of the release they lift off and it falls again (thesis, 7.2.2). The thesis
  prints no numbers, and its figure 7.14 is lost: the bounds are ours, a third of the radius for the final centre of
  pressure and 0.6 for the rate after lift-off over the rate before.
- Springs with closed ends that are not ground are not linear at first: their end coils are out of balance and let the
  spring bend until it is stable (Cadet and others, Mechanics & Industry 22, 50, 2021: three slopes).

The reference values are closed formulas, from Castigliano's theorem with only the torque and bending moment of the flat
coil. A spring of n whole turns that bears on its tips alone is loaded along the line through them: at the angle φ the
torque is F r (1 − cos φ) and the bending moment F r sin φ, so it is softer than Wahl's formula by the factor 3/2 + G
Ip/(2 E I). Lying down, R = G d⁴/(64 r³ n) with the active turns n = ∫ (Mt/F r)² dt. With tips held against rotation,
the force of a spring of n = k + ½ turns acts at the distance e = 2 r/(π n (1 + G Ip/E I)) from the axis, perpendicular
to the line through the tips: the torque F r rotates the ends by F r/(G Ip) ∫ t ds = 2 F r²/(G Ip), and the moment F e
rotates them back.
"""

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_files import run_of
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.results.records.provenance import origin
from coilset.model.tools.figures.panels.seats import contact
from coilset.model.tools.figures.png import draw
from coilset.verification.study import Study

FAST = True
WIRE, RADIUS = 4.0, 16.0
SPRINGS = {
    "open": {"wire_diameter": WIRE, "mean_diameter": 2 * RADIUS, "turns": 5.0, "pitch": 9.0},
    "closed": {
        "wire_diameter": WIRE,
        "mean_diameter": 2 * RADIUS,
        "turns": 7.0,
        "free_length": 60.0,
        "end_coils": "closed",
    },
}
GROOVE = {"hold": "groove", "groove": 0.1}
TRAVEL, STEPS = 18.0, 18
PRESSED, DOWN, LOW, UP = 16.0, 12, 20.0, (12, 24)  # mm, steps, N, steps
PLANE = {"section": {"kind": "plane"}}  # as the formulas here, which are those of straight wire
COLOURS = {"open": "C0", "closed": "C1"}


def press(
    ends: str | dict[str, float], material: str, loading: list[dict[str, Any]], seats: dict[str, Any] | None = None
) -> Analysis:
    """Analysis of a spring after its program."""
    spring = SPRINGS[ends] if isinstance(ends, str) else ends
    analysis = Analysis(
        check(
            {
                "spring": spring,
                "material": material,
                "seats": seats or GROOVE,
                "loading": loading,
                "mesh": PLANE,
                "accuracy": "none",
            }
        ),
        MPI.COMM_SELF,
    )
    analysis.run()
    return analysis


def columns(analysis: Analysis) -> dict[str, np.ndarray]:
    """Travel, force, tangent rate and, at the bottom, distances of pressure and force centre, wire in contact."""
    steps, seats = analysis.result.steps, [one.bottom for one in analysis.result.seats]
    travel, force = (np.array([getattr(step, name) for step in steps]) for name in ("travel_mm", "force_N"))
    out = {"travel": travel, "force": force}
    out["rate"] = np.diff(force, prepend=0.0) / np.diff(travel, prepend=0.0)
    out["pressure"] = np.hypot([b.pressure_x_mm for b in seats], [b.pressure_y_mm for b in seats])
    out["centre"] = np.array([b.eccentricity_mm for b in seats])
    out["down"] = np.array([b.down_turns for b in seats])
    out["active"] = np.array([one.active_turns for one in analysis.result.seats])
    return out


def run(study: Study) -> None:
    """Elastic springs pressed down, springs of Ck 15 released, and held tips."""
    elastic = {ends: press(ends, "elastic", [{"to": {"travel": TRAVEL}, "steps": STEPS}]) for ends in SPRINGS}
    program = [
        {"to": {"travel": PRESSED}, "steps": DOWN},
        {"to": {"force": LOW}, "steps": UP[0]},
        {"to": {"force": 0}, "steps": UP[1]},
    ]
    plastic = {ends: press(ends, "ck15", program) for ends in SPRINGS}
    law = elastic["open"].law
    bending = 1.0 / (1.0 + law.nu)  # G Ip / E I of a round wire
    wahl = law.G * WIRE**4 / (64 * RADIUS**3)  # of one turn
    tips = wahl / (5.0 * (1.5 + 0.5 * bending))
    for ends, analysis in elastic.items():
        judge_path(study, ends, columns(analysis), wahl)
    first = columns(elastic["open"])["rate"][0]
    study.check("open ends: initial rate, on the tips alone, N/mm", first, tips, "Castigliano", 0.02)
    for ends, analysis in plastic.items():
        after = judge_release(study, ends, columns(analysis), wahl)
        if ends == "open":
            # of the spring as wound; this one has set, and by more at its end coils on harder seats: −0.4 % with a
            # bedding of E/40, +1.2 % with E/10, +2.9 % with E/4
            study.check("release, open ends: rate after lift-off, N/mm", after, tips, "Castigliano", 0.04)
    held_tips(study, bending)
    draw_paths(study, elastic)
    draw_release(study, plastic, tips)


def judge_path(study: Study, ends: str, c: dict[str, np.ndarray], wahl: float) -> None:
    """The centre of pressure begins at the tip and goes inwards as soon as the coil touches elsewhere."""
    study.check(
        f"{ends} ends: initial centre of pressure over r", c["pressure"][0] / RADIUS, 1.0, "only the tip touches", 0.005
    )
    study.check(f"{ends} ends: initial force centre over r", c["centre"][0] / RADIUS, 1.0, "the same", 0.02)
    on_tip = int(np.argmax(c["pressure"] < 0.995 * RADIUS))
    outwards = np.diff(c["pressure"][on_tip - 1 :]).max()
    study.check(
        f"{ends} ends: maximum outward movement once the coil lies flat, mm",
        outwards,
        0.0,
        "thesis, 7.1",
        kind="at_most",
    )
    study.check(
        f"{ends} ends: final centre of pressure over r",
        c["pressure"][-1] / RADIUS,
        1 / 3,
        "thesis, 7.1",
        kind="at_most",
    )
    study.check(
        f"{ends} ends: final rate, N/mm", c["rate"][-1], wahl / c["active"][-1], "G d⁴/(64 r³ n), n active turns", 0.05
    )
    shown = {
        "travel, mm": c["travel"],
        "force, N": c["force"],
        "rate, N/mm": c["rate"],
        "pressure centre/r": c["pressure"] / RADIUS,
        "force centre/r": c["centre"] / RADIUS,
        "turns down": c["down"],
        "active turns": c["active"],
    }
    rows = np.round(np.transpose(list(shown.values())), 3)[1::2]
    study.table(f"{ends} ends, elastic: bottom seat", list(shown), rows.tolist())


def judge_release(study: Study, ends: str, c: dict[str, np.ndarray], wahl: float) -> float:
    """Lift-off during release: one contact remains, at r from the axis, and the rate falls; the rate after it."""
    release = np.arange(DOWN, DOWN + sum(UP) - 1)  # at zero force nothing bears
    is_alone = c["pressure"][release] > 0.99 * RADIUS
    lying, alone = release[~is_alone], release[is_alone]
    place, before, after = f"release, {ends} ends", c["rate"][lying[1]], c["rate"][alone[-1]]
    study.check(
        f"{place}: rate with the coil lying flat, N/mm",
        before,
        wahl / c["active"][lying[1]],
        "G d⁴/(64 r³ n), n active turns",
        0.05,
    )
    study.check(
        f"{place}: rate after lift-off over the rate before",
        after / before,
        0.6,
        "thesis, 7.2.2: it falls",
        kind="at_most",
    )
    where = "at the tip" if c["down"][alone[-1]] == 0.0 else f"{c['down'][alone[-1]]:.2f} turns from the tip"
    study.note(
        f"{place}: lift-off between {c['force'][lying[-1]]:.1f} and {c['force'][alone[0]]:.1f} N; then the wire "
        f"touches {where} only."
    )
    return after


def held_tips(study: Study, bending: float) -> None:
    """Tips held against rotation: force centre of springs of n + ½ turns at a small load."""
    for n in (2.5, 4.5, 8.5):
        spring = {"wire_diameter": 2.0, "mean_diameter": 2 * RADIUS, "turns": n, "pitch": 4.0}
        analysis = press(spring, "elastic", [{"to": {"travel": 0.2}, "steps": 1}], {"hold": "tips"})
        seat = analysis.result.seats[0].bottom
        study.check(
            f"tips held, {n:g} turns: e/r",
            seat.centre_y_mm / RADIUS,
            2 / (np.pi * n * (1 + bending)),
            "Castigliano",
            0.02,
        )


def draw_paths(study: Study, elastic: dict[str, Analysis]) -> None:
    """Paths in plan, distances over travel, and pressure along the end coil."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.4, 7.6), layout="constrained")
        (plan, over), maps = figure.subplots(2, 2)
        around = np.linspace(0, 2 * np.pi, 181)
        plan.plot(np.cos(around), np.sin(around), color="0.7", lw=0.8)
        plan.plot(1, 0, "ks", ms=6, label="wire's tip")
        plan.plot(0, 0, "k+", ms=9)
        for (ends, analysis), axes in zip(elastic.items(), maps, strict=True):
            c, colour = columns(analysis), COLOURS[ends]
            seats = [one.bottom for one in analysis.result.seats]
            for x, y, style, words in (
                ("pressure_x_mm", "pressure_y_mm", "o-", "centre of pressure"),
                ("centre_x_mm", "centre_y_mm", "^:", "force centre"),
            ):
                path = np.array([[getattr(b, x), getattr(b, y)] for b in seats]) / RADIUS
                plan.plot(*path.T, style, color=colour, ms=3, lw=1.0, label=f"{words}, {ends} ends")
            over.plot(
                c["travel"],
                c["pressure"] / RADIUS,
                "o-",
                color=colour,
                ms=3,
                lw=1.0,
                label=f"centre of pressure, {ends} ends",
            )
            over.plot(
                c["travel"], c["centre"] / RADIUS, "^:", color=colour, ms=3, lw=1.0, label=f"force centre, {ends} ends"
            )
            pressure = contact(run_of(analysis.setup, analysis.result, origin(analysis.case)), "bottom")
            assert pressure is not None
            draw(axes, pressure)
            axes.set_title(f"pressure on the bottom seat, {ends} ends")
        plan.set(aspect="equal", xlabel="x/r", ylabel="y/r", title="bottom seat, seen along the axis")
        over.set(xlabel="travel in mm", ylabel="distance from the axis over r", ylim=(0, 1.1), title="over the travel")
        for axes in (plan, over):
            axes.grid(lw=0.3)
        plan.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)  # clear of the ring
        over.legend(fontsize=7)
        figure.suptitle(
            "The force acts at the wire's tip first, then moves inwards\n"
            "(elastic springs between flat guided seats, tips held sideways by short grooves)"
        )
    study.figure("force_centre", figure)


def draw_release(study: Study, plastic: dict[str, Analysis], tips: float) -> None:
    """Characteristic, rate, wire in contact and centre of pressure on the way down and back."""
    panels = (
        ("force", "force in N"),
        ("rate", "tangent rate in N/mm"),
        ("down", "turns of the bottom end down"),
        ("pressure", "centre of pressure from the axis in mm"),
    )
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 6.8), layout="constrained")
        for axes, (name, words) in zip(figure.subplots(2, 2).flat, panels, strict=True):
            for ends, analysis in plastic.items():
                c = columns(analysis)
                for part, style, way in ((slice(0, DOWN), "o-", "down"), (slice(DOWN, None), "o--", "release")):
                    axes.plot(
                        c["travel"][part],
                        c[name][part],
                        style,
                        ms=3,
                        lw=1.0,
                        color=COLOURS[ends],
                        mfc="none" if way == "release" else None,
                        label=f"{ends} ends, {way}",
                    )
            axes.set(xlabel="travel in mm", ylabel=words)
            axes.grid(lw=0.3)
            if name == "rate":
                line = axes.axhline(tips, color="k", lw=0.9, ls=":", label="open ends on their tips, Castigliano")
                axes.legend(handles=[line], fontsize=8, loc="lower right")
        figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8)
        figure.suptitle(
            "Once the ends lift off, the rate of release falls\n(springs of Ck 15, pressed 16 mm and released)"
        )
    study.figure("release", figure)
