"""The snapshots on the line mesh, for ParaView."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from coilset.model.results.files.dataset import RESULTANTS
from coilset.model.results.files.folder import make, whole
from coilset.model.results.records.record import Setup, Snapshot
from coilset.model.section.surface import component, shear


def write_fields(folder: str | Path, setup: Setup, snapshots: Sequence[Snapshot]) -> None:
    """fields/NN.vtu: the line mesh at each snapshot with resultants and the maximum stresses, for ParaView."""
    import meshio

    folder = Path(folder) / "fields"
    make(folder)
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
