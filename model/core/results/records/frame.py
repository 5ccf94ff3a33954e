"""The wire after a step: enough to draw the spring at every step, a small part of the data of a snapshot."""

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Frame:
    """The wire after one step, in the order of its stations and elements; complete on rank 0.

    Attributes:
        x: station positions, shape (n + 1, 3), mm.
        shear: shear stress about the wire's axis on its surface, positive as in a compressed spring, the mean of an
            element's two sections, shape (n, surface points), MPa in single precision.
    """

    x: np.ndarray
    shear: np.ndarray

    def row(self) -> dict[str, Any]:
        """As plain data that keeps every bit."""
        return {
            name: [base64.b64encode(values.tobytes()).decode(), values.dtype.str, values.shape]
            for name, values in vars(self).items()
        }

    @classmethod
    def from_row(cls, row: dict[str, Any]) -> "Frame":
        """The reverse of `row`."""
        return cls(
            **{
                name: np.frombuffer(base64.b64decode(bits), kind).reshape(shape)
                for name, (bits, kind, shape) in row.items()
            }
        )
