"""All files of a run, without pictures."""

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from coilset.model.compose.summary import summarise
from coilset.model.core.base.errors import how_to_install
from coilset.model.core.results.files.folder import (
    DERIVED,
    clear,
    subfolder,
    whole,
    write_history,
    write_seats,
    write_summary,
)
from coilset.model.core.results.records.record import Result, Setup, Snapshot
from coilset.model.core.results.surface import component, shear

if TYPE_CHECKING:  # loading what reads takes longer than a short run
    from coilset.model.core.results.files.opened import Run


def write_run(out: Path, setup: Setup, result: Result, summary: dict[str, Any], made_with: dict[str, Any]) -> list[str]:
    """Write the results of a run, without pictures, into its folder; returns what could not be written, in words."""
    from coilset.model.compose import dataset

    clear(out, DERIVED)  # a continued run still has the pictures and the page of before
    write_history(out, result.steps)
    write_seats(out, result.seats)
    dataset.write_points(out, setup, result, made_with)
    lacking = write_fields(out, setup, result.snapshots)
    write_summary(out, {**summary, "origin": made_with})
    return lacking


def run_of(setup: Setup, result: Result, made_with: dict[str, Any]) -> "Run":
    """Records as the Run that figures take, by way of a temporary folder."""
    from coilset.model.core.results.files.opened import open_run

    with TemporaryDirectory() as folder:
        write_run(Path(folder), setup, result, summarise(setup, result), made_with)
        return open_run(folder)


def write_fields(folder: str | Path, setup: Setup, snapshots: Sequence[Snapshot]) -> list[str]:
    """fields/NN.vtu: the line mesh at each snapshot with resultants and the maximum stresses, for ParaView.

    Returns:
        What is not written, in words: without meshio there are none.
    """
    try:
        import meshio
    except ModuleNotFoundError as error:
        return [f"fields for ParaView are not written: {how_to_install(error)}"]

    from coilset.model.compose.dataset import RESULTANTS

    folder = subfolder(folder, "fields")
    n = len(setup.turns) - 1
    cells = [("line", np.stack([np.arange(n), np.arange(1, n + 1)], axis=1))]
    for number, shot in enumerate(snapshots):
        mean = shot.resultants.mean(axis=1)
        data = {name: [mean[:, k]] for k, name in enumerate(RESULTANTS)}
        data["shear_max_MPa"] = [shot.shear.max(axis=(1, 2))]
        data["normal_max_MPa"] = [np.abs(shot.point_state[..., 0]).max(axis=(1, 2))]
        data["work_max_MPa"] = [component(shot.point_state, shot.components, "b").max(axis=(1, 2))]
        data["surface_shear_max_MPa"] = [shear(shot.surface_state, shot.components).max(axis=(1, 2))]
        data["surface_shear_inside_MPa"] = [setup.inside.shear(shot.surface_state, shot.components).mean(axis=1)]
        data["wire_radius_mm"] = [setup.wire_radius]
        with whole(folder / f"{number:02d}.vtu") as path:
            meshio.write(path, meshio.Mesh(shot.x, cells, cell_data=data))
    return []
