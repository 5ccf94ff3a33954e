"""Checkpoints: the state after each converged step, in an order that no partition changes, written in one move.

The arrays of a checkpoint belong to stations and elements, not to ranks, so that any number of ranks goes on from it.
"""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from coilset.model.errors import InputError
from coilset.model.loading.stepper import Step, Walk
from coilset.model.results.folder import whole
from coilset.model.results.seats import Resultants

NODAL, CELLWISE = ("x", "R"), ("chord", "shear", "strain")  # and the arrays of the sections
# what must be the same to go on
SPRING_ENTRIES = ("spring", "material", "temperature", "ends", "seats", "mesh", "contact")


class Checkpoint:
    """The folder `checkpoint` of a results folder.

    Args:
        folder: the results folder.
        case: Case.
    """

    def __init__(self, folder, case):
        self.folder = Path(folder) / "checkpoint"
        self.case = case.model_dump(mode="json")

    # ---- saving ----------------------------------------------------------------------------------------------------

    def save(self, analysis):
        """Write the state after a converged step; collective."""
        rod, system, stepper = analysis.rod, analysis.system, analysis.stepper
        state = {name: system.gather(rod.equilibrium[name]) for name in NODAL}
        state |= {name: rod.line.in_order(rod.equilibrium[name]) for name in (*CELLWISE, *rod.points)}
        state |= {"guess": system.to_order(stepper.guess), "reactions": system.to_order(system.reaction_start)}
        if analysis.comm.rank:
            return
        state["seats"] = system.seats_start
        for k, memory in enumerate(system.memories):
            state |= {f"contact_{k}_{name}": values for name, values in memory.committed.items()}
        result = analysis.result
        state["pressure"] = np.concatenate([np.empty((0, 3)), *(one.pressure for one in result.seats)])
        state["bearing_points"] = np.array([len(one.pressure) for one in result.seats], dtype=int)
        steps = [asdict(step) for step in result.steps]
        about = {
            "case": self.case,
            "walk": asdict(stepper.walk),
            "height": analysis.drive.height,
            "force": analysis.drive.force,
            "rate": result.rate,
            "steps": steps,
            "seats": [one.row() for one in result.seats],
            "snapshots": len(result.snapshots),
        }
        self.folder.mkdir(exist_ok=True)
        for number, snapshot in enumerate(result.snapshots):
            self._save_snapshot(number, snapshot)
        with whole(self.folder / "state.npz") as path, open(path, "wb") as file:
            np.savez(file, about=np.array(json.dumps(about)), **state)

    def _save_snapshot(self, number, snapshot):
        path = self.folder / f"snapshot-{number:02d}.npz"
        if not path.exists():
            with whole(path) as partial, open(partial, "wb") as file:
                np.savez(file, **asdict(snapshot))

    def clear(self):
        """Forget an earlier run."""
        for path in self.folder.glob("*.npz"):
            path.unlink()

    # ---- resuming --------------------------------------------------------------------------------------------------

    def resume(self, analysis):
        """Bring an analysis to the state of the checkpoint; collective.

        Raises:
            InputError: if there is no checkpoint, it is broken, or it belongs to another spring or load program.
        """
        comm = analysis.comm
        loaded = problem = None
        if comm.rank == 0:
            try:
                loaded = self._load()
                self._compare(loaded["about"])
            except InputError as error:
                problem = error
        problem = comm.bcast(problem and (problem.problem, problem.place, str(problem.file)))
        if problem:
            raise InputError(*problem)
        loaded = comm.bcast(loaded)
        about = loaded.pop("about")
        rod, system, stepper, drive = analysis.rod, analysis.system, analysis.stepper, analysis.drive
        for name in NODAL:
            rod.equilibrium[name] = loaded[name][rod.line.node].copy()
        for name in (*CELLWISE, *rod.points):
            rod.equilibrium[name] = loaded[name][rod.line.element[: rod.line.owned_cells]].copy()
        system.seats_start = loaded["seats"].copy()
        for k, memory in enumerate(system.memories):
            memory.committed = {name: loaded[f"contact_{k}_{name}"].copy() for name in memory.committed}
        system.from_order(loaded["guess"], stepper.guess)
        system.from_order(loaded["reactions"], system.reaction_start)
        system.restore()
        drive.accept(about["height"], about["force"])
        stepper.walk, stepper.number = Walk(**about["walk"]), len(about["steps"])
        analysis.result.steps = [Step(**step) for step in about["steps"]]
        parts = np.split(loaded["pressure"], np.cumsum(loaded["bearing_points"])[:-1])
        analysis.result.seats = [Resultants.from_row(*pair) for pair in zip(about["seats"], parts, strict=True)]
        analysis.result.rate = about["rate"]
        analysis.result.snapshots = [self._snapshot(number, comm.rank) for number in range(about["snapshots"])]

    def _load(self):
        path = self.folder / "state.npz"
        if not path.exists():
            raise InputError("there is no checkpoint to go on from; run it without --resume", "", self.folder)
        try:
            with np.load(path, allow_pickle=False) as file:
                loaded = {name: file[name] for name in file.files}
            return loaded | {"about": json.loads(str(loaded["about"]))}
        except (OSError, ValueError, KeyError) as error:
            raise InputError(f"the checkpoint is not readable: {error}", "", path) from None

    def _snapshot(self, number, rank):
        from coilset.model.analysis import Snapshot

        with np.load(self.folder / f"snapshot-{number:02d}.npz", allow_pickle=False) as file:
            fields = {name: file[name] for name in file.files}
        for name, kind in (("name", str), ("height", float), ("force", float)):
            fields[name] = kind(fields[name])
        fields["components"] = tuple(str(name) for name in fields["components"])
        if rank:
            fields |= {name: np.empty(0) for name in ("triads", "resultants", "history", "surface")}
        return Snapshot(**fields)

    def _compare(self, about):
        """The spring must be the same; the phases that are behind too, and the rest may have changed."""
        old, new = about["case"], self.case
        for entry in SPRING_ENTRIES:
            if old.get(entry) != new[entry]:
                raise InputError("differs from that of the checkpoint; run it without --resume", entry, self.folder)
        walk = about["walk"]
        phase = walk["phase"]
        if old["loading"][:phase] != new["loading"][:phase]:
            raise InputError(f"its first {phase} phases are behind and must stay as they were", "loading", self.folder)
        if old["loading"][phase : phase + 1] != new["loading"][phase : phase + 1]:
            # a changed target: begin its phase where the spring stands now
            about["walk"] = asdict(Walk(phase, height=about["height"], force=about["force"]))
