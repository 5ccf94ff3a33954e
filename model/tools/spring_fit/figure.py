"""Figure of a fit: the readings with the fitted law's curves, and the residuals over the tester's errors."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.tools.spring_fit.fit import SpringFit
from coilset.model.tools.spring_fit.pressing import Pressing


def figure(fit: SpringFit) -> Figure:
    """One column for each file."""
    model, ours = fit.model, fit.model.uniform(fit.x)
    with mpl.rc_context(STYLE):
        sheet = Figure(figsize=(max(6.2, 4.2 * len(ours)), 5.4), layout="constrained")
        axes = sheet.subplots(2, len(ours), squeeze=False, sharex="col", height_ratios=[2.2, 1])
        for k, (one, weight) in enumerate(zip(model.pressings, model.weights, strict=True)):
            found = ours[k] + model.lacking(fit.x, k)
            _curves(axes[0, k], one, found, weight)
            measured = one.travel if one.lengths else one.force
            used = np.isfinite(weight)
            axes[1, k].axhspan(-2.0, 2.0, color="0.9", lw=0)
            for branch in np.unique(one.branch):
                here = used & (one.branch == branch)
                axes[1, k].plot(
                    _across(one)[here], ((measured - found) / weight)[here], ".", ms=4, color=_colour(branch)
                )
            axes[1, k].axhline(0.0, color="k", lw=0.6)
            axes[1, k].set(xlabel="height in mm" if one.lengths else "travel in mm")
        axes[1, 0].set(ylabel="measured − fitted,\nover tester's error")
        verdict = fit.misfit or f"the residuals scatter, with {fit.scatter:.2g} of the tester's errors"
        sheet.suptitle(verdict[0].upper() + verdict[1:], fontsize=9)
    return sheet


def _curves(axes: Axes, one: Pressing, found: np.ndarray, weight: np.ndarray) -> None:
    across, sign = _across(one), -1.0 if one.lengths else 1.0
    shift = one.spring.free_length if one.lengths else 0.0
    measured = shift + sign * one.travel if one.lengths else one.force
    for branch in np.unique(one.branch):
        here = one.branch == branch
        line = shift + sign * found[here] if one.lengths else np.where(found[here] > 0.0, found[here], 0.0)
        axes.plot(across[here], measured[here], "o", ms=3.5, mfc="none", mew=0.7, color=_colour(branch))
        axes.plot(across[here], line, "-", lw=1.2, color=_colour(branch))
    unused = ~np.isfinite(weight)
    if unused.any():
        axes.plot(across[unused], measured[unused], "x", ms=4, color="0.5", label="not used: free, or coils closed")
    axes.plot([], [], "ko", ms=3.5, mfc="none", label="measured")
    axes.plot([], [], "k-", lw=1.2, label="fitted")
    axes.set(ylabel="free length in mm" if one.lengths else "force in N", title=one.name)
    axes.legend(fontsize=8)


def _across(one: Pressing) -> np.ndarray:
    """What the readings are drawn over: the travel, or the height to which a length belongs."""
    if not one.lengths:
        return one.travel
    return np.array([one.spring.free_length - (one.ends[branch - 1] or 0.0) for branch in one.branch])


def _colour(branch: int) -> str:
    return f"C{branch % 2}"
