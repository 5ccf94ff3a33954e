"""Numbers, files and figures of turns as a solid, each beside those of the rod."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.results.files.folder import subfolder
from coilset.model.core.results.files.grid_file import write_grid
from coilset.model.core.results.records.releases import last_release
from coilset.model.physics.solid.output import picture
from coilset.model.tools.figures import display
from coilset.model.tools.figures.png import save
from coilset.model.tools.studies.turn import TurnAnalysis

FIELD = "von Mises stress"


def summarise(analysis: TurnAnalysis) -> dict[str, Any]:
    """Summary of a run, of the whole spring, under the names of a spring's run; None where the run has no such number.

    `rod` has the same numbers of the rod, with the same turns and ends.
    """
    result, moments = analysis.result, analysis.result.moments
    forces, rod_forces = ([getattr(step, name) for step in result.steps] for name in ("force_N", "rod_force_N"))
    greatest = max(forces, default=0.0, key=abs)
    released = bool(moments) and abs(moments[-1].force) <= 1e-4 * abs(greatest)
    of_rod, travel = last_release(analysis.rod.setup, analysis.rod.result), analysis.travel
    rod_travel = of_rod.set / analysis.part if of_rod else 0.0
    if moments and moments[-1].free:
        travel = analysis.spring.free_length - moments[-1].height / analysis.part
    losses = [(step.load_loss_percent, step.rod_load_loss_percent) for step in result.steps]
    loss, rod_loss = next((one for one in reversed(losses) if one[0] is not None), (None, None))

    def numbers(travel: float, rate: float, force: float, shears: list[float], loss: float | None) -> dict[str, Any]:
        return {
            "set_mm": travel if released else None,
            "rate_N_per_mm": rate,
            "force_max_N": force,
            "shear_inside_max_MPa": max(shears, default=None, key=abs),
            "residual_shear_inside_MPa": shears[-1] if released else None,
            "load_loss_percent": loss,
        }

    shears, rod_shears = [float(m.shear[0]) for m in moments], [m.rod_inside for m in moments]
    rod_rate = analysis.rod.result.rate * analysis.part
    return {
        "complete": result.complete,
        "free_length_before_mm": analysis.spring.free_length,
        **numbers(travel, result.rate, greatest, shears, loss),
        "rod": numbers(rod_travel, rod_rate, max(rod_forces, default=0.0, key=abs), rod_shears, rod_loss),
        "material": analysis.law.name,
        "turns": analysis.spring.turns,
        "turns_of_solid": analysis.turns,
        "unknowns": analysis.problem.unknowns,
        "steps": len(result.steps),
        "iterations": sum(step.iterations for step in result.steps),
    }


def write_fields(folder: Path, analysis: TurnAnalysis) -> None:
    """fields/*.vtu: the deformed solid at the end of each phase, with the fields of `model.solid.output.grid`."""
    fields = subfolder(folder, "fields")
    for number, moment in enumerate(analysis.result.moments, 1):
        if moment.body is not None:
            write_grid(fields / f"{number:02d}_{moment.name.replace(' ', '_')}.vtu", moment.body)


def write_pictures(folder: Path, analysis: TurnAnalysis) -> None:
    """comparison.png, and, where there is a display, solid.png."""
    moments = analysis.result.moments
    save(figure(analysis), folder / "comparison.png")
    loaded = max(moments, key=lambda one: abs(one.force))
    shown = [loaded, moments[-1]] if moments[-1] is not loaded else [loaded]
    bodies = {one.name: one.body for one in shown if one.body is not None}
    if display.ensure():
        picture(folder / "solid.png", bodies, FIELD, "MPa")


def figure(analysis: TurnAnalysis) -> Figure:
    """Force over travel, and shear along the diameter of the middle section; circles are the rod's."""
    steps, moments = analysis.result.steps, analysis.result.moments
    loaded = max(moments, key=lambda one: abs(one.force))
    with mpl.rc_context(STYLE):
        sheet = Figure(figsize=(9.6, 3.8), layout="constrained")
        left, right = sheet.subplots(1, 2)
        travel = [0.0, *(step.travel_mm for step in steps)]
        left.plot(travel, [0.0, *(step.force_N for step in steps)], "C0-", lw=1.4, label="solid")
        rod = [0.0, *(step.rod_force_N for step in steps)]
        at = [0.0, *(step.travel_mm / analysis.part for step in analysis.rod.result.steps[: len(steps)])]
        left.plot(at, rod, "ko", ms=4, mfc="none", label="rod")
        left.set(xlabel="travel of the spring in mm", ylabel="axial force in N")
        for style, moment in (("C0-", loaded), ("C1-", moments[-1])):
            right.plot(analysis.diameter, moment.shear, style, lw=1.4, label=moment.name)
            right.plot(analysis.diameter[0], moment.rod_inside, f"{style[:2]}o", mfc="none", label=None)
        right.axhline(0.0, color="k", lw=0.5)
        right.set(xlabel="outward from the wire's centre in mm", ylabel="shear stress across the wire in MPa")
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend()
        index = analysis.mean_diameter / analysis.wire_diameter
        sheet.suptitle(
            f"{analysis.turns:g} of {analysis.spring.turns:g} turns as a solid, D/d = {index:.3g}; circles: the rod"
        )
    return sheet
