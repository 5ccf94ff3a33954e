"""A cycle of stress between two states at points: mean and amplitude, as tensors."""

from dataclasses import dataclass

import numpy as np

PLACES = {"s11": (0, 0), "s22": (1, 1), "s33": (2, 2), "t12": (0, 1), "t13": (0, 2), "t23": (1, 2)}


@dataclass(frozen=True)
class Cycle:
    """Stress that goes to and fro on a straight line, S(λ) = mean + λ amplitude, −1 ≤ λ ≤ 1.

    The finished spring is elastic between its working states, so that its stress does so, but for the change of its
    shape. Both tensors belong to axes that move with the material.

    Attributes:
        mean, amplitude: shape (..., 3, 3), MPa.
    """

    mean: np.ndarray
    amplitude: np.ndarray

    @classmethod
    def between(cls, first: np.ndarray, second: np.ndarray) -> "Cycle":
        """That between two stress tensors, shape (..., 3, 3), MPa."""
        return cls(0.5 * (first + second), 0.5 * (second - first))

    @property
    def shape(self) -> tuple[int, ...]:
        """That of the points."""
        return self.mean.shape[:-2]

    def flat(self) -> "Cycle":
        """With the points in one axis."""
        return Cycle(self.mean.reshape(-1, 3, 3), self.amplitude.reshape(-1, 3, 3))


def tensors(state: np.ndarray, components: tuple[str, ...]) -> np.ndarray:
    """Stress tensors of a state, shape (..., 3, 3), MPa; what a section does not have is 0.

    Args:
        state: shape (..., columns).
        components: names of the columns, of which `s11`, `t12` and so on are stresses.
    """
    found = np.zeros((*state.shape[:-1], 3, 3))
    for name, (i, j) in PLACES.items():
        if name in components:
            found[..., i, j] = found[..., j, i] = state[..., components.index(name)]
    return found
