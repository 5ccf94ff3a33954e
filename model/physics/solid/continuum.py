"""What a solid and a slice share as bodies: positions, a law at points, and the time it depends on."""

import numpy as np

from coilset.model.core.body.body import Body, Moment
from coilset.model.core.body.state import State, Where
from coilset.model.physics.solid.points import MaterialPoints


def mises(six: np.ndarray) -> np.ndarray:
    """Von Mises stress of six components, shape (..., 6) → (...), MPa."""
    n, t = six[..., :3], six[..., 3:]
    spread = (n[..., 0] - n[..., 1]) ** 2 + (n[..., 1] - n[..., 2]) ** 2 + (n[..., 2] - n[..., 0]) ** 2
    return np.sqrt(0.5 * spread + 3.0 * np.sum(t * t, axis=-1))


def tensors(six: np.ndarray) -> np.ndarray:
    """Symmetric tensors of six components, shape (n, 6) → (n, 3, 3)."""
    return six[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3)


class Continuum(Body):
    """A body of points in three dimensions, updated Lagrange: increments start at the last equilibrium.

    Args:
        points: the law at the points.
        x: coefficients of the position at the start, shape (blocks with ghosts, 3), mm.
        cells, points_each: number of owned cells, and of the points in each.

    Attributes:
        points: as given.
        state: State with the position coefficients `x`, mm, and the rows `point_state` of the owned cells, shape
            (cells, points, n_state), in the current frame.
    """

    constraint_weight = 1.0  # rows of prescribed increments are those of the identity, N/mm

    def __init__(self, points: MaterialPoints, x: np.ndarray, cells: int, points_each: int) -> None:
        self.points, self.state, self._rounding = points, State(), 0.0
        rows = points.initial_state(cells * points_each)
        self._x = self.state.add("x", x.copy(), Where.STATION)
        rows = rows.reshape(cells, points_each, rows.shape[1])  # a rank may have no cells
        self._rows = self.state.add("point_state", rows, Where.CELL)
        if points.in_time is not None:
            self.state.add("clock", points.in_time.clock(0.0, points.temperature), Where.SHARED)

    @property
    def x(self) -> np.ndarray:
        """Trial coefficients of the position, shape (blocks with ghosts, 3), mm."""
        return self._x.trial

    @property
    def point_state(self) -> np.ndarray:
        """Trial rows of the owned cells' points, shape (cells, points, n_state), MPa."""
        return self._rows.trial

    def _move(self) -> None:
        """Bring the positions, and the law's time, to the increment."""
        np.add(self._x.equilibrium, self.increment.x.array.reshape(-1, 3), out=self._x.trial)
        if "clock" in self.state:
            clock = self.state["clock"]
            self.points.pass_time({"clock": clock.equilibrium}, {"clock": clock.trial})

    @property
    def clock(self) -> np.ndarray:
        """Hours since the start, temperature (K) and warm hours at the last equilibrium; see Body."""
        if "clock" in self.state:
            return self.state["clock"].equilibrium
        return np.array([0.0, self.points.temperature, 0.0])

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Set the clock of the trial state; see Body."""
        if self.points.in_time is None:
            raise ValueError("the material neither creeps nor depends on the rate, so time has no effect on it")
        start = self.state["clock"].equilibrium
        self.state["clock"].trial[:] = self.points.in_time.clock(*end, self.points.in_time.clock(*middle, start))

    def rounding(self, increments: np.ndarray) -> float:
        """Effect of rounding the positions on the forces, from the diagonal of the last tangent; see Body."""
        return self._rounding
