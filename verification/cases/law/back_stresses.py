"""Several back stresses: the uniform rod's three stresses against the slice's six, compressed and released

A turn of the library's `chaboche`, wire 5 mm, is compressed nine tenths of the way to block in 12 steps and released,
for D/d = 4, 6, 8 and 12, as in slice-uniform. The slice uses the law for all six stresses, with back stresses that
rotate with the material; the rod uses the law for three. Both come from one kernel, which
`tests/physics/back_stresses/test_back_stresses.py` compares with the rate equations.

Tolerance: 0.1 %. The deviations found are 0.03 % in force and 0.09 % in set, both at D/d = 6. There, 12 × 32 points
instead of the rod's 48 move its set by 0.05 % towards the slice's, and a slice with three times as many unknowns
changes its own by 0.02 %.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.verification.cases.solid.slice_uniform import INDICES, rod_pressed
from coilset.verification.one_section.slice_runs import pressed
from coilset.verification.solid_study.pressing import PressedSection
from coilset.verification.study import Study

FAST = False
MATERIAL, TOLERANCE = "chaboche", 1e-3


def run(study: Study) -> None:
    """Force and set over the spring index."""
    law = library.load(MATERIAL)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.6), layout="constrained")
        axes = figure.add_subplot()
        for number, index in enumerate(INDICES):
            case = PressedSection(index)
            ours = pressed(index, case.pitch, case.travel, material=MATERIAL)
            force, set_mm = rod_pressed(case, law)
            label = f"D/d = {index:g}, {{}}, rod against slice"
            study.check(label.format("force at full travel, N"), force[-1], ours.force[-1], "slice", TOLERANCE)
            study.check(label.format("set, mm"), set_mm, ours.set_mm, "slice", TOLERANCE)
            slice_way, rod_way = (np.append(ours.travel[1:], last) / case.travel for last in (ours.set_mm, set_mm))
            axes.plot(slice_way, [*ours.force[1:], 0.0], f"C{number}", label=f"D/d = {index:g}")
            axes.plot(rod_way, [*force, 0.0], f"C{number}o", ms=3.5, mfc="none")
        axes.set(xlabel="travel over its maximum", ylabel="force in N", title="slice, and uniform rod (o)")
        axes.legend(fontsize=8)
        axes.grid(lw=0.3)
    study.figure("back_stresses", figure)
