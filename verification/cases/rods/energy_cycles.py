"""Energy over a closed load cycle: the work of the head against what is stored, dissipated and kept in the back stress

A spring of Ck 15 (wire 5, D 40, 2.5 turns of pitch 12) is compressed and released to zero force: by 12 mm between
clamped heads, to block between seats. The work of the head ∫ F ds must be recovered in the section points,

    W = ∫ (½ σ²/E + ½ τ²/G) dV + ∫∫ B:dεp dV + ∫ b* dV,    b* = ∫ (σ′ − B):dεp,

the elastic energy of the residual stress, the work against the back stress, and the plastic work measure. With Ḃ = ζ
ε̇p the second part is ∫ d(¾ B11² + B12² + B13²)/ζ, evaluated step by step. The contacts have returned what they stored,
since no force is left. F ds is integrated by the trapezoidal rule, and ζ is taken at the middle of the plastic work of
a step, as in the law, so the sum depends on the steps. The volumes of the points are those of the unloaded curved wire;
the program uses those of its rods.

Tolerance: 1e-4 between clamped heads and 3e-4 to block with 100 steps each way and 16 rods per turn. With 50 and 100
steps the deviations of the sum were 2.0e-4 and 9.4e-5 between the heads, and 2.3e-4 and 1.4e-4 to block.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.springs.placement import gauss_points
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.core.results.records.record import Step
from coilset.verification.study import Study

FAST = False
SPRING = {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0}
CYCLES: dict[str, tuple[str, str | dict[str, float], float]] = {
    "clamped, 12 mm": ("clamped", {"travel": 12.0}, 1e-4),
    "seats, to block": ("seats", "block", 3e-4),
}
STEPS = (50, 100)  # each way


class Ledger:
    """Work and energies of an Analysis, brought up to date by `keep` after each step; N mm."""

    def __init__(self, analysis: Analysis) -> None:
        self.analysis, turns = analysis, analysis.setup.turns
        _, _, length = gauss_points(analysis.spring, turns[:-1], turns[1:], analysis.rod.element.xi)
        section = np.pi * analysis.setup.wire_radius[:, None] ** 2 * length * analysis.rod.element.weights
        points, κ = analysis.rod.rule, analysis.setup.sections.curvature
        g = 1.0 - κ[..., None] * analysis.setup.wire_radius[:, None, None] * points.points[:, 0]  # fibre over axis
        self.volume = section[..., None] * g * points.weights
        self.history = np.zeros((*self.volume.shape, analysis.law.columns(3)))
        self.travel = self.force = self.work = self.back = 0.0
        self.rows: list[tuple[float, ...]] = []

    def keep(self, step: Step) -> None:
        """After a step: travel, work, elastic energy, work against the back stress, plastic work."""
        law, history = self.analysis.law, self.analysis.snapshot("step").point_state
        ζ = law.functions(0.5 * (self.history[..., 6] + history[..., 6]))[2]  # that of the law's step, ΔB = ζ Δεp
        self.back += (self.volume * (squares(history) - squares(self.history)) / ζ).sum()
        self.work += 0.5 * (self.force + step.force_N) * (step.travel_mm - self.travel)
        self.travel, self.force, self.history = step.travel_mm, step.force_N, history.copy()
        stress = history[..., :3]
        density = 0.5 * stress[..., 0] ** 2 / law.E + 0.5 * (stress[..., 1:] ** 2).sum(axis=-1) / law.G
        plastic = (self.volume * history[..., 6]).sum()
        self.rows.append((self.travel, self.work, (self.volume * density).sum(), self.back, plastic))


def squares(history: np.ndarray) -> np.ndarray:
    """¾ B11² + B12² + B13², whose rate over ζ is B:ε̇p."""
    return 0.75 * history[..., 3] ** 2 + history[..., 4] ** 2 + history[..., 5] ** 2


def cycle(ends: str, target: str | dict[str, float], steps: int) -> np.ndarray:
    """Rows of the Ledger, shape (steps done, 5)."""
    loading = [{"to": target, "steps": steps}, {"to": {"force": 0.0}, "steps": steps}]
    case = check({"spring": SPRING, "material": "ck15", "ends": ends, "loading": loading})
    ledger = Ledger(analysis := Analysis(case, MPI.COMM_SELF))
    analysis.run(ledger.keep)
    return np.array(ledger.rows)


def run(study: Study) -> None:
    """Both cycles over the steps."""
    table, found = [], {}
    for name, (ends, target, tolerance) in CYCLES.items():
        for steps in STEPS:
            found[name] = rows = cycle(ends, target, steps)
            _, work, elastic, back, plastic = rows[-1]
            table.append([name, steps, work, elastic, back, plastic, f"{(elastic + back + plastic) / work - 1:+.1e}"])
        study.check(f"energies, {name}, N mm", elastic + back + plastic, work, "work of the head", tolerance)
    columns = ["cycle", "steps each way", "work, N mm", "elastic", "∫ B:dεp", "b*", "sum over work − 1"]
    study.table("after a press and release", columns, table)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.4, 3.6), layout="constrained")
        for axes, (name, rows) in zip(figure.subplots(1, 2), found.items(), strict=True):
            travel, work, elastic, back, plastic = rows.T
            axes.stackplot(
                np.arange(1, len(travel) + 1),
                plastic / 1000,
                back / 1000,
                elastic / 1000,
                alpha=0.75,
                labels=["plastic work b*", "against the back stress", "elastic"],
            )
            axes.plot(np.arange(1, len(travel) + 1), work / 1000, "k-", lw=1.1, label="work of the head")
            axes.set(xlabel="step", ylabel="energy in N m", title=f"{name}, Ck 15")
            axes.grid(lw=0.3)
            axes.legend(fontsize=8, loc="upper left")
    study.figure("energy_cycles", figure)
