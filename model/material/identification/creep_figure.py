"""Figure of a fit of creep: relaxation tests, and the law that was fitted to them."""

from dataclasses import replace

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.base.style import STYLE
from coilset.model.material.identification.creep_fit import CreepFit, modulus
from coilset.model.material.identification.relaxing import loss


def creep_figure(result: CreepFit) -> Figure:
    """Loss of load over time, one panel for each kind of test and temperature."""
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
