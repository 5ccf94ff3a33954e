"""Figures of the material: its functions, the response to a program, and the fit of tests."""

import textwrap

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material.law.law import Law
from coilset.model.tools.identification.programs import STRAINS, STRESSES, History, Program
from coilset.model.tools.identification.result import Fit

TITLE = 42  # characters of a title that a column of a fit is wide enough for
GREEK = {"eps": "ε", "gamma": "γ", "sigma": "σ", "tau": "τ"}
SYMBOLS = {name: GREEK[name[:-2]] + name[-2:] for name in STRAINS["solid"] + STRESSES["solid"]}


def material_functions(law: Law) -> Figure:
    """k², ζ and 2Gκ over the plastic work b*, one line per temperature; figures 6.3 to 6.5 of the thesis for Ck 15."""
    work = np.linspace(0.0, law.data.validity.plastic_work, 801)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 3.7), layout="constrained")
        axes = figure.subplots(1, 3)
        for temperature in law.temperatures:
            G = dict(law.constants(temperature))["G"][0]
            k2, _, zeta, _, kappa, _ = law.functions(work, temperature)
            for place, values in zip(axes, (k2 / 1e3, zeta, 2 * G * kappa), strict=True):
                place.plot(work, np.where(np.isfinite(values), values, np.nan), lw=1.3, label=f"{temperature:g} K")
        axes[0].set(ylabel="k² in 10³ N²/mm⁴", title="isotropic hardening")
        axes[1].set(ylabel="ζ in N/mm²", title="kinematic hardening")
        if np.nanmax(zeta) > 0:
            axes[1].set_yscale("log")
        axes[2].set(ylabel="2Gκ (dimensionless)", title="deviation from normality")
        for place in axes:
            place.set_xlabel("plastic work b* in N/mm²")
            place.set_xlim(0, work[-1])
            place.grid(lw=0.3)
        axes[0].legend(title=law.name if np.isfinite(k2).all() else f"{law.name}: never yields")
        figure.suptitle(
            "\n".join([_grown(law, work[-1]), *textwrap.wrap(f"constants: {law.data.source}", 150)]), fontsize=9
        )
    return figure


def _grown(law: Law, work: float) -> str:
    """How far the yield surface grows, as the stress of a tension test without back stress: σF = √(3/2) k."""
    first, last = (np.sqrt(1.5 * law.functions(np.array([b]), law.temperatures[0])[0][0]) for b in (0.0, work))
    if not np.isfinite(first):
        return f"{law.name} never yields"
    change = f"grows from {first:.4g} to {last:.4g}" if last > first * (1.0 + 1e-9) else f"stays at {first:.4g}"
    return f"The yield stress of {law.name} in tension {change} N/mm²"


def program(law: Law, run: Program, history: History) -> Figure:
    """Response to a program: stress over strain, and for the rod the stress path between its yield surfaces."""
    strains, stresses = STRAINS[history.form], STRESSES[history.form]
    moved = [i for i in range(len(strains)) if np.ptp(history.stress[:, i]) > 1e-3]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 4.0), layout="constrained")
        axes = figure.subplots(1, 3 if history.form == "rod" else 2)
        for i in moved:
            label = f"{SYMBOLS[stresses[i]]} over {SYMBOLS[strains[i]]}"
            axes[0].plot(100 * history.strain[:, i], history.stress[:, i], lw=1.3, label=label)
        axes[0].set(xlabel="strain in %", ylabel="stress in N/mm²", title="stress and strain")
        steps = np.linalg.norm(np.diff(history.strain, axis=0), axis=1)
        length = 100 * np.concatenate([[0.0], np.cumsum(steps)])
        for i in moved:
            axes[1].plot(length, history.stress[:, i], lw=1.3, label=SYMBOLS[stresses[i]])
            axes[1].plot(length, history.back[:, i], lw=0.9, ls="--", color=axes[1].lines[-1].get_color())
        for change in np.flatnonzero(np.diff(history.step[1:])) + 1:
            axes[1].axvline(length[change], color="0.7", lw=0.7, ls=":")
        axes[1].plot([], [], "k--", lw=0.9, label="back stress")
        axes[1].set(xlabel="length of the strain path in %", ylabel="stress in N/mm²", title="along the program")
        if history.form == "rod":
            _stress_plane(axes[2], law, history)
        for place in axes[:2]:
            place.grid(lw=0.3)
            if moved:
                place.legend(fontsize=8)
        after = f"after {run.source}" if run.source else ""
        peaks = (f"{SYMBOLS[stresses[i]]} {_reach(history.stress[:, i])}" for i in moved)
        found = f"{run.name} of {law.name}: {', '.join(peaks)} N/mm²"
        figure.suptitle("\n".join(filter(None, (found, after))), fontsize=10)
    return figure


def _reach(stress: np.ndarray) -> str:
    low, high = (f"{value:.0f}".replace("-", "−") for value in (stress.min(), stress.max()))
    return f"from {low} to {high}" if stress.min() < -0.5 else f"up to {high}"


def _stress_plane(axes: Axes, law: Law, history: History) -> None:
    shear = np.sqrt(3.0)
    axes.plot(history.stress[:, 0], shear * history.stress[:, 1], lw=1.3, label="path of the stress")
    angle = np.linspace(0, 2 * np.pi, 181)
    for row, name, style in ((0, "yield surface at the start", "0.6"), (-1, "at the end", "k")):
        k = np.sqrt(law.functions(history.work[row], history.temperature[row])[0])
        if not np.isfinite(k):
            continue
        # 3/2 n11² + 2 n12² = k², σ11 = 3/2 (n11 + B11), τ12 = n12 + B12; B13 plays no part in these programs.
        normal = 1.5 * (np.sqrt(2 / 3) * k * np.cos(angle) + history.back[row, 0])
        tangential = np.sqrt(0.5) * k * np.sin(angle) + history.back[row, 1]
        axes.plot(normal, shear * tangential, lw=0.8, ls="--", color=style, label=name)
    axes.set(xlabel="σ11 in N/mm²", ylabel="√3 τ12 in N/mm²", title="stress plane", aspect="equal")
    axes.grid(lw=0.3)
    reach = 1.5 * max(map(abs, axes.get_xlim() + axes.get_ylim()))
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach))  # room for the legend
    axes.legend(fontsize=7, loc="upper center")


def fit(result: Fit, name: str) -> Figure:
    """Tests, the law fitted to them, and the residual; one column per test."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(3.4 * len(result.tests), 5.6), layout="constrained")
        axes = figure.subplots(2, len(result.tests), sharex="col", squeeze=False, height_ratios=(2, 1))
        for column, test, stress, scatter in zip(axes.T, result.tests, result.stress, result.scatter, strict=True):
            length = 100 * np.concatenate([[0.0], np.cumsum(np.abs(np.diff(test.strain, axis=0)).sum(axis=1))])
            for i, symbol in enumerate(("σ11", "τ12")):
                if not test.stress[:, i].any():  # the shear of a tension test
                    continue
                color = f"C{i}"
                column[0].plot(length, test.stress[:, i], ".", ms=2, alpha=0.4, color=color, label=f"{symbol}, test")
                column[0].plot(length, stress[:, i], lw=1.2, color=color, label=f"{symbol}, law")
                column[1].plot(length, stress[:, i] - test.stress[:, i], ".", ms=2, color=color)
            column[0].set(ylabel="stress in N/mm²", title=test.name)
            column[0].legend(fontsize=7)
            column[1].axhline(0.0, color="k", lw=0.6)
            column[1].set(xlabel="length of the strain path in %", ylabel="law − test in N/mm²")
            column[1].set_title(f"rms {scatter:.3g} N/mm²", fontsize=8)
            for place in column:
                place.grid(lw=0.3)
        tests = f"{len(result.tests)} test{'s' * (len(result.tests) > 1)}"
        found = f"{name} follows {tests} to within {max(result.scatter):.2g} N/mm² (root mean square)"
        figure.suptitle(textwrap.fill(found, TITLE * len(result.tests)), fontsize=10)
    return figure
