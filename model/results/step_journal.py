"""Steps of a checkpoint, a line of JSON each, so that a step writes itself and none of those before it."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from coilset.meshes.errors import CoilsetError
from coilset.model.results.record import SeatReactions, Step


class StepJournal:
    """Steps with their SeatReactions, appended as they come; the checkpoint's state says how many of them count.

    Args:
        path: the file. What it holds is written over, unless `read` has taken it.
    """

    def __init__(self, path: Path) -> None:
        self.path, self._written, self._length = path, 0, 0

    def append(self, steps: Sequence[Step], seats: Sequence[SeatReactions]) -> None:
        """Write those of all steps up to now that are not written yet.

        Raises:
            CoilsetError: if the file cannot be written.
        """
        new = zip(steps[self._written :], seats[self._written :], strict=True)
        lines = "".join(json.dumps({"step": asdict(step), "seats": _row(one)}) + "\n" for step, one in new).encode()
        try:
            with open(self.path, "r+b" if self._length else "wb") as file:
                file.truncate(self._length)  # what a killed run has written behind its last state
                file.seek(self._length)
                file.write(lines)
        except OSError as error:
            raise CoilsetError(f"{self.path}: cannot be written: {error.strerror or error}") from None
        self._written, self._length = len(steps), self._length + len(lines)

    def read(self, count: int) -> tuple[tuple[Step, ...], tuple[SeatReactions, ...]]:
        """The first steps of the file; it goes on behind them.

        Raises:
            ValueError: if there are fewer, or a line is none.
        """
        with open(self.path, "rb") as file:
            lines = list(islice(file, count))
        if len(lines) < count:
            raise ValueError(f"{self.path.name} has {len(lines)} steps of {count}")
        rows = [json.loads(line) for line in lines]
        self._written, self._length = count, sum(map(len, lines))
        pressures = (np.array(row["seats"].pop("pressure")).reshape(-1, 3) for row in rows)
        seats = (SeatReactions.from_row(row["seats"], part) for row, part in zip(rows, pressures, strict=True))
        return tuple(Step(**row["step"]) for row in rows), tuple(seats)


def _row(seats: SeatReactions) -> dict[str, Any]:
    return {**seats.row(), "pressure": seats.pressure.tolist()}
