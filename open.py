"""Results with labels and units.

import coilset.open

run = coilset.open("results/ck15_presetting")
run["force_N"]                                        # a column of history.csv, over the steps
run["surface"].sel(component="t13", snapshot="block")
run.xray(turn=3.5, angle=0, spot=1.0, depth=0)        # residual stress as a diffractometer sees it
"""

import sys
from pathlib import Path
from types import ModuleType

import xarray as xr

from coilset.model.design.opened import FILE, open_design
from coilset.model.results.diffraction import register
from coilset.model.results.files.labelled import labelled

register()


class _Open(ModuleType):
    """This module, which can be called."""

    def __call__(self, folder: str | Path) -> xr.Dataset:
        """Results of a run, a slice, a sweep or a design, as labelled data."""
        return open_design(folder) if Path(folder, FILE).is_file() else labelled(folder)


sys.modules[__name__].__class__ = _Open
