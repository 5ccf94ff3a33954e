"""Where the axis of a spring is: the means of whole turns."""

import numpy as np


def axis_offset(x: np.ndarray, start: np.ndarray, turns: np.ndarray) -> float:
    """Maximum distance by which the mean of a whole turn has moved sideways since the start, mm.

    Args:
        x, start: station positions now and at the start, shape (n, 3), mm.
        turns: of the stations, shape (n,).
    """
    if turns[-1] - turns[0] <= 1.5:
        return 0.0
    return float(np.hypot(*turn_means((x - start)[:, :2], turns).T).max())


def turn_means(values: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """Means of values over the whole turn that begins at each station, as far as there is one, shape (m, columns).

    Args:
        values: at the stations, shape (n, columns).
        turns: of the stations, shape (n,), more than one.
    """
    first, total = turns[turns <= turns[-1] - 1.0], np.zeros(values.shape)
    np.cumsum(0.5 * np.diff(turns)[:, None] * (values[1:] + values[:-1]), axis=0, out=total[1:])
    return np.stack([np.interp(first + 1.0, turns, one) - np.interp(first, turns, one) for one in total.T], axis=1)
