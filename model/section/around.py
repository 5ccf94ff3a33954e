"""Shear stress about the wire's axis, compiled."""

import numpy as np

from coilset.model.runtime.kernels import njit


@njit(cache=True)
def shear_around(
    rows: np.ndarray, columns: tuple[int, int], cosine: np.ndarray, sine: np.ndarray, sign: float, around: np.ndarray
) -> None:
    """Into `around`, shape (sections, points), from states of the shape (sections, points, components), in MPa.

    Args:
        rows: the states.
        columns: of τ12 and τ13 in them.
        cosine, sine: of the points' angles about the wire's axis.
        sign: of the stress that counts as positive.
        around: τ13 cos − τ12 sin times the sign.
    """
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            around[i, k] = sign * (rows[i, k, columns[1]] * cosine[k] - rows[i, k, columns[0]] * sine[k])
