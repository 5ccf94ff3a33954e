"""Cantilever under a transverse force, PL²/EI = 1, 5, 10, against elliptic integrals

A straight cantilever under a dead force across it, ten equal steps. `references/elastica.py` gives the inextensible rod
without shear; the program's rod has both. Against shooting with shear and extension (`references/rod_shooting.py`) the
tolerance is 0.02 (PL²/EI)/n² for n rods: the error of straight rods is proportional to h², and the factor is 1.2 to 2
times the value found at n = 8. At the slenderness r/L = 1e-2 used here, shear and axial strain are noticeable in the
comparison with the elliptic integrals: they reach P/GA = (PL²/EI) (E/G) (r/2L)², 6.5e-4 at the maximum load, which is
added there. Shooting itself agrees with the elliptic integrals to 1e-7 at r/L = 1e-4.

For more slender wires see the case slender-rods.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.errors import SolveError
from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.verification.chain import Y, chain, straight
from coilset.verification.references.elastica import cantilever
from coilset.verification.references.rod_shooting import Stiffness, clamped_rod
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS = 100.0, 1.0  # mm
LOADS = np.arange(1.0, 11.0)  # PL²/EI
JUDGED = (1.0, 5.0, 10.0)
MESHES = (8, 16, 32)
FINE = 32


def bend(elements: int) -> np.ndarray:
    """Shortening u/L and deflection v/L of the tip at LOADS, shape (10, 2)."""
    law = library.load("elastic")
    unit = Stiffness.of_round_wire(RADIUS, law.E, law.G).EI / LENGTH**2
    frame = chain(straight(LENGTH, elements), RADIUS, law)
    rows: list[np.ndarray] = []
    for load in LOADS:
        outcome = frame.step(forces={frame.dof(elements, Y): load * unit}, predictor_scale=1.0 if rows else None)
        if not outcome.converged:
            raise SolveError(f"PL²/EI = {load:g}: {outcome.reason}")
        rows.append(np.array([-1.0, 1.0]) * frame.moved(elements)[:2] / LENGTH)
    return np.array(rows)


def exact(load: float, radius: float = RADIUS) -> np.ndarray:
    """u/L and v/L by shooting."""
    law = library.load("elastic")
    stiffness = Stiffness.of_round_wire(radius, law.E, law.G)
    tip = clamped_rod(stiffness, LENGTH, (0.0, load * stiffness.EI / LENGTH**2, 0.0))
    return np.array([1.0 - tip[0] / LENGTH, tip[1] / LENGTH])


def run(study: Study) -> None:
    """Both references, three meshes."""
    law = library.load("elastic")
    found = {n: bend(n) for n in MESHES}
    thin = exact(10.0, 1e-2 * RADIUS)
    study.check("shooting: v/L at PL²/EI = 10, r/L = 1e-4", thin[1], cantilever(10.0)[1], "elliptic integrals", 1e-7)
    rows = []
    for load in JUDGED:
        place = int(load) - 1
        shear = load * law.E / law.G * (0.5 * RADIUS / LENGTH) ** 2
        mesh = 0.02 * load / FINE**2
        shot, inextensible = exact(load), cantilever(load)
        for k, name in enumerate(("u/L", "v/L")):
            ours, at = found[FINE][place, k], f"{name} at PL²/EI = {load:g}"
            study.check(at, ours, inextensible[k], "elliptic integrals", shear + mesh, "absolute")
            study.check(at, ours, shot[k], "shooting", mesh, "absolute")
        rows.append([load, *(f"{np.abs(found[n][place] - shot).max():.1e}" for n in MESHES)])
    study.table("larger error of u/L and v/L against shooting", ["PL²/EI", *(f"{n} rods" for n in MESHES)], rows)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.8), layout="constrained")
        axes = figure.add_subplot()
        fine = np.linspace(0.02, 10.0, 120)
        curve = np.array([cantilever(load) for load in fine])
        for k, (name, colour) in enumerate((("u/L", "C0"), ("v/L", "C3"))):
            axes.plot(fine, curve[:, k], color=colour, lw=0.9, label=f"{name}, elliptic integrals")
            axes.plot(LOADS, found[FINE][:, k], "o", color=colour, ms=4, mfc="none", label=f"{name}, coilset")
        axes.set(xlabel="PL²/EI", ylabel="displacement of the tip over L", title=f"Elastica, {FINE} rods, r/L = 1e-2")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("elastica", figure)
