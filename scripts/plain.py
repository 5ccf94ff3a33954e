"""Typer without rich, which takes longer to load than everything else that `--help` needs."""

import os
import sys

from coilset.model.runtime.switches import enabled

if enabled("rich"):
    os.environ.setdefault("TYPER_USE_RICH", "0")  # for typer >= 0.17
_LOADED = "rich" in sys.modules or not enabled("rich")
if not _LOADED:
    sys.modules["rich"] = None  # type: ignore[assignment]  # to older ones: rich is not installed

import typer  # noqa: E402

if not _LOADED:
    del sys.modules["rich"]

__all__ = ["typer"]
