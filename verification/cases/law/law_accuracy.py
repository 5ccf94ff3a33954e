"""Both integrators of the law against Heun's method with a tolerance of 1e-8: error of stress over the strain increment

Ck 15 along tension, reversed torsion and tension with an abrupt change to torsion, one step per increment (Heun without
its error control). The maximum error of stress along the path, over the flow stress, must fall with the square of the
increment for both; Heun with its error control must keep its tolerance whatever the increment. That the reference
itself is right is shown elsewhere: `tests/verification/test_law_accuracy.py` integrates the rate equations as they
stand, in 3 × 3 tensors with scipy's DOP853.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.point import points
from coilset.verification.references import heun
from coilset.verification.study import Study

FAST = True
INCREMENTS = np.array([1e-3, 5e-4, 2.5e-4, 1.25e-4])
PATHS: dict[str, list[tuple[float, float, float]]] = {
    "tension": [(0.1, 0, 0)],
    "reversed torsion": [(0, 0.1, 0), (0, -0.1, 0)],
    "tension, torsion": [(0.05, 0, 0), (0, 0.1, 0)],
}
MARKS = 5  # places in each piece where the error is taken
METHODS = {
    "return mapping": ("return_mapping", np.inf, "o-"),
    "Heun, one step": ("heun", np.inf, "s-"),
    "Heun, tolerance 1e-4": ("heun", 1e-4, "^--"),
}


def follow(path: list[tuple[float, float, float]], integrator: str, tolerance: float, increment: float) -> np.ndarray:
    """States at the marks; no spin, so that the rod's torsion is pure."""
    law, tolerances = library.load("ck15"), {"tolerance": tolerance} if integrator == "heun" else {}
    state, states = points.initial_state(law, 1), []
    for piece in np.array(path):
        n = int(np.ceil(np.abs(piece).max() / MARKS / increment - 1e-9))
        for _ in range(MARKS):
            for _ in range(n):
                state = heun.UPDATES[integrator](law, state, piece[None] / (n * MARKS), **tolerances)[0]
            states.append(state[0])
    return np.array(states)


def run(study: Study) -> None:
    """Errors and their orders."""
    law, errors = library.load("ck15"), {}
    for name, path in PATHS.items():
        exact = follow(path, "heun", 1e-8, 1e-3)
        flow = np.sqrt(1.5 * law.functions(exact[:, 6])[0])[:, None]
        for method, (integrator, tolerance, _) in METHODS.items():
            states = [follow(path, integrator, tolerance, h) for h in INCREMENTS]
            errors[name, method] = [(np.abs(s - exact)[:, :3] / flow).max() for s in states]
        for method, order in (("return mapping", 2), ("Heun, one step", 2)):
            slope = np.polyfit(np.log(INCREMENTS), np.log(errors[name, method]), 1)[0]
            study.check(f"order of {method}, {name}", slope, order, "order of the method", 0.15, "absolute")
        controlled = max(errors[name, "Heun, tolerance 1e-4"])
        study.check(f"Heun with error control, {name}", controlled, 1e-4, "its tolerance", 0.0, "at_most")
    rows = [[name, method, *(f"{error:.1e}" for error in line)] for (name, method), line in errors.items()]
    study.table(
        "maximum error of stress over the flow stress", ["path", "method", *map("{:g}".format, INCREMENTS)], rows
    )
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 3.8), layout="constrained")
        for axes, name in zip(figure.subplots(1, len(PATHS), sharey=True), PATHS, strict=True):
            for method, (_, _, style) in METHODS.items():
                axes.loglog(INCREMENTS, errors[name, method], style, ms=4, lw=1, label=method)
            axes.set(xlabel="strain increment in 10⁻³", title=name)
            axes.set_xticks(INCREMENTS, [f"{1e3 * h:g}" for h in INCREMENTS])
            axes.minorticks_off()
            axes.grid(lw=0.3, which="both")
        figure.axes[0].set_ylabel("error of the stress over the flow stress")
        figure.axes[0].legend(fontsize=8)
        less = min(np.divide(errors[name, "Heun, one step"], errors[name, "return mapping"]).min() for name in PATHS)
        figure.suptitle(
            "Half the increment quarters the error; one step of Heun's method errs "
            f"at least {less:.2g} times as much as\nthe return mapping "
            "(Ck 15; reference: Heun's method with tolerance 1e-8)"
        )
    study.figure("law_accuracy", figure)
