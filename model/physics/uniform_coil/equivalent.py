"""The cylindrical coil that stands for a spring of another shape."""

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.physics.outlines.outlined_section import Outlined


def coil(spring: Spring) -> np.ndarray:
    """Wire diameter, mean diameter, pitch (mm) and turns of the equivalent cylinder, shape (4,).

    Its turns are the active ones, its compliance ∝ ∫ D³/d⁴ dt that of the spring.
    """
    start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
    t = np.linspace(start, end, 257)
    middle = 0.5 * (t[1:] + t[:-1])
    d = spring.wire_diameter(middle)
    if spring.section is not None:  # round wire of the same torsional stiffness
        d = d * (Outlined(spring.section).warping().torsion / (0.5 * np.pi)) ** 0.25
    mean = float(d.mean())
    D = float(np.mean((2.0 * spring.mean_radius(middle)) ** 3 / d**4) * mean**4) ** (1.0 / 3.0)
    pitch = float(spring.height(end) - spring.height(start)) / (end - start)
    return np.array([mean, D, pitch, end - start])
