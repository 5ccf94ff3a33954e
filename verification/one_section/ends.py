"""The effect of clamped ends: a turn of rod between heads against the uniform coil, with the same section."""

import numpy as np

from coilset.model.core.material import library
from coilset.model.core.section.rules import polar
from coilset.model.physics.uniform_coil import rod as uniform
from coilset.verification.solid_study import pressing
from coilset.verification.solid_study.pressing import FINE, WIRE, PressedSection
from coilset.verification.solid_study.study import diameter

INSIDE = -0.45 * WIRE  # 0.9 of the radius, where the solid is sampled
CURVED = {"kind": "curved", **FINE}


def of_turn(result: dict, steps: int) -> np.ndarray:
    """Force at full travel, N, set, mm, and residual shear at the inside, MPa, of `run_rod` or `run_solid`."""
    return np.array([result["force"][steps], result["set"], np.interp(INSIDE, *diameter(result, "end"))])


def of_coil(case: PressedSection) -> np.ndarray:
    """The same of the uniform rod."""
    rule, law = polar(FINE["radial"], FINE["angular"]), library.load(case.material)
    coil = np.array([WIRE, case.mean_diameter, case.pitch, 1.0])
    travels = case.travel * np.arange(1, case.steps + 1) / case.steps
    forces, state = uniform.press(coil, law, travels=travels, rule=rule)
    back, state = uniform.press(state, law, forces=np.zeros(1), rule=rule)
    places = 0.5 * WIRE * rule.points.T
    end = {"y": places[0], "z": places[1], "stress": state.points[0, :, :3]}
    shear = np.interp(INSIDE, *diameter({"end": end}, "end"))
    return np.array([forces[0, -1], back[0, 0], -shear])  # its third axis points up, that of a clamped turn down


def ends(case: PressedSection) -> np.ndarray:
    """A clamped turn's force, set and residual shear over those of a coil without ends."""
    return of_turn(pressing.run_rod(case, CURVED), case.steps) / of_coil(case)
