"""Table 4.1: Newton, modified Newton and BFGS on one degree of freedom, every printed digit

Δr = 6 − 2 √u from u = 1, solution 9 (chapter 4.4). The three columns run through SNES with the option sets of
`coilset.model.core.equilibrium.newton.methods`, without line search (β = 1) and with the first matrix kept. K⁻¹ of an
iteration is its step over the residual at its start. Tolerance: half of the last printed digit.

Two printed numbers are wrong in their last digits, as Newton's closed formula u ← 6 √u − u shows: 8.4146 for 8.4164 (=
6 √5 − 5), and 2.2360 for 2.2361 (√5 = 2.23607, truncated instead of rounded).
"""

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from petsc4py import PETSc

from coilset.model.core.base.style import STYLE
from coilset.model.core.equilibrium.newton.methods import rod_method
from coilset.verification.study import Study

FAST = True
KEEP = 1_000_000  # iterations before a matrix is set up again
PLAIN = {"snes_linesearch_type": "basic", "snes_rtol": 1e-13, "snes_atol": 0.0, "snes_stol": 0.0}
# method, more options, column name, {iteration: (K⁻¹, u)} as printed, with the two corrections
COLUMNS: list[tuple[str, dict[str, Any], str, dict[int, tuple[float, float]]]] = [
    ("newton", {}, "NR", {1: (1.0, 5.0), 2: (2.2361, 8.4164), 3: (2.9011, 8.9902), 4: (2.9984, 9.0)}),
    (
        "modified-newton",
        {"snes_lag_jacobian": KEEP},
        "MNR",
        {
            1: (1.0, 5.0),
            2: (1.0, 6.5279),
            3: (1.0, 7.4179),
            4: (1.0, 7.9708),
            5: (1.0, 8.3242),
            6: (1.0, 8.5539),
            7: (1.0, 8.7045),
            28: (1.0, 8.9999),
            29: (1.0, 9.0),
        },
    ),
    (
        "bfgs",
        {"snes_qn_restart_type": "none"},
        "BFGS",
        {
            1: (1.0, 5.0),
            2: (1.6180, 7.4721),
            3: (2.4848, 8.7964),
            4: (2.8497, 8.9909),
            5: (2.9822, 8.9999),
            6: (2.9992, 9.0),
        },
    ),
]
SOURCE = {
    ("NR", 2, "u"): "6 √5 − 5; Table 4.1 misprints 8.4146",
    ("NR", 2, "K⁻¹"): "√5; Table 4.1 truncates: 2.2360",
}


def iterate(method: str, extra: dict[str, Any]) -> np.ndarray:
    """States u of all iterations, the start included."""
    X, F, A = PETSc.Vec().createSeq(1), PETSc.Vec().createSeq(1), PETSc.Mat().createAIJ((1, 1))
    A.setUp()
    snes, database, states = PETSc.SNES().create(PETSc.COMM_SELF), PETSc.Options("table41_"), []
    settings = rod_method(method, 1, PLAIN | extra).options
    for key, value in settings.items():
        database[key] = value

    def residual(snes: PETSc.SNES, X: PETSc.Vec, F: PETSc.Vec) -> None:
        F[0] = 2.0 * np.sqrt(X[0]) - 6.0
        F.assemble()

    def tangent(snes: PETSc.SNES, X: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        P[0, 0] = 1.0 / np.sqrt(X[0])
        P.assemble()

    snes.setOptionsPrefix("table41_")
    snes.setFunction(residual, F)
    snes.setJacobian(tangent, A)
    snes.setFromOptions()
    snes.setMonitor(lambda snes, iteration, norm: states.append(snes.getSolution()[0]))
    X[0] = 1.0
    snes.solve(None, X)
    for key in settings:
        database.delValue(key)
    return np.array(states)


def run(study: Study) -> None:
    """All printed numbers of the three columns."""
    found, rows = {}, []
    for method, extra, name, printed in COLUMNS:
        found[name] = u = iterate(method, extra)
        inverse = np.diff(u) / (6.0 - 2.0 * np.sqrt(u[:-1]))
        for i, (k, value) in printed.items():
            for what, ours, reference in (("K⁻¹", inverse[i - 1], k), ("u", u[i], value)):
                source = SOURCE.get((name, i, what), "Table 4.1")
                study.check(f"{name} {what}({i - (what != 'u')})", ours, reference, source, 0.5e-4 + 1e-12, "absolute")
    for i in range(1, 30):
        rows.append([i, *(float(u[i]) if i < len(u) else None for u in found.values())])
    study.table("u(i), ours", ["i", *found], rows[:8] + rows[-2:])
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.0), layout="constrained")
        axes = figure.add_subplot()
        for (_, _, name, printed), marker in zip(COLUMNS, "os^", strict=True):
            error = 9.0 - found[name][:30]
            axes.semilogy(np.where(error > 1e-12, error, np.nan), "-", label=f"{name}, SNES")
            # a printed 9.0000 only says that the error is below 5e-5
            points = [(i, 9.0 - u) for i, (_, u) in printed.items() if u < 9.0]
            axes.semilogy(
                *zip(*points, strict=True),
                marker,
                mfc="none",
                color=axes.lines[-1].get_color(),
                label=f"{name}, Table 4.1",
            )
        axes.axhline(0.5e-4, color="0.5", lw=0.8, ls=":", label="half of the last printed digit")
        axes.set(xlabel="iteration i", ylabel="error 9 − u(i)", title="Δr = 6 − 2 √u, Table 4.1", ylim=(1e-9, 20))
        axes.legend(fontsize=8)
        axes.grid(lw=0.3)
    study.figure("table_4_1", figure)
