"""Figures of the study: shear factors, characteristics, stress over the wire's section, mesh convergence."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import TriContourSet

from coilset.model.core.base.style import DIVERGING, STYLE, levels
from coilset.verification.solid_study import pressing, references, study
from coilset.verification.solid_study.pressing import PressedSection


def draw(found: study.Found) -> dict[str, Figure]:
    """Draw all figures that the results allow.

    Args:
        found: of `study.run`.

    Returns:
        Dict: name → matplotlib Figure.
    """
    with mpl.rc_context(STYLE):
        out = {"shear_factors": factors(found["elastic"])}
        for case, solid, rod in study.finest(found):
            out[f"characteristic_C{case.index:g}"] = characteristic(case, solid, rod)
            out[f"sections_C{case.index:g}"] = sections(case, solid, rod)
        if len(study.finest(found)) > 1:
            out["rod_over_index"] = deviations(found["pressed"])
    return out


def factors(results: list[study.Numbers]) -> Figure:
    """Shear factor at inside and outside over the spring index, and its error over the mesh."""
    figure = Figure(figsize=(8.6, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    C = np.linspace(3.5, 13, 60)
    exact, off = np.array([references.goehner_exact(c) for c in C]), []
    left.plot(C, exact, "k-", lw=1, label=["Göhner's equation, solved", None])
    left.plot(C, references.goehner_series(C), "C2:", lw=1.6, label="Göhner 1930, series")
    left.plot(C, references.wahl_factor(C), "C1--", lw=1, label="Wahl 1963")
    for i, index in enumerate(sorted({r["index"] for r in results})):
        meshes = sorted((r for r in results if r["index"] == index), key=lambda r: r["unknowns"])
        best = meshes[-1]
        left.plot([index] * 2, [best["inside"], best["outside"]], "C0o", label=None if i else "solid, finest mesh")
        off.append(abs(best["inside"] / references.goehner_exact(index)[0] - 1))
        error = [abs(r["inside"] / references.goehner_exact(index)[0] - 1) for r in meshes]
        right.loglog([r["unknowns"] for r in meshes], error, "o-", ms=4, lw=1, label=f"D/d = {index:g}")
    figure.suptitle(
        f"The finest solids are within {100 * max(off):.2g} % of Göhner's shear stress at the inside of the coil"
    )
    left.text(9, 1.22, "inside of the coil")
    left.text(7, 0.80, "outside")
    left.set(xlabel="spring index D/d", ylabel="shear stress over 8 F D / (π d³)", title="elastic coil")
    right.axhline(0.02, color="0.5", lw=0.8, ls="--")
    right.set(xlabel="unknowns", ylabel="error of the factor inside", title="against Göhner's equation (dashed: 2 %)")
    for axes in (left, right):
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    return figure


def characteristic(case: PressedSection, solid: study.Numbers, rod: study.Numbers) -> Figure:
    """Axial force and torque over travel, up and down."""
    figure = Figure(figsize=(8.6, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    label = f"solid, {solid['unknowns']} unknowns"
    for axes, name, unit in ((left, "force", "axial force in N"), (right, "torque", "torque about the axis in N mm")):
        axes.plot(rod["travel"], rod[name], "C1-", lw=1.4, label="rod")
        axes.plot(solid["travel"], solid[name], "C0o", ms=4, mfc="none", label=label)
        axes.set(xlabel="travel in mm", ylabel=unit)
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    figure.suptitle(
        f"The rod sets {rod['set']:.3f} mm, the solid {solid['set']:.3f} mm "
        f"(one turn of Ck 15 between clamped heads, D/d = {case.index:g})"
    )
    return figure


def sections(case: PressedSection, solid: study.Numbers, rod: study.Numbers) -> Figure:
    """Shear stress over the mid-section of solid and rod at full travel and after release, and on the diameter."""
    figure = Figure(figsize=(10.5, 6.4), layout="constrained")
    axes = figure.subplots(2, 3)
    for row, (moment, when) in enumerate((("full", "full travel"), ("end", "released"))):
        limit = max(np.abs(np.array(r[moment]["stress"])[:, 2]).max() for r in (solid, rod))
        for column, (result, name) in enumerate(((solid, "solid"), (rod, "rod"))):
            shown = _disk(axes[row, column], result[moment], limit)
            axes[row, column].set(title=f"{name}, {when}", xlabel="outward in mm", ylabel="across in mm")
        figure.colorbar(shown, ax=axes[row, 1], label="τ along the coil's axis in MPa", shrink=0.85)
        for result, style, name in ((solid, "C0.-", "solid"), (rod, "C1.--", "rod")):
            axes[row, 2].plot(*study.diameter(result, moment), style, ms=4, lw=1.3, label=name)
        axes[row, 2].set(xlabel="outward from the wire's centre in mm", ylabel="τ in MPa", title=when)
        axes[row, 2].grid(lw=0.3)
        axes[row, 2].legend(fontsize=8)
    inside, beside = (f"{study.diameter(r, 'end')[1][0]:.0f}".replace("-", "−") for r in (solid, rod))
    figure.suptitle(
        f"{inside} MPa of shear remain at the inside of the coil (left) in the solid, {beside} MPa in "
        f"the plane rod\n(mid-section of a clamped turn of Ck 15, D/d = {case.index:g})"
    )
    return figure


def _disk(axes: Axes, looked_at: study.Numbers, limit: float) -> TriContourSet:
    y, z = np.array(looked_at["y"]), np.array(looked_at["z"])
    shown = axes.tricontourf(y, z, np.array(looked_at["stress"])[:, 2], levels=levels(-limit, limit), cmap=DIVERGING)
    angle = np.linspace(0, 2 * np.pi, 181)
    radius = 0.5 * pressing.WIRE
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), "k-", lw=0.8)
    axes.set(aspect="equal")
    return shown


def deviations(pressed: list[study.Pressed]) -> Figure:
    """The rod's deviation in force and set over the spring index, and the solid's change with the mesh."""
    figure = Figure(figsize=(8.6, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    by_index = {}
    for case, solid, rod in sorted(pressed, key=lambda f: f[1]["unknowns"]):
        if case.steps == 12:
            by_index[case.index] = study.numbers(case, solid, rod)
    for name, style in (("force at full travel", "C0o-"), ("set", "C1s-"), ("torque at full travel", "C2^-")):
        values = [100 * (by_index[C][name][1] / by_index[C][name][0] - 1) for C in sorted(by_index)]
        left.plot(sorted(by_index), values, style, ms=5, lw=1, label=name)
    left.axhline(0, color="k", lw=0.6)
    left.set(xlabel="spring index D/d", ylabel="rod over solid − 1, in %", title="what the rod misses")
    meshes = sorted((f for f in pressed if f[0].index == 8 and f[0].steps == 12), key=lambda f: f[1]["unknowns"])
    best = meshes[-1][1]
    i = meshes[-1][0].steps
    unknowns = [solid["unknowns"] for _, solid, _ in meshes[:-1]]
    forces = [abs(solid["force"][i] / best["force"][i] - 1) for _, solid, _ in meshes[:-1]]
    sets = [abs(solid["set"] / best["set"] - 1) for _, solid, _ in meshes[:-1]]
    right.loglog(unknowns, forces, "C0o-", ms=5, lw=1, label="force at full travel")
    right.loglog(unknowns, sets, "C1s-", ms=5, lw=1, label="set")
    right.set(
        xlabel="unknowns of the solid",
        ylabel="relative change to the finest mesh",
        title="the solid's own change, D/d = 8",
    )
    for axes in (left, right):
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    least = min(by_index)
    force, back = (
        100 * abs(by_index[least][k][1] / by_index[least][k][0] - 1) for k in ("force at full travel", "set")
    )
    figure.suptitle(f"At D/d = {least:g} the plane rod misses {force:.2g} % of the force and {back:.2g} % of the set")
    return figure
