"""The elastic section of a curved wire against Göhner's equation, and how fast warping and quadrature converge

One section of an endless helix bears an axial force. Its shear stress on the wire's surface, at the inside and at the
outside of the coil, is compared with Göhner's boundary value problem (solved to rounding), its axial stiffness with his
series. A wire with a pitch of 1° has both factors smaller by 1 − cos 1° = 1.5e-4. A straight wire must be exact in
tension, torsion and bending. The figure shows the error over the degree of the warping and, for a section of Ck 15 that
is twisted far beyond yield, over the degree and the number of section points.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.material import library
from coilset.model.material.law import Law
from coilset.model.results.figures import STYLE
from coilset.model.section.rules import polar
from coilset.verification.sections.helix import WIRE, HelixSection
from coilset.verification.solid_vs_rod import references
from coilset.verification.study import Study

FAST = True
INDICES = (3.0, 4.0, 6.0, 8.0, 12.0)
DEGREES = (1, 2, 3, 4, 5, 6, 7)
RULES = ((2, 6), (3, 8), (4, 12), (6, 16), (8, 24))
TOLERANCES = {"warping": 2e-3, "curved": 1.2e-2}


def run(study: Study) -> None:
    """Factors, stiffness, straight wire and figure."""
    law = library.load("elastic")
    rows = []
    for index in INDICES:
        exact = references.goehner_exact(index)
        for kind, tolerance in TOLERANCES.items():
            inside, outside = HelixSection(law, kind, index, 1.0).factors()
            for place, ours, reference in (("inside", inside, exact[0]), ("outside", outside, exact[1])):
                name = f"D/d = {index:g}, pitch 1°, {kind}: shear factor {place}"
                study.check(name, ours, reference, "Göhner's equation, solved", tolerance)
        rate = HelixSection(law, "warping", index, 0.0).rate()
        study.check(f"D/d = {index:g}, warping: rate over G d⁴/(8 D³)", rate, 1 + 3 / (16 * index**2),
                    "Göhner 1930, 1 + 3/16 (d/D)²", 0.25 / index**4)  # fmt: skip
        plane = HelixSection(law, "plane", index, 1.0)
        rows.append([index, *exact, *plane.factors(), plane.rate(), rate])
    study.table("Shear factors and rates", ["D/d", "Göhner inside", "outside", "plane inside", "outside",
                                            "plane rate", "warping rate"], rows)  # fmt: skip
    straight_wire(study, law)
    study.figure("section_convergence", convergence(law, library.load("ck15")))


def straight_wire(study: Study, law: Law) -> None:
    """D/d of a thousand million is straight: EA, G Ip and EI."""
    D = HelixSection(law, "warping", 1e9, 0.0).update(np.zeros(6))[1]
    A, I = np.pi * WIRE**2 / 4, np.pi * WIRE**4 / 64
    for name, ours, reference in (("EA, N", D[0, 0], law.E * A), ("G Ip, N mm²", D[3, 3], 2 * law.G * I),
                                  ("EI, N mm²", D[4, 4], law.E * I), ("EI, N mm²", D[5, 5], law.E * I)):  # fmt: skip
        study.check(f"straight wire, {name}", ours, reference, "Saint-Venant", 1e-8)


def twisted(law: Law, degree: int, rule: tuple[int, int]) -> np.ndarray:
    """Torque and shear at the inside of a section of D/d = 5, strained as under eight times its yield force."""
    wire = HelixSection(law, "warping", 5.0, 5.0, polar(*rule), degree)
    unit = np.linalg.solve(wire.update(np.zeros(6))[1], wire.load)
    yields = law.yield_stress / np.sqrt(3.0) * np.pi * WIRE**3 / (16 * wire.coil_radius)  # N, nominal
    s = wire.update(8.0 * yields * unit)[0]
    return np.array([s[3], wire.inside_shear()])


def convergence(elastic: Law, law: Law) -> Figure:
    """Error over degree and number of points."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 3.6), layout="constrained")
        left, middle, right = figure.subplots(1, 3)
        for index in (3.0, 5.0, 8.0):
            exact = references.goehner_exact(index)[0]
            found = [HelixSection(elastic, "warping", index, 0.0, polar(8, 24), d).factors()[0] for d in DEGREES]
            left.semilogy(DEGREES, np.abs(np.array(found) / exact - 1), "o-", ms=4, lw=1, label=f"D/d = {index:g}")
        left.set(xlabel="degree", ylabel="error of the shear factor inside", title="Elastic, against Göhner")
        reference = twisted(law, 9, (16, 48))
        by_degree = np.array([twisted(law, d, (16, 48)) for d in DEGREES])
        by_points = np.array([twisted(law, 3, rule) for rule in RULES])
        fine = twisted(law, 3, (16, 48))
        for k, name in enumerate(("torque", "shear stress inside")):
            middle.semilogy(DEGREES, np.abs(by_degree[:, k] / reference[k] - 1), "o-", ms=4, lw=1, label=name)
            right.loglog([a * b for a, b in RULES], np.abs(by_points[:, k] / fine[k] - 1), "o-", ms=4, lw=1, label=name)
        middle.set(xlabel="degree", ylabel="change to degree 9", title="Ck 15, 8 × yield, D/d = 5")
        right.set(xlabel="section points", ylabel="change to 16 × 48 points", title="Degree 3")
        for axes in (left, middle, right):
            axes.grid(lw=0.3)
            axes.legend(fontsize=8)
    return figure
