"""The elastic section of a curved wire against Göhner's equation, and how fast warping, quadrature and slice converge

One section of an endless helix carries an axial force. Its shear stress on the wire's surface, at the inside and at the
outside of the coil, is compared with Göhner's boundary value problem (solved to rounding), its axial stiffness with the
torsion of a ring's sector, solved by displacements. With a pitch of 1° both factors are smaller by 1 − cos 1° = 1.5e-4.
A straight wire must be exact in tension, torsion and bending. The figure shows the error over the degree of the
warping; for a section of Ck 15 that is twisted far beyond yield, over the degree and the number of section points; and
over the slice's mesh, elastic and for a turn of Ck 15 that is compressed nearly to block.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from coilset.meshes.sections.shapes import round_wire
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.surface import nominal_shear
from coilset.model.core.section.rules import polar
from coilset.model.physics.slice.analysis import ACROSS
from coilset.verification.one_section.helix import WIRE, HelixSection
from coilset.verification.one_section.slice_references import ring_sector
from coilset.verification.one_section.slice_runs import elastic, pressed
from coilset.verification.solid_study import references
from coilset.verification.study import Study

FAST = True
INDICES = (3.0, 4.0, 6.0, 8.0, 12.0)
DEGREES = (1, 2, 3, 4, 5, 6, 7)
RULES = ((2, 6), (3, 8), (4, 12), (6, 16), (8, 24))
TOLERANCES = {"warping": 2e-3, "curved": 1e-2}
RATE = 2e-4
MESHES = (3.5, 4.5, ACROSS, 7.5, 10.5)  # triangles across the slice
PRESSED = (8.0, 12.0, 6.3)  # D/d, pitch and travel in mm


def run(study: Study) -> None:
    """Factors, stiffness, straight wire and figure."""
    law = library.load("elastic")
    rows, rates = [], {}
    for index in INDICES:
        exact = references.goehner_exact(index)
        for kind, tolerance in TOLERANCES.items():
            inside, outside = HelixSection(law, kind, index, 1.0).factors()
            for place, ours, reference in (("inside", inside, exact[0]), ("outside", outside, exact[1])):
                name = f"D/d = {index:g}, pitch 1°, {kind}: shear factor {place}"
                study.check(name, ours, reference, "Göhner's equation, solved", tolerance)
        stiffness = ring_sector(index)[0]
        for kind in TOLERANCES:
            rates[kind] = HelixSection(law, kind, index, 0.0).rate()
            study.check(
                f"D/d = {index:g}, {kind}: rate over G d⁴/(8 D³)",
                rates[kind],
                stiffness,
                "torsion of a ring's sector, solved",
                RATE,
            )
        plane = HelixSection(law, "plane", index, 1.0)
        rows.append([index, *exact, *plane.factors(), stiffness, plane.rate(), *rates.values()])
    study.table(
        "Shear factors and rates",
        [
            "D/d",
            "Göhner inside",
            "outside",
            "plane inside",
            "outside",
            "rate",
            "plane",
            *TOLERANCES,
        ],
        rows,
    )
    straight_wire(study, law)
    study.figure("section_convergence", convergence(law, library.load("ck15")))


def straight_wire(study: Study, law: Law) -> None:
    """D/d of a thousand million is straight: EA, G Ip and EI."""
    D = HelixSection(law, "warping", 1e9, 0.0).update(np.zeros(6))[1]
    A, I = np.pi * WIRE**2 / 4, np.pi * WIRE**4 / 64
    for name, ours, reference in (
        ("EA, N", D[0, 0], law.E * A),
        ("G Ip, N mm²", D[3, 3], 2 * law.G * I),
        ("EI, N mm²", D[4, 4], law.E * I),
        ("EI, N mm²", D[5, 5], law.E * I),
    ):
        study.check(f"straight wire, {name}", ours, reference, "Saint-Venant", 1e-8)


def twisted(law: Law, degree: int, rule: tuple[int, int]) -> np.ndarray:
    """Torque and shear at the inside of a section of D/d = 5, strained as under eight times its yield force."""
    wire = HelixSection(law, "warping", 5.0, 5.0, polar(*rule), degree)
    unit = np.linalg.solve(wire.update(np.zeros(6))[1], wire.load)
    yields = law.yield_stress / np.sqrt(3.0) * np.pi * WIRE**3 / (16 * wire.coil_radius)  # N, nominal
    s = wire.update(8.0 * yields * unit)[0]
    return np.array([s[3], wire.inside_shear()])


def convergence(linear_law: Law, law: Law) -> Figure:
    """Error over degree, number of points and slice mesh."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 6.8), layout="constrained")
        (left, middle), (right, mesh) = figure.subplots(2, 2)
        for index in (3.0, 5.0, 8.0):
            exact = references.goehner_exact(index)[0]
            found = [HelixSection(linear_law, "warping", index, 0.0, polar(8, 24), d).factors()[0] for d in DEGREES]
            left.semilogy(DEGREES, np.abs(np.array(found) / exact - 1), "o-", ms=4, lw=1, label=f"D/d = {index:g}")
        left.set(
            xlabel="degree of the warping",
            ylabel="error of the shear factor inside",
            title="elastic: each degree of the warping\nbrings a digit (Göhner's equation, solved)",
        )
        reference = twisted(law, 9, (16, 48))
        by_degree = np.array([twisted(law, d, (16, 48)) for d in DEGREES])
        by_points = np.array([twisted(law, 3, rule) for rule in RULES])
        fine = twisted(law, 3, (16, 48))
        for k, name in enumerate(("torque", "shear stress inside")):
            middle.semilogy(DEGREES, np.abs(by_degree[:, k] / reference[k] - 1), "o-", ms=4, lw=1, label=name)
            right.loglog([a * b for a, b in RULES], np.abs(by_points[:, k] / fine[k] - 1), "o-", ms=4, lw=1, label=name)
        middle.set(
            xlabel="degree of the warping",
            ylabel="change to degree 9",
            title="plastic: Ck 15 at 8 times the twist\nof first yield, D/d = 5",
        )
        right.set(
            xlabel="section points", ylabel="change to 16 × 48 points", title="the same at degree 3, over the points"
        )
        slice_meshes(mesh, linear_law)
        for axes in (left, middle, right, mesh):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
    return figure


def slice_meshes(axes: Axes, law: Law) -> None:
    """Error of the slice over its unknowns: elastic, D/d = 4, against closed solutions; pressed, against the finest."""
    D, ends = 4.0 * WIRE, np.array([[-0.5 * WIRE, 0.0]])
    linear = [elastic(round_wire(WIRE), D, law, across, 2, ends) for across in MESHES]
    unknowns = [one.unknowns for one in linear]
    rate, factor = ring_sector(4.0)[0], references.goehner_exact(4.0)[0]
    rates = np.array([one.rate / (law.G * WIRE**4 / (8 * D**3)) for one in linear])
    factors = np.array([one.shear[0] / nominal_shear(1.0, D, WIRE) for one in linear])
    flowing = [pressed(*PRESSED, across) for across in (*MESHES, 16.0)]
    force, back = np.array([one.force[-1] for one in flowing]), np.array([one.set_mm for one in flowing])
    for values, style, name in (
        (rates / rate - 1, "C0o-", "elastic rate, D/d = 4"),
        (factors / factor - 1, "C1o-", "elastic factor inside"),
        (force[:-1] / force[-1] - 1, "C0s--", "force, Ck 15 pressed, D/d = 8"),
        (back[:-1] / back[-1] - 1, "C1s--", "set"),
    ):
        axes.loglog(unknowns, np.abs(values), style, ms=4, lw=1, label=name)
    axes.set(xlabel="unknowns of the slice", ylabel="error", title="the slice, over its mesh")
    axes.set_xticks([200, 500, 1000, 2000], ["200", "500", "1000", "2000"])
    axes.minorticks_off()
