"""Checkpoints: the state after each converged step, in an order independent of the partition, written atomically.

The arrays of a checkpoint belong to stations and elements, not to ranks, so that any number of ranks can resume.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from coilset.model.core.base.agreement import on_first_rank
from coilset.model.core.base.errors import InputError, reason
from coilset.model.core.base.warning import Warning
from coilset.model.core.body.body import Moment
from coilset.model.core.body.state import State
from coilset.model.core.case import Case
from coilset.model.core.equilibrium.path.program import ProgramPosition, Stage
from coilset.model.core.equilibrium.path.step_sizes import Position
from coilset.model.core.equilibrium.settings import Drive
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.results.files import state_file
from coilset.model.core.results.files.folder import subfolder, whole
from coilset.model.core.results.files.step_journal import StepJournal
from coilset.model.core.results.records.provenance import changed, provenance
from coilset.model.core.results.records.record import BucklingMode, Result, Snapshot

# what must be unchanged to resume
SPRING_ENTRIES = ("spring", "material", "temperature", "ends", "seats", "heads", "release", "mesh", "contact", "heat")
ANEW = "use --overwrite instead of --resume to start again"


@dataclass(frozen=True)
class Saved:
    """Content of a checkpoint.

    Attributes:
        arrays: name → array of the state in natural order.
        position: ProgramPosition.
        result: Result so far.
        changed: whether the target of the stage in progress is another one now: the stage begins anew from the state.
    """

    arrays: Mapping[str, np.ndarray]
    position: ProgramPosition
    result: Result
    changed: bool = False


class Checkpoint:
    """The folder `checkpoint` of a results folder, or `checkpoint-N` of its Nth finer run.

    Args:
        folder: the results folder.
        finer: number of the finer run (coilset.model.tools.further_runs.refinement), 0 for the case itself.
    """

    def __init__(self, folder: str | Path, case: Case, finer: int = 0) -> None:
        self.folder = Path(folder) / (f"checkpoint-{finer}" if finer else "checkpoint")
        self.case, self.provenance = case.model_dump(mode="json"), provenance(case)
        self.journal, self.state = StepJournal(self.folder / "steps.jsonl"), self.folder / "state.npz"
        self._snapshots = 0  # that are written, or were read

    # ---- saving ----------------------------------------------------------------------------------------------------

    def save(self, state: State, layout: LineLayout, position: ProgramPosition, result: Result) -> None:
        """Write the state after a converged step; collective."""
        fields = {name: layout.natural(field) for name, field in state.items()}
        if layout.comm.rank:
            return
        about = {
            "case": self.case,
            "provenance": self.provenance,
            "position": asdict(position),
            "rate": result.rate,
            "warnings": [asdict(warning) for warning in result.warnings],
            "steps": len(result.steps),
            "snapshots": len(result.snapshots),
        }
        mode = asdict(result.mode) if result.mode is not None else {}
        subfolder(self.folder.parent, self.folder.name)
        self.journal.append(result.steps, result.seats, result.frames)
        for number, snapshot in enumerate(result.snapshots[self._snapshots :], self._snapshots):
            self._save_snapshot(number, snapshot)
        self._snapshots = len(result.snapshots)
        with whole(self.state) as partial, open(partial, "wb") as file:
            state_file.write(file, about, fields, mode)

    def _save_snapshot(self, number: int, snapshot: Snapshot) -> None:
        with whole(self.folder / f"snapshot-{number:02d}.npz") as partial, open(partial, "wb") as file:
            np.savez(file, **asdict(snapshot))

    def exists(self) -> bool:
        """Whether there is something to resume from."""
        return self.state.exists()

    def require(self) -> None:
        """Raise InputError if there is nothing to resume from."""
        if not self.exists():
            raise InputError("there is no checkpoint to continue from; run it without --resume", "", self.folder)

    # ---- resuming --------------------------------------------------------------------------------------------------

    def load(self, comm: MPI.Comm) -> Saved:
        """The last state saved, the same on every rank except for the cells of snapshots; collective.

        Raises:
            InputError: if there is no checkpoint, it is broken, or it belongs to another spring or load program.
        """
        saved = on_first_rank(comm, self._read)
        shared = comm.bcast(saved and replace(saved, result=_without_cells(saved.result)))
        return saved or shared

    def _read(self) -> Saved:
        """On rank 0; a damaged file can fail in any way: as zip, as array, as JSON, as record."""
        self.require()
        path = self.state
        try:
            about, fields, mode = state_file.read(path)
            self._compare(about)
            result = self._result(about, mode)
            return Saved(fields, _position(about["position"]), result, self._changed(about))
        except InputError:
            raise
        except (KeyError, TypeError):  # an entry that is missing or unknown
            raise InputError(
                f"the checkpoint was written by another version of coilset, or is damaged; {ANEW}", "", path
            ) from None
        except Exception as error:
            raise InputError(f"the checkpoint is not readable: {reason(error)}; {ANEW}", "", path) from None

    def _result(self, about: Mapping[str, Any], of_mode: Mapping[str, np.ndarray]) -> Result:
        kept: dict[str, Any] = {name: values if values.ndim else float(values) for name, values in of_mode.items()}
        mode = BucklingMode(**kept) if kept else None
        snapshots = tuple(self._snapshot(number) for number in range(about["snapshots"]))
        self._snapshots = len(snapshots)
        warnings = tuple(Warning(**warning) for warning in about["warnings"])
        return Result(*self.journal.read(about["steps"]), snapshots, about["rate"], warnings=warnings, mode=mode)

    def _snapshot(self, number: int) -> Snapshot:
        found: dict[str, Any] = state_file.read_arrays(self.folder / f"snapshot-{number:02d}.npz")
        for name, kind in (("name", str), ("height", float), ("force", float), ("turn", float), ("free", bool)):
            found[name] = kind(found[name])
        found["components"] = tuple(str(name) for name in found["components"])
        return Snapshot(**found)

    def _changed(self, about: Mapping[str, Any]) -> bool:
        stage, old, new = about["position"]["stage"], about["case"]["loading"], self.case["loading"]
        return bool(old[stage : stage + 1] != new[stage : stage + 1])

    def _compare(self, about: Mapping[str, Any]) -> None:
        """Spring, files and version must be the same, and so must the finished phases; the rest may have changed."""
        old, new = about["case"], self.case
        for entry in SPRING_ENTRIES:
            if old.get(entry) != new[entry]:
                raise InputError(f"differs from that of the checkpoint; {ANEW}", entry, self.folder)
        if old.get("accuracy") == "none" != new["accuracy"]:
            raise InputError(f"the errors of its steps were not estimated; keep none; {ANEW}", "accuracy", self.folder)
        changed_content = changed(about.get("provenance"), self.provenance)
        if changed_content == "version":
            raise InputError(f"the checkpoint is of another version of coilset; {ANEW}", "", self.folder)
        if changed_content:
            raise InputError(
                f"its content is not what the checkpoint was made with; {ANEW}", changed_content, self.folder
            )
        behind = about["position"]["stage"]
        if old["loading"][:behind] != new["loading"][:behind]:
            raise InputError(f"its first {behind} phases are finished and must not change", "loading", self.folder)


def _position(saved: Mapping[str, Any]) -> ProgramPosition:
    redirected = saved["redirected"] and Stage(**saved["redirected"])
    if redirected and isinstance(redirected.steps, list):  # JSON has no tuples
        redirected = replace(redirected, steps=tuple(redirected.steps))
    if redirected:
        redirected = replace(redirected, drives=tuple(Drive(*drive) for drive in redirected.drives))
    parts = {"on_path": Position(**saved["on_path"]), "redirected": redirected, "begun": Moment(*saved["begun"])}
    return ProgramPosition(**{**saved, **parts})


def _without_cells(result: Result) -> Result:
    """For the other ranks: arrays of elements are gathered on rank 0 only."""
    none = np.empty(0)
    return replace(
        result,
        frames=(),
        snapshots=tuple(
            replace(shot, triads=none, resultants=none, point_state=none, surface_state=none)
            for shot in result.snapshots
        ),
    )
