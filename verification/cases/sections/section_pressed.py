"""Plane, curved and warping sections and the slice against the 3D solid, over D/d and pitch: compressed and released

One turn between clamped heads is compressed in 12 steps to nine tenths of the way to block, far beyond yield, and
released. Compared are force at full travel, set, and the residual shear stress at the inside of the coil, at 0.9 of the
wire radius. D/d is 4 to 12 with the pitch that makes the nominal shear strain the same; D/d = 8 is also run with twice
that gap between the coils. The materials are Ck 15 and one with linear hardening, which carries most of its load
elastically.

The numbers of the solid are recorded (its runs take minutes each), with the change due to its last refinement. Those of
the rods are computed here, with 8 × 24 section points. The slice is a coil without ends; the effect of clamped ends is
given by two rods of the same curved section, a clamped turn and a uniform coil, and the numbers of the slice are
multiplied by it. The plane section is shown but not judged: docs/solid.md says what it misses.

The last table measures stress on the wire's surface with the default 4 × 12 section points against 16 × 48.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.verification.one_section.ends import ends, of_turn
from coilset.verification.one_section.recorded_solids import RECORDED, Solid
from coilset.verification.one_section.slice_runs import pressed as press_slice
from coilset.verification.solid_study import pressing
from coilset.verification.solid_study.pressing import FINE
from coilset.verification.study import Study

KINDS = ("plane", "curved", "warping", "slice")
QUANTITIES = ("force at full travel, N", "set, mm", "residual shear inside at 0.9 r, MPa")
TOLERANCES = {"curved": (1.5e-3, 1.5e-3, 4e-2), "warping": (1.5e-3, 1.5e-3, 3e-2), "slice": (1e-3, 1e-3, 1.5e-2)}
RATE = {"curved": 1e-3, "warping": 1e-3}
SURFACE_TOLERANCE = 1e-2
COLOURS = {"plane": "0.5", "curved": "C0", "warping": "C1", "slice": "C2"}
REFINED = 3e-4  # what the solid's last refinement changes in force


def run(study: Study) -> None:
    """All recorded solids, the figure, and the surface with few section points."""
    rows, off = [], {}
    for solid in RECORDED:
        label = f"{solid.material}, D/d = {solid.index:g}, pitch {solid.case.pitch:.4g} mm"
        for kind, found in kinds(solid).items():
            off[solid, kind] = 100.0 * (found[:3] / solid.numbers - 1.0)
            rows.append([label, kind, *off[solid, kind]])
            judge(study, solid, kind, label, found)
    study.table("Deviation from the solid, %", ["case", "section", "force", "set", "residual shear"], rows)
    study.figure("section_pressed", draw(off))
    surface(study)


def kinds(solid: Solid) -> dict[str, np.ndarray]:
    """Kind → force, set, residual shear and, of rods, the force after the first step."""
    found = {}
    for kind in KINDS[:-1]:
        rod = pressing.run_rod(solid.case, {"kind": kind, **FINE})
        found[kind] = np.append(of_turn(rod, solid.case.steps), rod["force"][1])
    coil = press_slice(solid.index, solid.case.pitch, solid.case.travel, material=solid.material)
    # its third axis points up, that of the solid down
    found["slice"] = ends(solid.case) * [coil.force[-1], coil.set_mm, -coil.released[0]]
    return found


def judge(study: Study, solid: Solid, kind: str, label: str, found: np.ndarray) -> None:
    """Check one kind against one solid."""
    source = f"solid, {solid.unknowns} unknowns"
    for name, ours, reference, tolerance in zip(
        QUANTITIES, found, solid.numbers, TOLERANCES.get(kind, ()), strict=False
    ):
        study.check(f"{label}, {kind}: {name}", ours, reference, source, tolerance)
    if solid.elastic and kind in RATE:
        study.check(f"{label}, {kind}: force in the elastic step, N", found[3], solid.elastic, source, RATE[kind])


def draw(off: dict[tuple[Solid, str], np.ndarray]) -> Figure:
    """Deviation from the solid over D/d and over the pitch, for Ck 15."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.8, 6.4), layout="constrained")
        panels = figure.subplots(2, 3, sharey="col")
        solids = [solid for solid in RECORDED if solid.material == "ck15"]
        rows = (
            ([s for s in solids if s.gap == 1.0], lambda s: s.index, "spring index D/d"),
            ([s for s in solids if s.index == 8.0], lambda s: s.case.pitch_angle, "pitch angle in °, D/d = 8"),
        )
        for axes, (chosen, place, xlabel) in zip(panels, rows, strict=True):
            chosen = sorted(chosen, key=place)
            for k, name in enumerate(("force at full travel", "set", "residual shear inside")):
                for kind in KINDS:
                    values = [abs(off[solid, kind][k]) for solid in chosen]
                    axes[k].semilogy(
                        [place(s) for s in chosen], values, "o-", ms=4, lw=1.1, color=COLOURS[kind], label=kind
                    )
                if k == 0:
                    axes[k].axhspan(1e-4, 100.0 * REFINED, color="0.9", lw=0, label="solid's last refinement")
                axes[k].set_ylim(bottom=(1e-3, 1e-3, 1e-1)[k])
                axes[k].set(xlabel=xlabel, title=name)
                axes[k].grid(lw=0.3)
            axes[0].set_ylabel("|deviation from the solid| in %")
        figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=5, fontsize=8)
        worst = {kind: np.max([np.abs(off[solid, kind]) for solid in solids], axis=0) for kind in ("plane", "curved")}
        figure.suptitle(
            f"Curved sections find the solid's force within {worst['curved'][0]:.2g} % and its set within "
            f"{worst['curved'][1]:.2g} %; plane ones miss up to {worst['plane'][1]:.2g} % of the set\n"
            "(one clamped turn of Ck 15, pressed nearly to block and released)"
        )
    return figure


def surface(study: Study) -> None:
    """τ on the surface at the inside, loaded and released, with 4 × 12 and with 16 × 48 section points."""
    rows = []
    for solid in RECORDED:
        if solid.material != "ck15" or solid.gap != 1.0 or solid.index not in (4.0, 8.0):
            continue
        for kind in KINDS[:-1]:
            few, many = (
                pressing.run_rod(solid.case, {"kind": kind, "radial": a, "angular": b})["inside"]
                for a, b in ((4, 12), (16, 48))
            )
            rows.append([solid.index, kind, few[0], many[0], few[1], many[1]])
            for moment, ours, reference in zip(("loaded", "released"), few, many, strict=True):
                name = (
                    f"D/d = {solid.index:g}, {kind}: shear on the surface at the inside, {moment}, 4 × 12 points, MPa"
                )
                study.check(name, ours, reference, "16 × 48 points", SURFACE_TOLERANCE)
    columns = ["D/d", "section", "loaded, 4 × 12", "16 × 48", "released, 4 × 12", "16 × 48"]
    study.table("Shear stress on the surface at the inside of the coil, MPa", columns, rows)
