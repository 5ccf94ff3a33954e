"""The look of all figures: the parameters of matplotlib in coilset.mplstyle."""

from pathlib import Path

import matplotlib as mpl

FILE = Path(__file__).parent / "coilset.mplstyle"
STYLE = mpl.rc_params_from_file(str(FILE), use_default_template=False)
DIVERGING = "RdBu_r"
"""Map of values with a sign, red where positive."""
