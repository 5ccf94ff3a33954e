"""Load that springs lose at constant height: slender ones, virgin and preset, like bars, a stout one like a ring

The closed form of a bar in torsion (`relaxation`) has a single stress parameter, that of the surface. The wire of a
spring is curved: the stress at the inside of the coil is higher than the nominal 8 F D/(π d³), it relaxes first, and
the load falls faster. By how much is computed separately: `references/creeping_ring` solves the section of a ring in
which each point follows the rates of time hardening while the displacements stay compatible (scipy's DOP853); it
approaches the closed form as D/d grows. Constants as in `relaxation`, with z of the nominal stress at the start.

- Springs between clamped ends with sections of the default kind: D/d = 50 against the closed form, D/d = 8 against the
  ring. A spring of D/d = 50 that was preset, to three times the travel at which it is held, released and pressed to the
  same force, against the integral over the radius of a bar with that past (`references/relaxing_bar`). Strains are
  small here, a hundredth of those at 700 N/mm² with the constants of creep and yield scaled alike, since z is all that
  counts: a spring of D/d = 50 stretched to 700 N/mm² is no close-coiled one any more.
- One section without pitch, of each kind, D/d = 4 to 50, against the ring.

The table shows what the curvature alone does to the force after 1,000 h: −0.03 % at D/d = 50, −0.17 % at 20, −1.0 % at
8, −4.0 % at 4. At D/d = 8 a fifth of this comes from the redistribution of strain within the section, the rest from the
initial stress.

Tolerance: 0.2 %, as for the bar. The deviations found are 0.06 % for sections that account for the curvature, 0.04 %
for the slender spring, 0.09 % for the preset one and 0.14 % for the stout one, whose clamped ends prevent uniform twist
(with one turn 0.2 %, with four 0.1 %). Plane sections neglect the curvature: they are shown, not judged.
"""

from typing import Any

import matplotlib as mpl
import numpy as np
import yaml
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.case.case import check
from coilset.model.core.section.kinds import KINDS
from coilset.model.core.section.rules import polar
from coilset.model.physics.time.creep.law import CreepLaw
from coilset.verification.cases.time.relaxation import BEYOND, HOURS, JUDGED, RIM, WARM, YIELD, G, N, lapse, law
from coilset.verification.one_section.helix import WIRE, HelixSection
from coilset.verification.references import creeping_ring, relaxing_bar
from coilset.verification.study import Study

FAST = False
INDICES = (4.0, 8.0, 12.0, 20.0, 50.0)
SMALL = 0.01  # of the stress in springs
AT = [int(np.argmin(np.abs(np.log(HOURS / hours)))) for hours in JUDGED]


def section(index: float, kind: str) -> np.ndarray:
    """F/F₀ at JUDGED of one section without pitch, its turns kept where the nominal stress RIM brings them."""
    material = law()
    wire = HelixSection(material, kind, index, 0.0, polar(10, 16))
    scale = np.array([1.0, 1.0, 1.0, WIRE, WIRE, WIRE])
    creep, start = CreepLaw(material.data.creep, material.parts()), wire.start
    start["clock"] = creep.clock(0.0, WARM)
    s, D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))
    first = RIM * np.pi * WIRE**3 / (16.0 * wire.coil_radius)
    e = np.linalg.solve(wire.update(np.zeros(6))[1], first * wire.load)
    travel, force, found = wire.load @ e, first, []
    for hours in (0.0, *HOURS):
        trial = {name: values.copy() for name, values in start.items()}
        trial["clock"] = creep.clock(hours, WARM, start["clock"])
        for _ in range(20):
            trial["strain"][:] = e
            assert wire.sections.update(trial["strain"], start, trial, s, D)
            rest = np.append(force * wire.load - s[0, 0], travel - wire.load @ e)
            if np.abs(rest[:6] / scale).max() < 1e-9 * first:
                break
            K = np.block([[D[0, 0], -wire.load[:, None]], [wire.load[None, :], np.zeros((1, 1))]])
            change = np.linalg.solve(K, rest)
            e, force = e + change[:6], force + change[6]
        else:
            raise SolveError(f"the section finds no equilibrium after {hours:g} h")
        start = trial
        found.append(force / first)
    return np.array(found[1:])[AT]


def spring(index: float, turns: float, file: str, preset: bool = False) -> tuple[np.ndarray, float]:
    """F/F₀ at JUDGED of a spring, and its nominal stress at the start over SMALL, N/mm².

    Args:
        index: D/d.
        turns: number of turns.
        file: of the material.
        preset: is it pressed BEYOND its travel and released before?
    """
    D = index * WIRE
    travel = np.pi * D * D * SMALL * RIM / (WIRE * G)  # per turn
    marks = np.log1p(HOURS / HOURS[-1] * 1e6) / np.log1p(1e6)  # a hold's steps are parts of log(1 + 1e6 t)
    first: list[dict[str, Any]] = [{"to": {"travel": turns * travel}, "steps": 1}]
    if preset:
        force = np.pi * WIRE**3 * SMALL * RIM / (8.0 * D)
        first = [
            {"to": {"travel": BEYOND * turns * travel}, "steps": 24},
            {"to": {"force": 0.0}, "steps": 1},
            {"to": {"force": force}, "steps": 1},
        ]
    case = check(
        {
            "spring": {
                "wire_diameter": WIRE,
                "mean_diameter": D,
                "turns": turns,
                "pitch": 1.01 * WIRE + BEYOND * travel,
            },
            "material": file,
            "temperature": WARM,
            "ends": "clamped",
            "mesh": {"elements_per_turn": 8, "section": {"radial": 10, "angular": 8}},
            "loading": [*first, {"hold": {"hours": float(HOURS[-1])}, "steps": [float(mark) for mark in marks]}],
        }
    )
    forces = np.array([step.force_N for step in Analysis(case, MPI.COMM_SELF).run().steps])[-len(marks) - 1 :]
    return forces[1:][AT] / forces[0], 8.0 * forces[0] * D / (np.pi * WIRE**3) / SMALL


def material_file(study: Study, yielding: bool = False) -> str:
    """`relaxation`'s law, which creeps (and yields) under SMALL stresses as it does under its own."""
    data = law(yielding).data.model_dump(mode="json", exclude_none=True)
    data["creep"]["strain"] *= SMALL
    data["creep"]["stress"] *= SMALL
    if yielding:
        data["temperatures"][0]["isotropic"]["k0_squared"] *= SMALL**2
    path = study.folder / f"{'yielding' if yielding else 'creeping'}.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    return str(path)


def run(study: Study) -> None:
    """Springs, sections, and what D/d does."""
    file, hours = material_file(study), HOURS[AT]
    slender, stress = spring(50.0, 1.0, file)
    stout, its_stress = spring(8.0, 3.0, file)
    preset, nominal = spring(50.0, 1.0, material_file(study, yielding=True), preset=True)
    bar = relaxing_bar.virgin(N, lapse(hours, stress))
    preset_bar = relaxing_bar.preset(N, lapse(hours, nominal), YIELD / nominal, BEYOND * RIM / nominal)
    ring = creeping_ring.relaxation(8.0, N, lapse(hours, its_stress))
    compare(study, "spring of D/d = 50", slender, bar, "closed form of the straight bar")
    compare(study, "preset spring of D/d = 50", preset, preset_bar, "integral over r of a preset bar")
    compare(study, "spring of D/d = 8", stout, ring, "a ring that creeps, integrated")
    straight, rows, lost = relaxing_bar.virgin(N, lapse(hours)), [], {}
    for index in INDICES:
        exact = creeping_ring.relaxation(index, N, lapse(hours))
        alone = creeping_ring.relaxation(index, N, lapse(hours), redistributed=False)
        found = {kind: section(index, kind) for kind in KINDS}
        for kind in ("curved", "warping"):
            compare(study, f"{kind} section, D/d = {index:g}", found[kind], exact, "a ring that creeps, integrated")
        lost[index] = {"ring": exact, "each point by itself": alone, **found}
        rows.append([index, *(100.0 * (values[1] / straight[1] - 1.0) for values in lost[index].values())])
    columns = ["D/d", "ring", "each point by itself", *KINDS]
    study.table("Force after 1,000 h over that of the straight bar, deviation in per cent", columns, rows)
    study.figure("relaxing_springs", figure(np.array(rows, float), columns))


def compare(study: Study, what: str, ours: np.ndarray, exact: np.ndarray, source: str) -> None:
    """F/F₀ at JUDGED."""
    for hours, value, reference in zip(JUDGED, ours, exact, strict=True):
        study.check(f"{what}, F/F0 after {hours:g} h", value, reference, source, 2e-3)


def figure(rows: np.ndarray, columns: list[str]) -> Figure:
    """Deviation from the straight bar over D/d."""
    with mpl.rc_context(STYLE):
        picture = Figure(figsize=(6.4, 4.0), layout="constrained")
        axes = picture.subplots()
        fine = np.geomspace(INDICES[0], INDICES[-1], 25)
        straight = relaxing_bar.virgin(N, lapse(HOURS[AT]))[1]
        for redistributed, line, word in ((True, "-", "ring"), (False, "--", "ring, each point by itself")):
            exact = [creeping_ring.relaxation(index, N, lapse(HOURS[AT]), redistributed)[1] for index in fine]
            axes.semilogx(fine, 100.0 * (np.array(exact) / straight - 1.0), line, color="0.3", label=word)
        for k, marker in ((3, "x"), (4, "o"), (5, "+")):
            axes.semilogx(rows[:, 0], rows[:, k], marker, label=f"{columns[k]} section")
        axes.axhspan(-0.2, 0.2, color="0.9", zorder=0)
        axes.set_xticks(INDICES, [f"{index:g}" for index in INDICES])
        axes.xaxis.set_minor_locator(mpl.ticker.NullLocator())
        axes.set(
            xlabel="D/d",
            ylabel="force after 1,000 h over\nthe straight bar's, deviation in %",
            title="A curved wire loses its load faster",
        )
        axes.legend()
    return picture
