"""Springs that grow stiffer: their coils lie down one after the other, the wide or close ones first.

Slender springs of thin wire stay elastic until they are almost solid. Their characteristics stand against
`torsion_characteristic`, which knows of neither heads, nor bending, nor that a coil needs a whole turn to lie down.
Their sections are plane, as the formula's.
Coils whose radii differ by a good part of a wire slip over each other in the end, as there is no friction; the cone on
a seat is so flat that they pass each other freely, and the other springs are compressed less far.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import check
from coilset.model.tools.figures.png import save
from coilset.verification.spring_references.curved_rod import torsion_characteristic

STEPS = 26
CASES = {  # ends, travel in mm, spring
    "telescoping cone on a seat": (
        "seats",
        13.0,
        {
            "wire_diameter": 2.0,
            "mean_diameter": {"shape": "cone", "bottom": 70.0, "top": 30.0},
            "turns": 6.0,
            "pitch": 3.0,
        },
    ),
    "barrel": (
        "clamped",
        13.0,
        {
            "wire_diameter": 2.0,
            "mean_diameter": {"shape": "barrel", "ends": 30.0, "middle": 44.0},
            "turns": 8.0,
            "pitch": 3.2,
        },
    ),
    "variable pitch": (
        "clamped",
        15.0,
        {
            "wire_diameter": 2.0,
            "mean_diameter": 40.0,
            "turns": 8.0,
            "pitch": {"turns": [0, 8], "values": [3.0, 5.0], "interpolation": "linear"},
        },
    ),
}


@dataclass(frozen=True)
class Characteristic:
    """Of a solve: travel and force of every step, shape (STEPS,); the formula's travel at these forces; mm and N.

    `work` is the maximum plastic work at any point, MPa.
    """

    travel: np.ndarray
    force: np.ndarray
    formula: np.ndarray
    work: float

    @property
    def rates(self) -> np.ndarray:
        """Slopes between the steps, N/mm, shape (STEPS,)."""
        return np.diff(self.force, prepend=0.0) / np.diff(self.travel, prepend=0.0)


def solve(name: str) -> Characteristic:
    """The `Characteristic` of a case."""
    ends, travel, spring = CASES[name]
    loading = [{"to": {"travel": travel}, "steps": STEPS}]
    mesh = {"section": {"kind": "plane", "radial": 3, "angular": 8}}
    data = {"spring": spring, "ends": ends, "loading": loading, "mesh": mesh, "accuracy": "none"}
    analysis = Analysis(check(data), MPI.COMM_SELF)
    steps = analysis.run().steps
    force = np.array([step.force_N for step in steps])
    formula = torsion_characteristic(analysis.spring, analysis.law.G, force)
    work = float(analysis.snapshot("end").point_state[..., 6].max())
    return Characteristic(np.array([step.travel_mm for step in steps]), force, formula, work)


def figure(found: Mapping[str, Characteristic], path: str | Path) -> None:
    """Draw characteristics, name → `Characteristic`, beside the formula's."""
    with mpl.rc_context(STYLE):
        drawn = Figure(figsize=(9.6, 3.7), layout="constrained")
        for place, (name, one) in enumerate(found.items()):
            axes = drawn.add_subplot(1, len(found), place + 1)
            axes.plot([0, *one.travel], [0, *one.force], "o-", ms=3, lw=1.3, label="rods and contact")
            axes.plot([0, *one.formula], [0, *one.force], "k--", lw=1.0, label="∫ min(64 F r³/G d⁴, p − p_block) dt")
            reach = 0.6 * one.force[-1] / one.rates[0]
            axes.plot([0, reach], [0, one.rates[0] * reach], "C1:", lw=1.2, label="initial rate")
            axes.set(title=name, xlabel="travel in mm", ylabel="force in N")
            axes.grid(lw=0.3)
        drawn.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8)
        off = 100.0 * max(np.abs(one.formula / one.travel - 1.0).max() for one in found.values())
        title = (
            f"Springs grow stiffer as their coils close one by one; travel within {off:.1f} % of torsion alone "
            "(Rodriguez et al. 2006)"
        )
        drawn.suptitle(title, fontsize=10)
        save(drawn, Path(path))
