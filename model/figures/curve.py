"""The characteristic between its steps, and the section where a stress is, for pictures and pages alike."""

import numpy as np
import numpy.typing as npt

BETWEEN = 12  # points drawn from a step to the next


def smooth(travel: npt.ArrayLike, force: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """A phase's force over travel, through its steps by monotone cubic Hermite interpolation (Fritsch and Carlson).

    It has no corner at a step and no value beyond its neighbours, so that it neither rounds off nor overshoots a kink
    where coils close. A phase of fewer than three steps, or one whose travel turns back, keeps its straight lines.
    """
    from scipy.interpolate import PchipInterpolator

    x, y = np.asarray(travel, float), np.asarray(force, float)
    way = np.diff(x)
    if len(x) < 4 or not (np.all(way > 0.0) or np.all(way < 0.0)):
        return x, y
    fine = np.interp(np.arange(BETWEEN * (len(x) - 1) + 1) / BETWEEN, np.arange(len(x)), x)
    order = np.argsort(x)
    return fine, PchipInterpolator(x[order], y[order])(fine)


def compressed(force: float) -> str:
    """The word for a load program by its maximum force."""
    return "Pulled" if force < 0.0 else "Compressed"


def element_at(turns: np.ndarray, turn: float | None) -> int:
    """Number of the element at a turn; that in the middle of the wire if there is none.

    Args:
        turns: of the stations, shape (n + 1,).
        turn: such as `residual_shear_inside_turn` of a summary.
    """
    n = len(turns) - 1
    return n // 2 if turn is None else int(np.clip(np.searchsorted(turns, turn, side="right") - 1, 0, n - 1))
