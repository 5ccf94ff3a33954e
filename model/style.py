"""The look of all figures: the parameters of matplotlib in coilset.mplstyle."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.ticker import MaxNLocator

FILE = Path(__file__).parent / "coilset.mplstyle"
STYLE = mpl.rc_params_from_file(str(FILE), use_default_template=False)
DIVERGING = "RdBu_r"
"""Map of values with a sign, red where positive."""


def levels(low: float, high: float) -> np.ndarray:
    """Round numbers for the contours of values; about zero, as `-high` to `high`, symmetric."""
    steps = [1, 2, 2.5, 5, 10]
    return MaxNLocator(20, steps=steps, symmetric=low == -high).tick_values(low, max(high, low + 1e-9))
