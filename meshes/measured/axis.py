"""The axis of a measured spring, fitted to the points of its wire, and the points moved onto it.

About any other axis, the radius of a coil varies once per turn. So the axis sought is that about which the radius r(t)
over the turns has the smallest deviation, in least squares over the wire, from a cubic spline with knots one turn
apart. A cone, barrel or hourglass follows such a spline; an oval coil deviates from it twice per turn and noise at
random, neither of which moves the axis.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

CUBIC = 3
LEAST_TURNS, LEAST_POINTS = 2.0, 8.0  # turns, and points a turn, from which the axis is determined by the points


@dataclass(frozen=True)
class Axis:
    """A straight axis in the coordinates of a file.

    Attributes:
        origin: a point of it at half of the spring's height, mm, shape (3,).
        slope: its slopes dx/dz and dy/dz, shape (2,).
    """

    origin: np.ndarray
    slope: np.ndarray

    @property
    def offset(self) -> float:
        """Distance from the file's z axis at half of the spring's height, mm."""
        return float(np.hypot(*self.origin[:2]))

    @property
    def tilt(self) -> float:
        """Angle to the file's z axis, degrees."""
        return float(np.degrees(np.arctan(np.hypot(*self.slope))))

    @classmethod
    def of(cls, points: np.ndarray, turns: float) -> "Axis | None":
        """Fit the axis of a coil wound about the z axis or near to it; None if the points do not determine it.

        Args:
            points: along the wire, less than half a turn apart, shape (n, 3), mm.
            turns: their number about the z axis.
        """
        if turns < LEAST_TURNS or len(points) < LEAST_POINTS * turns:
            return None
        from scipy.interpolate import BSpline  # only for measured springs
        from scipy.optimize import least_squares

        middle = 0.5 * (points[:, 2].min() + points[:, 2].max())

        def axis(unknowns: np.ndarray) -> Axis:
            return cls(np.array([*unknowns[:2], middle]), unknowns[2:] / size)

        def deviation(unknowns: np.ndarray) -> np.ndarray:
            """Of the radius from its spline, shape (n,)."""
            moved = axis(unknowns).moved(points)
            x, y = moved[:, 0], moved[:, 1]
            angle = np.unwrap(np.arctan2(y, x))
            turn = np.abs(angle - angle[0]) / (2.0 * np.pi)
            inner = np.linspace(0.0, turn.max(), max(int(turn.max()), 1) + 1)
            knots = np.concatenate([[0.0] * CUBIC, inner, [turn.max()] * CUBIC])
            # a fit over the wire, however its points are spaced; about a far axis, on trial, they may go back
            weight = np.sqrt(np.maximum(np.gradient(turn), 0.0))
            spline = BSpline.design_matrix(turn, knots, CUBIC).toarray() * weight[:, None]
            radius = np.hypot(x, y) * weight
            coefficients = np.linalg.lstsq(spline, radius, rcond=None)[0]
            rest: np.ndarray = radius - spline @ coefficients
            return rest

        size = float(np.hypot(points[:, 0], points[:, 1]).max())
        found = least_squares(deviation, np.zeros(4), method="lm", xtol=1e-14, ftol=1e-14, gtol=1e-14)
        return axis(found.x)

    @cached_property
    def rotation(self) -> np.ndarray:
        """The shortest rotation that takes the axis to z, shape (3, 3)."""
        x, y, z = np.array([*self.slope, 1.0]) / np.sqrt(1.0 + self.slope @ self.slope)
        return np.array(
            [
                [1.0 - x * x / (1.0 + z), -x * y / (1.0 + z), -x],
                [-x * y / (1.0 + z), 1.0 - y * y / (1.0 + z), -y],
                [x, y, z],
            ]
        )

    def moved(self, points: np.ndarray) -> np.ndarray:
        """The points after the motion that takes the axis to z; the origin keeps its height, shape (n, 3)."""
        moved: np.ndarray = (points - self.origin) @ self.rotation.T
        moved[:, 2] += self.origin[2]
        return moved
