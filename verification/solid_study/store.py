"""Results of a study's cases on disk, so that an interrupted study resumes where it stopped."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpi4py import MPI

from coilset.model.core.results.files.folder import whole


class Store:
    """A folder with one JSON file per case.

    Args:
        folder: path, created if missing.
        comm: MPI communicator; the first rank reads and writes.
        report: called with a line of progress, on the first rank.
    """

    def __init__(self, folder: str | Path, comm: MPI.Comm, report: Callable[[str], object] = lambda line: None) -> None:
        self.folder, self.comm = Path(folder), comm
        self.report = report if comm.rank == 0 else lambda line: None
        if comm.rank == 0:
            self.folder.mkdir(parents=True, exist_ok=True)

    def get(self, name: str, compute: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """The case's result: read if it exists, otherwise computed and written.

        Args:
            name: of the case; a file name without its ending.
            compute: function without arguments that returns plain data, called on all ranks.
        """
        known = self.read(name)
        if known is not None:
            self.report(f"{name}: known")
            return known
        self.report(f"{name}: begun")
        return self.put(name, compute())

    def read(self, name: str) -> dict[str, Any] | None:
        """The case's result on all ranks, None if it does not exist."""
        path, known = self.folder / f"{name}.json", None
        if self.comm.rank == 0 and path.exists():
            known = json.loads(path.read_text(encoding="utf-8"))
        return self.comm.bcast(known)

    def put(self, name: str, result: dict[str, Any]) -> dict[str, Any]:
        """Write the case's result, plain data, replacing what is there, and return it."""
        if self.comm.rank == 0:
            with whole(self.folder / f"{name}.json") as part:
                part.write_text(json.dumps(result, indent=1), encoding="utf-8")
        return result
