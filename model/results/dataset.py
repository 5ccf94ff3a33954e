"""Fields of the snapshots: a labelled data set of the section points, and line meshes for ParaView."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import xarray as xr

from coilset.model.results.folder import make, reserve, whole
from coilset.model.results.record import Result, Setup, Snapshot
from coilset.model.results.warnings import run_warnings
from coilset.model.section.rules import SURFACE_POINTS
from coilset.model.section.surface import component, shear

RESULTANTS = ["N", "Q2", "Q3", "Mt", "M2", "M3"]


def point_state(setup: Setup, result: Result) -> xr.Dataset:
    """All section points at all snapshots as an xarray data set with units and coordinates."""
    rule, radius, snapshots = setup.rule, setup.wire_radius, result.snapshots
    names = list(snapshots[0].components)
    names += ["temperature"] * (snapshots[0].point_state.shape[-1] - len(names))
    history = ("snapshot", "element", "gauss", "point", "component")
    data = xr.Dataset(
        {
            "history": (history, np.stack([shot.point_state for shot in snapshots]), {"units": "MPa"}),
            "surface": (
                ("snapshot", "element", "gauss", "angle", "component"),
                np.stack([shot.surface_state for shot in snapshots]),
                {"units": "MPa", "about": "points on the wire's surface; the angle is counted from y to z"},
            ),
            "resultants": (
                ("snapshot", "element", "gauss", "resultant"),
                np.stack([shot.resultants for shot in snapshots]),
                {"units": "N, N mm", "about": "chord axis and triad of each element"},
            ),
            "position": (
                ("snapshot", "station", "axis"), np.stack([shot.x for shot in snapshots]), {"units": "mm"},
            ),
            "height": ("snapshot", [shot.height for shot in snapshots], {"units": "mm"}),
            "force": ("snapshot", [shot.force for shot in snapshots], {"units": "N"}),
            "y": (("element", "point"), np.outer(radius, rule.points[:, 0]), {"units": "mm"}),
            "z": (("element", "point"), np.outer(radius, rule.points[:, 1]), {"units": "mm"}),
            "weight": ("point", rule.weights),
            "curvature": (("element", "gauss"), setup.placement.curvature, {"units": "1/mm", "about": "towards y"}),
            "torsion": (("element", "gauss"), setup.placement.torsion, {"units": "1/mm"}),
        },
        coords={
            "snapshot": [shot.name for shot in snapshots],
            "turn": ("station", setup.turns, {"units": "1"}),
            "component": names,
            "angle": ("angle", np.arange(SURFACE_POINTS) * 360.0 / SURFACE_POINTS, {"units": "degree"}),
            "resultant": RESULTANTS,
            "axis": ["x", "y", "z"],
        },
        attrs={"title": "section points of the rod", "material": setup.material, "section_rule": rule.name,
               "section_kind": setup.section_kind},
    )  # fmt: skip
    return data.merge(pressure_along_wire(setup, result))


def pressure_along_wire(setup: Setup, result: Result) -> xr.Dataset:
    """Force per length of wire of each kind of contact in every step, at the points of the wire that ever bear."""
    resultants, kinds = result.seats, setup.contacts
    wire_turns = next((kind.wire_turns for kind in kinds if len(kind.wire_turns)), None)
    if wire_turns is None or not resultants:
        return xr.Dataset()
    rows = np.concatenate([one.pressure for one in resultants])
    bearing, place = np.unique(rows[:, 1].astype(int), return_inverse=True)
    values = np.zeros((len(resultants), len(kinds), len(bearing)))
    step = np.repeat(np.arange(len(resultants)), [len(one.pressure) for one in resultants])
    values[step, rows[:, 0].astype(int), place] = rows[:, 2]
    about = "bedding pressure, force per length of wire"
    return xr.Dataset(
        {"pressure": (("step", "contact", "wire_point"), values, {"units": "N/mm", "about": about})},
        coords={
            "step": [one.step for one in resultants],
            "contact": [kind.name for kind in kinds],
            "wire_turn": ("wire_point", wire_turns[bearing], {"units": "1"}),
        },
    )


def with_origin(data: xr.Dataset, setup: Setup, result: Result, origin: Mapping[str, Any]) -> xr.Dataset:
    """The data set with what it was made with, and the run's warnings, as texts of JSON in its attributes."""
    warnings = [asdict(warning) for warning in run_warnings(setup, result)]
    texts = {name: value if isinstance(value, str) else json.dumps(value) for name, value in origin.items()}
    renamed = {"material_file" if name == "material" else name: text for name, text in texts.items()}
    return data.assign_attrs(**renamed, warnings=json.dumps(warnings), complete=str(result.complete).lower())


def write_points(folder: str | Path, data: xr.Dataset) -> None:
    """points.nc (NetCDF 4)."""
    with whole(Path(folder) / "points.nc") as path:
        reserve(path, data.nbytes)
        data.to_netcdf(path.absolute(), engine="h5netcdf")


def write_fields(folder: str | Path, setup: Setup, snapshots: Sequence[Snapshot]) -> None:
    """fields/NN.vtu: the line mesh at each snapshot with resultants and the greatest stresses, for ParaView."""
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
