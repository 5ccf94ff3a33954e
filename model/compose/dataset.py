"""The labelled data set of a run: section points at the snapshots, the wire and the pressure on it after each step."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from coilset.model.compose.parts import parts
from coilset.model.compose.run_warnings import run_warnings
from coilset.model.core.results.files.netcdf import Stack, Variable, write_netcdf
from coilset.model.core.results.records.labels import plain
from coilset.model.core.results.records.record import Result, Setup, Snapshot
from coilset.model.core.section.rules import SURFACE_POINTS, spread

Variables = dict[str, Variable]
RESULTANTS = ["N", "Q2", "Q3", "Mt", "M2", "M3"]


def write_points(folder: str | Path, setup: Setup, result: Result, origin: Mapping[str, Any]) -> None:
    """points.nc (NetCDF 4)."""
    write_netcdf(Path(folder) / "points.nc", variables(setup, result), _attributes(setup, result, origin))


def variables(setup: Setup, result: Result) -> Variables:
    """All of points.nc."""
    return {
        **point_state(setup, result),
        **way_of_wire(result),
        **pressure_along_wire(setup, result),
        **_mode(result),
        **working_surface(setup, result),
        **{name: variable for part in parts() for name, variable in part.variables(setup, result).items()},
    }


def point_state(setup: Setup, result: Result) -> Variables:
    """All section points at all snapshots."""
    sections, radius, snapshots = setup.sections, setup.wire_radius, result.snapshots
    places, weights = spread(sections.points, sections.weights, sections.curvature.shape, sections.cut)
    places *= radius[:, None, None, None]
    of_points = ("element", "gauss", "point")
    of_sections = ("snapshot", "element", "gauss")

    def shots(name: str) -> Stack:
        return Stack([getattr(shot, name) for shot in snapshots])

    mm, curvature = {"units": "mm"}, {"units": "1/mm", "about": "towards y"}
    surface = {"units": "MPa", "about": "points on the wire's surface; the angle is counted from y to z"}
    resultants = {"units": "N, N mm", "about": "chord axis and triad of each element"}
    data = {
        "point_state": Variable((*of_sections, "point", "component"), shots("point_state"), {"units": "MPa"}),
        "surface": Variable((*of_sections, "angle", "component"), shots("surface_state"), surface),
        "resultants": Variable((*of_sections, "resultant"), shots("resultants"), resultants),
        "position": Variable(("snapshot", "station", "axis"), shots("x"), mm),
        "height": Variable(("snapshot",), np.array([shot.height for shot in snapshots]), mm),
        "force": Variable(("snapshot",), np.array([shot.force for shot in snapshots]), {"units": "N"}),
        "y": Variable(of_points, places[..., 0], mm),
        "z": Variable(of_points, places[..., 1], mm),
        "wire_radius": Variable(("element",), radius, mm),
        "weight": Variable(of_points, weights),
        "curvature": Variable(("element", "gauss"), setup.sections.curvature, curvature),
        "abscissa": Variable(("gauss",), setup.sections.abscissae, {"about": "of sections, over the element's length"}),
        "torsion": Variable(("element", "gauss"), setup.sections.torsion, {"units": "1/mm"}),
        **_coordinates(setup, snapshots),
    }
    if sections.outline is not None:
        about = {"about": "points of the wire's outline, y and z in wire radii"}
        data["outline"] = Variable(("corner", "direction"), sections.outline, about)
    return data


def working_surface(setup: Setup, result: Result) -> Variables:
    """Stress on the surface at the working states, and the wire there."""
    shots = [one.snapshot for one in result.working.reached if one.snapshot] if result.working else []
    if not shots:
        return {}
    surfaces, places = (Stack([getattr(shot, name) for shot in shots]) for name in ("surface_state", "x"))
    of_surface = ("element", "gauss", "angle")
    return {
        "working_surface": Variable(("working", *of_surface, "component"), surfaces, {"units": "MPa"}),
        "working_position": Variable(("working", "station", "axis"), places, {"units": "mm"}),
        "working": _words("working", [shot.name for shot in shots]),
    }


def _mode(result: Result) -> Variables:
    """The buckling mode, if there is one."""
    mode, dims = result.mode, ("station", "axis")
    if mode is None:
        return {}
    state = {"travel_mm": plain(mode.travel_mm), "force_N": plain(mode.force_N)}
    about = {"units": "mm", "about": "displacement of the stations in the buckling mode, maximum 1 mm"}
    return {
        "mode_position": Variable(dims, mode.x, {"units": "mm", **state}),
        "mode_displacement": Variable(dims, mode.displacement, about),
    }


def _coordinates(setup: Setup, snapshots: Sequence[Snapshot]) -> Variables:
    names = list(snapshots[0].components)
    names += ["temperature"] * (snapshots[0].point_state.shape[-1] - len(names))
    degrees = np.arange(SURFACE_POINTS) * 360.0 / SURFACE_POINTS
    return {
        "snapshot": _words("snapshot", [shot.name for shot in snapshots]),
        "turn": Variable(("station",), setup.turns, {"units": "1"}, is_beside=True),
        "component": _words("component", names),
        "angle": Variable(("angle",), degrees, {"units": "degree"}),
        "resultant": _words("resultant", RESULTANTS),
        "axis": _words("axis", ["x", "y", "z"]),
    }


def _words(dimension: str, words: Sequence[str]) -> Variable:
    return Variable((dimension,), np.array(words))


def way_of_wire(result: Result) -> Variables:
    """Where the wire is after every step, and the stress on it."""
    if not result.frames:
        return {}
    places, shear = (Stack([getattr(frame, name) for frame in result.frames]) for name in ("x", "shear"))
    about = "about the wire's axis, positive as in a compressed spring; mean of an element's sections"
    return {
        "step_position": Variable(("step", "station", "axis"), places, {"units": "mm"}),
        "step_shear": Variable(("step", "element", "angle"), shear, {"units": "MPa", "about": about}),
        "step": Variable(("step",), np.array([step.number for step in result.steps])),
    }


def pressure_along_wire(setup: Setup, result: Result) -> Variables:
    """Force per length of wire for each kind of contact in every step, at the points that are ever in contact."""
    resultants, kinds = result.seats, setup.contacts
    wire_turns = next((kind.wire_turns for kind in kinds if len(kind.wire_turns)), None)
    if wire_turns is None or not resultants:
        return {}
    rows = np.concatenate([one.pressure for one in resultants])
    bearing, place = np.unique(rows[:, 1].astype(int), return_inverse=True)
    values = np.zeros((len(resultants), len(kinds), len(bearing)))
    step = np.repeat(np.arange(len(resultants)), [len(one.pressure) for one in resultants])
    values[step, rows[:, 0].astype(int), place] = rows[:, 2]
    attrs = {"units": "N/mm", "about": "bedding pressure, force per length of wire"}
    return {
        "pressure": Variable(("step", "contact", "wire_point"), values, attrs),
        "step": Variable(("step",), np.array([one.step for one in resultants])),
        "contact": _words("contact", [kind.name for kind in kinds]),
        "wire_turn": Variable(("wire_point",), wire_turns[bearing], {"units": "1"}, is_beside=True),
    }


def _attributes(setup: Setup, result: Result, origin: Mapping[str, Any]) -> dict[str, str]:
    """What the run was, its provenance and its warnings, as texts, of JSON where they are more than words."""
    warnings = [asdict(warning) for warning in run_warnings(setup, result)]
    texts = {name: value if isinstance(value, str) else json.dumps(value) for name, value in origin.items()}
    renamed = {"material_file" if name == "material" else name: text for name, text in texts.items()}
    notes = {"warnings": json.dumps(warnings), "complete": str(result.complete).lower()}
    return {
        "title": "section points of the rod",
        "material": setup.material,
        "section_rule": setup.sections.rule,
        "section_kind": setup.sections.kind,
        "coil_turns": repr(float(setup.spring.turns)),
        **renamed,
        **notes,
    }
