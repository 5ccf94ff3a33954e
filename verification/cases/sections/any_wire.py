"""Wire that is not round: ellipse, rectangle and tube in closed form, and elastic and pressed coils against the slice

Torsion constants: of the ellipse π a³ b³/(a² + b²), of the rectangle Saint-Venant's series, of the tube that of two
disks. The rate of a coil of tube is also computed by two sections of round wire, the outer one less the inner one.

A coil of D/d = 4, 6 and 8, d the greater of width and height, is pressed in 12 steps, far beyond yield, and released.
The reference is one slice of finite elements in three dimensions, in which nothing is assumed of the section: rate,
force at full travel, set, and the residual shear at the inside of the coil at 0.9 of the half width. Sections are oval
4 × 5 mm, rectangle 6 × 3 mm with corners of 0.5 mm, and an egg 5.6 mm wide and 5 mm high. `curved` sections keep the
elastic warping in plastic flow, with 160 points; `warping` ones find theirs, with polynomials of degree 5 and 160
points, of the rectangle 9 and 640.

Wanted are 0.3 % of force and set and 3 % of the residual shear. Oval and egg meet it with `warping`, the rectangle but
for its residual shear, where polynomials do not follow the kinks of its plastic warping. Tolerances of the others are
what is reached: a rectangle's warping changes most as it yields, so that `curved` ones are too stiff then.
"""

import time

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.meshes.boundary import Boundary
from coilset.meshes.section import section_mesh
from coilset.meshes.section_shapes import Egg, Outline, Oval, Tube, rectangle
from coilset.model.base.style import STYLE
from coilset.model.material import library
from coilset.model.section.outline import Outlined, OutlinedRule
from coilset.model.section.rules import polar
from coilset.model.slice.analysis import ACROSS, INSIDE
from coilset.model.slice.slice import Coil
from coilset.verification.one_section.outlined_coil import OutlinedCoil
from coilset.verification.one_section.slice_runs import press
from coilset.verification.study import Study

WIRES: dict[str, Outline] = {
    "oval 4 × 5": Oval(4.0, 5.0),
    "rectangle 6 × 3": rectangle(6.0, 3.0, 0.5),
    "egg 5.6 × 5": Egg(2.5, 1.5, 1.6),
}
WANTED = (3e-3, 3e-3, 3e-3, 3e-2)
TOLERANCES = {  # of rate, force, set, residual shear
    "oval 4 × 5": {"curved": (1e-3, 6e-3, 3e-3, 8e-2), "warping": WANTED},
    "rectangle 6 × 3": {"curved": (5e-3, 3e-2, 3e-3, 3e-1), "warping": (*WANTED[:3], 1e-1)},
    "egg 5.6 × 5": {"curved": (2e-3, 5e-3, 3e-3, 4e-2), "warping": WANTED},
}
QUANTITIES = ("rate of a turn, N/mm", "force at full travel, N", "set of a turn, mm", "residual shear at 0.9, MPa")
PART = 0.9  # of the half width, where the residual stress is compared
PARTS = np.append(1e-4, np.arange(1, 13) / 12)  # of the travel; the first is elastic
SHEAR = 1.5e-2  # τ/G of the travel, far beyond yield


def run(study: Study) -> None:
    """Closed forms, then coils."""
    closed_forms(study)
    tube(study)
    rows, off = [], {}
    for name, outline in WIRES.items():
        for index in (4.0, 6.0, 8.0):
            reference = slice_of(outline, index)
            for kind, limits in TOLERANCES[name].items():
                points, degree = (640, 9) if kind == "warping" and name.startswith("rectangle") else (160, 5)
                began = time.process_time()
                found, seconds = coil(outline, index, points, kind, degree), time.process_time() - began
                for quantity, ours, theirs, tolerance in zip(QUANTITIES, found, reference, limits, strict=True):
                    study.check(f"{name}, {kind}, D/d = {index:g}: {quantity}", ours, theirs, "slice", tolerance)
                off[name, kind, index] = 100.0 * (found / reference - 1.0)
                rows.append([name, kind, index, *off[name, kind, index], seconds])
    columns = ["wire", "section", "D/d", "rate", "force", "set", "residual shear", "s"]
    study.table("Deviation from the slice, %", columns, rows)
    study.figure("any_wire", draw(off))


def rectangle_torsion(width: float, height: float) -> float:
    """J = h³ w/3 (1 − 192 h/(π⁵ w) Σ tanh(n π w/(2 h))/n⁵), odd n, w ≥ h: Saint-Venant."""
    n = np.arange(1, 200, 2)
    series = np.sum(np.tanh(n * np.pi * width / (2.0 * height)) / n**5)
    return height**3 * width / 3.0 * (1.0 - 192.0 * height / (np.pi**5 * width) * series)


def closed_forms(study: Study) -> None:
    """Torsion constants of straight wire, mm⁴."""
    exact: dict[str, tuple[Outline, float]] = {
        "ellipse 4 × 5": (Oval(4.0, 5.0), np.pi * (2.0 * 2.5) ** 3 / (2.0**2 + 2.5**2)),
        "rectangle 6 × 3": (rectangle(6.0, 3.0), rectangle_torsion(6.0, 3.0)),
        "tube 5 × 3": (Tube(5.0, 3.0), np.pi / 32.0 * (5.0**4 - 3.0**4)),
    }
    for name, (outline, J) in exact.items():
        found = Outlined.of(outline, 2.5).warping().torsion * 2.5**4
        study.check(f"{name}: torsion constant, mm⁴", found, J, "closed form", 1e-3)
        mean = 300.0
        R, G = 0.5 * mean, library.load("elastic").G
        rate = elastic_rate(outline, mean, 1e-3)
        study.check(
            f"{name}, D = 300 mm, rate of a turn, N/mm", rate, G * J / (2.0 * np.pi * R**3), "G J/(2π R³)", 1e-3
        )


def unit(outline: Outline) -> tuple[Outlined, float]:
    """The section in half its height, and that height, mm."""
    boundary = Boundary.of(outline)
    height = float(boundary.high[1] - boundary.low[1])
    return Outlined(boundary.scaled(2.0 / height, 2.0 / height)), height


def elastic_rate(outline: Outline, mean: float, pitch: float) -> float:
    """Rate of a turn, elastic, N/mm."""
    section, height = unit(outline)
    one = OutlinedCoil(library.load("elastic"), "curved", section.rule(160), height, mean, pitch)
    one.go_to(1e-4 * pitch)
    return one.force / one.travel


def tube(study: Study) -> None:
    """A tube 5 × 3 against disks of 5 and 3 mm, in a wide coil and in one whose wire is curved and sheared."""
    law = library.load("elastic")
    for mean in (120.0, 30.0):
        rates = []
        for d in (5.0, 3.0):
            one = OutlinedCoil(law, "curved", polar(), d, mean, 1e-3)
            one.go_to(1e-7)
            rates.append(one.force / one.travel)
        found, name = elastic_rate(Tube(5.0, 3.0), mean, 1e-3), f"tube 5 × 3, D = {mean:g} mm, rate of a turn, N/mm"
        source = "disk of 5 mm less disk of 3 mm"
        if mean > 100.0:
            study.check(name, found, rates[0] - rates[1], source, 1e-3)
        else:
            reason = "the disk inside carries shear across the tube's free surface"
            study.shown(name, found, rates[0] - rates[1], source, reason)


def size(outline: Outline, index: float) -> tuple[float, float, float]:
    """Mean diameter, pitch and travel of a turn, mm."""
    _, height = unit(outline)
    boundary = Boundary.of(outline)
    width = float(boundary.high[0] - boundary.low[0])
    mean, thin = index * max(width, height), min(width, height)
    travel = SHEAR * np.pi * mean**2 / thin
    return mean, height + travel / 0.9, travel


def coil(outline: Outline, index: float, points: int = 160, kind: str = "curved", degree: int = 3) -> np.ndarray:
    """`QUANTITIES` by the rod's section."""
    section, height = unit(outline)
    mean, pitch, travel = size(outline, index)
    place = np.array([[PART * section.boundary.high[0], 0.0]])  # one more point, which weighs nothing
    rule = section.rule(points)
    rule = OutlinedRule(np.concatenate([rule.points, place]), np.append(rule.weights, 0.0), rule.name, section)
    one = OutlinedCoil(library.load("ck15"), kind, rule, height, mean, pitch, degree)
    forces = []
    for part in PARTS:
        one.go_to(float(part * travel))
        forces.append(one.force)
    rate, force = forces[0] / (PARTS[0] * travel), forces[-1]
    one.go_to(None)
    shear = one.start["point_state"][0, 0, -1, one.sections.components.index("t13")]
    return np.array([rate, force, one.travel, -shear])


def slice_of(outline: Outline, index: float) -> np.ndarray:
    """`QUANTITIES` by the slice."""
    mean, pitch, travel = size(outline, index)
    half = 0.5 * float(np.ptp(Boundary.of(outline).polygon[:, 0]))
    mesh, places = section_mesh(outline, ACROSS, 2, inside=INSIDE), np.array([[-PART * half, 0.0]])
    found = press(mesh, Coil(0.5 * mean, pitch), travel * PARTS, places)
    return np.array([found.force[1] / found.travel[1], found.force[-1], found.set_mm, -found.released[0]])


def draw(off: dict[tuple[str, str, float], np.ndarray]) -> Figure:
    """Deviation from the slice over D/d."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.8, 4.0), layout="constrained")
        lines = [(name, kind) for name in WIRES for kind in ("curved", "warping")]
        names = ("rate", "force at full travel", "set", "residual shear inside")
        for k, (axes, quantity) in enumerate(zip(figure.subplots(1, 4), names, strict=True)):
            for (name, kind), colour in zip(lines, ("C0", "C0", "C1", "C1", "C2", "C2"), strict=True):
                index = [i for wire, of, i in off if (wire, of) == (name, kind)]
                values = [abs(off[name, kind, i][k]) for i in index]
                style = "o-" if kind == "warping" else "o--"
                axes.semilogy(index, values, style, color=colour, ms=4, lw=1.1, label=f"{name}, {kind}")
            axes.axhspan(1e-4, 100.0 * WANTED[k], color="0.92", lw=0)
            axes.set_ylim(bottom=2e-3)
            axes.set(xlabel="D/d", title=quantity, xticks=index)
            axes.grid(lw=0.3)
            if k == 0:
                axes.set_ylabel("|deviation from the slice| in %")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=6, fontsize=7)
        worst = {
            kind: np.max([np.abs(values) for (_, of, _), values in off.items() if of == kind], axis=0)
            for kind in ("curved", "warping")
        }
        figure.suptitle(
            f"Wire that is not round: sections that warp find the slice's force within {worst['warping'][1]:.2g} % and "
            f"its residual shear within {worst['warping'][3]:.2g} %,\nwith elastic warping within "
            f"{worst['curved'][1]:.2g} and {worst['curved'][3]:.2g} % (Ck 15, pressed far beyond yield and released; "
            "grey: wanted)"
        )
    return figure
