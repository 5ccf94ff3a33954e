"""Results with labels and units.

import coilset.open

run = coilset.open("results/ck15_presetting")
run["force_N"]                                        # a column of history.csv, over the steps
run["surface"].sel(component="t13", snapshot="block")
run.force_at(5.0), run.rate_at(5.0), run.force_error_at(5.0)
run.xray(turn=3.5, angle=0, spot=1.0, depth=0)        # residual stress as a diffractometer sees it
"""

import sys
from pathlib import Path
from types import ModuleType

import xarray as xr

from coilset.model.core.results.characteristic import Run
from coilset.model.core.results.files.labelled import labelled
from coilset.model.tools.design.opened import FILE, open_design
from coilset.model.tools.diffraction.diffraction import register

register()


class _Open(ModuleType):
    """This module, which can be called."""

    def __call__(self, folder: str | Path) -> xr.Dataset:
        """Results of a run, a slice, a sweep or a design, as labelled data; of a run with `force_at` and `rate_at`."""
        if Path(folder, FILE).is_file():
            return open_design(folder)
        data = labelled(folder)
        return Run(data.data_vars, data.coords, data.attrs) if "travel_mm" in data and "phase" in data else data


sys.modules[__name__].__class__ = _Open
