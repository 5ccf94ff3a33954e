"""Figure of a fit of creep: relaxation tests, and the law that was fitted to them."""

from dataclasses import replace

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.tools.identification.creep_fit import CreepFit, modulus
from coilset.model.tools.identification.relaxation_tests import Readings
from coilset.model.tools.identification.relaxing import loss


def creep_figure(result: CreepFit) -> Figure:
    """Loss of load over time, one panel for each kind of test and temperature; over stress if there is one time."""
    if len(np.unique(np.concatenate([tests.hours for tests in result.tests]))) == 1:
        return _over_stress(result)
    panels = [(tests, T) for tests in result.tests for T in np.unique(tests.temperature)]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(3.4 * max(len(panels), 2), 3.6), layout="constrained")
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        for place, (tests, T) in zip(axes, panels, strict=True):
            for k, stress in enumerate(np.unique(tests.stress[tests.temperature == T])):
                here = (tests.temperature == T) & (tests.stress == stress)
                fine = np.geomspace(tests.hours[here].min(), tests.hours[here].max(), 60)
                same = np.ones_like(fine)
                line = replace(tests, stress=stress * same, temperature=T * same, hours=fine, loss=0.0 * same)
                values = loss(result.form, result.hardening, result.constants, line, modulus(result.law, line))
                place.semilogx(fine, values, color=f"C{k}")
                place.plot(tests.hours[here], tests.loss[here], "o", ms=4, color=f"C{k}", label=f"{stress:g} N/mm²")
            place.set(xlabel="time in h", title=f"{tests.kind}, {T:g} K")
            place.legend(title="line: fitted")
        axes[0].set(ylabel="loss of load in %")
    return figure


def _over_stress(result: CreepFit) -> Figure:
    """As catalogues print it: loss after one time over stress, a curve for each temperature, over the tests' range."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.6 * len(result.tests), 3.8), layout="constrained")
        for place, tests in zip(figure.subplots(1, len(result.tests), squeeze=False)[0], result.tests, strict=True):
            fine = np.linspace(tests.stress.min(), tests.stress.max(), 60)
            same = np.ones_like(fine)
            for k, T in enumerate(np.unique(tests.temperature)):
                line = Readings(tests.kind, fine, T * same, tests.hours[0] * same, 0.0 * same)
                values = loss(result.form, result.hardening, result.constants, line, modulus(result.law, line))
                half, here = result.uncertainty(line), tests.temperature == T
                place.fill_between(fine, np.maximum(values - half, 0.0), values + half, color=f"C{k}", alpha=0.15, lw=0)
                place.plot(fine, values, color=f"C{k}")
                place.plot(tests.stress[here], tests.loss[here], "o", ms=5, color=f"C{k}", label=f"{T:g} K")
            what = "stress" if tests.kind == "tension" else "shear stress at the surface"
            place.set(xlabel=f"{what} at the start in N/mm²", ylabel=f"loss of load after {tests.hours[0]:g} h in %")
            place.set_ylim(0.0, 1.25 * max(tests.loss.max(), 1.0))
            place.legend(title="line: fitted, band: 95 %")
    return figure
