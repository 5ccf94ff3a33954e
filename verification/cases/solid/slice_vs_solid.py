"""The helical slice against the solid: one clamped turn of Ck 15, compressed nearly to block and released

The solid is one turn between heads that do not rotate, wire 5 mm, D/d = 4, 6, 8 and 12 (solid-vs-rod); the slice is a
coil without ends. The effect of the ends is given by two rods with the same curved section, a clamped turn and a
uniform coil: the clamped turn carries 0.6, 0.2, 0.0 and −0.1 % more. Their ratio removes the effect of the ends from
the numbers of the solid. The fine solids are the recorded ones of docs/solid.md (14,844 and 33,987 unknowns, minutes to
an hour each), whose own last refinement changes force by 0.03 and set by 0.001 %; the solid of 4,719 unknowns is run
here. The tolerances for the recorded ones, 0.08 % in force and 0.02 % in set, cover that refinement and the digits of
the record; the force of the coarse one differs by 0.2 % from the finest.
"""

import shutil
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.core.base.style import STYLE
from coilset.verification.one_section import recorded_solids as solids
from coilset.verification.one_section.ends import ends as of_ends
from coilset.verification.one_section.slice_runs import Pressed, pressed
from coilset.verification.solid_study.pressing import PressedSection, run_solid
from coilset.verification.solid_study.store import Store
from coilset.verification.study import Study

# D/d: unknowns, force (N) and set (mm) of the solid, docs/solid.md
RECORDED = {
    solid.index: (solid.unknowns, *solid.numbers[:2])
    for solid in solids.RECORDED
    if solid.material == "ck15" and solid.gap == 1.0
}
ACROSS = 9.0


def run(study: Study) -> None:
    """Ends, recorded solids, one solid of our own."""
    store = Store(study.folder / "unfinished", MPI.COMM_SELF, lambda line: print(line, flush=True))
    slices, ends, rows = {}, {}, []
    for index, (unknowns, force, back) in RECORDED.items():
        case = PressedSection(index)
        slices[index] = ours = pressed(index, case.pitch, case.travel, ACROSS)
        ends[index] = more_force, more_set, _ = of_ends(case)
        source = f"solid of {unknowns} unknowns as recorded, effect of its ends removed"
        label = f"D/d = {index:g}, {{}} ({ours.unknowns} unknowns)"
        study.check(label.format("force at full travel, N"), ours.force[-1], force / more_force, source, 8e-4)
        study.check(label.format("set, mm"), ours.set_mm, back / more_set, source, 2e-4)
        rows.append(
            [
                index,
                force,
                ours.force[-1],
                100 * (force / ours.force[-1] - 1),
                100 * (more_force - 1),
                back,
                ours.set_mm,
                100 * (back / ours.set_mm - 1),
                100 * (more_set - 1),
            ]
        )
    study.table(
        "One clamped turn: N, mm, deviations in %",
        [
            "D/d",
            "force, solid",
            "slice",
            "solid/slice",
            "ends",
            "set, solid",
            "slice",
            "solid/slice",
            "ends",
        ],
        rows,
    )
    case = PressedSection(8.0, 2, 16)
    solid = store.get(case.name, lambda: run_solid(case, MPI.COMM_SELF, "auto", store.report))
    source = f"solid of {solid['unknowns']} unknowns, effect of its ends removed"
    study.check(
        "D/d = 8, force at full travel, N", slices[8.0].force[-1], solid["force"][12] / ends[8.0][0], source, 3e-3
    )
    study.check("D/d = 8, set, mm", slices[8.0].set_mm, solid["set"] / ends[8.0][1], source, 3e-4)
    study.figure("slice_vs_solid", _figure(slices, ends, solid))
    shutil.rmtree(store.folder)


def _figure(slices: dict[float, Pressed], ends: dict[float, np.ndarray], solid: dict[str, Any]) -> Figure:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        ours = slices[8.0]
        left.plot(np.append(ours.travel, ours.set_mm), np.append(ours.force, 0.0), "C0-", lw=1.2, label="slice")
        left.plot(
            solid["travel"], solid["force"], "C1o", ms=4, mfc="none", label=f"solid, {solid['unknowns']} unknowns"
        )
        left.set(xlabel="travel in mm", ylabel="axial force in N", title="one clamped turn of Ck 15, D/d = 8")
        indices = list(RECORDED)
        for k, name in enumerate(("force", "set")):
            raw = [100 * (RECORDED[i][1 + k] / (slices[i].force[-1], slices[i].set_mm)[k] - 1) for i in indices]
            clean = [value - 100 * (ends[i][k] - 1) for i, value in zip(indices, raw, strict=True)]
            right.plot(indices, raw, f"C{k}o:", ms=4, lw=1, mfc="none", label=f"{name}, clamped turn")
            right.plot(indices, clean, f"C{k}s-", ms=4, lw=1, label=f"{name}, effect of the ends removed")
        right.axhline(0, color="k", lw=0.6)
        right.set(xlabel="spring index D/d", ylabel="solid over slice − 1, in %", title="fine solids")
        for axes in (left, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
    return figure
