"""Steps of a checkpoint, one line of JSON each, so that a step is written without rewriting those before it."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.results.files.folder import not_linked
from coilset.model.core.results.records.frame import Frame
from coilset.model.core.results.records.record import SeatReactions, Step


class StepJournal:
    """Steps with their SeatReactions and Frames, appended one by one; the checkpoint holds how many are valid.

    Args:
        path: the file. Its content is overwritten, unless `read` has read it.
    """

    def __init__(self, path: Path) -> None:
        self.path, self._written, self._length = path, 0, 0

    def append(self, steps: Sequence[Step], seats: Sequence[SeatReactions], frames: Sequence[Frame]) -> None:
        """Write the steps that are not written yet; there may be no reactions at all.

        Raises:
            CoilsetError: if the file cannot be written.
        """
        new = range(self._written, len(steps))
        lines = "".join(_line(steps[k], seats[k] if seats else None, frames[k]) for k in new).encode()
        try:
            with open(self.path, "r+b" if self._length else "wb", opener=not_linked) as file:
                file.truncate(self._length)  # written by a killed run after its last state
                file.seek(self._length)
                file.write(lines)
        except OSError as error:
            raise CoilsetError(f"{self.path}: cannot be written: {error.strerror or error}") from None
        self._written, self._length = len(steps), self._length + len(lines)

    def read(self, count: int) -> tuple[tuple[Step, ...], tuple[SeatReactions, ...], tuple[Frame, ...]]:
        """The first steps of the file; later ones are appended after them.

        Raises:
            ValueError: if there are fewer, or a line is not a step.
        """
        with open(self.path, "rb") as file:
            lines = list(islice(file, count))
        if len(lines) < count:
            raise ValueError(f"{self.path.name} has {len(lines)} steps of {count}")
        rows = [json.loads(line) for line in lines]
        self._written, self._length = count, sum(map(len, lines))
        reactions = [row["seats"] for row in rows if row["seats"] is not None]
        pressures = [np.array(row.pop("pressure")).reshape(-1, 3) for row in reactions]
        seats = map(SeatReactions.from_row, reactions, pressures)
        frames = tuple(Frame.from_row(row["frame"]) for row in rows)
        return tuple(Step(**row["step"]) for row in rows), tuple(seats), frames


def _line(step: Step, seats: SeatReactions | None, frame: Frame) -> str:
    reactions: dict[str, Any] | None = None
    if seats is not None:
        reactions = {**seats.row(), "pressure": seats.pressure.tolist()}
    return json.dumps({"step": asdict(step), "seats": reactions, "frame": frame.row()}) + "\n"
