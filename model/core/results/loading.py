"""How a run loads its spring, of summary.json: by compression, by tension, or by a torque about the axis."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Any


class Loading(StrEnum):
    """What a run does to its spring at its greatest load."""

    COMPRESSED = "compressed"
    PULLED = "pulled"
    TURNED = "turned"


def loading_of(summary: Mapping[str, Any]) -> Loading:
    """The Loading of a run; it follows from entries that folders of every version have."""
    if summary.get("turn_max_deg") is not None:
        return Loading.TURNED
    return Loading.PULLED if summary.get("force_max_N", 0.0) < 0.0 else Loading.COMPRESSED
