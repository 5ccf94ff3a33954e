"""The cases of the study, the numbers drawn from them, and their comparison records."""

from functools import partial
from typing import Any, TypedDict

import numpy as np

from coilset.verification.solid_study import elastic, pressing
from coilset.verification.solid_study.elastic import ElasticCase
from coilset.verification.solid_study.pressing import PressedSection
from coilset.verification.solid_study.store import Store

INDICES = (4.0, 6.0, 8.0, 12.0)
# elements along the core's side and of rings, and along the wire
MESHES = ((1, 12), (2, 16), (3, 24), (4, 32))

Numbers = dict[str, Any]  # what a solid or rod has found: plain data, see `elastic.run`, `pressing.run_solid`
Pressed = tuple[PressedSection, Numbers, Numbers]  # solid's result, rod's result
TableRow = tuple[str, int, str, float, float, float | None]


class Cases(TypedDict):
    """What is to be run."""

    elastic: list[ElasticCase]
    pressed: list[PressedSection]


class Found(TypedDict):
    """What has been found."""

    elastic: list[Numbers]
    pressed: list[Pressed]


STANDARD: Cases = {
    "elastic": [ElasticCase(C, *mesh) for C in (4.0, 12.0) for mesh in MESHES[1:3]],
    "pressed": [PressedSection(8.0, 2, 16)],
}
WHOLE: Cases = {
    "elastic": [ElasticCase(C, *mesh) for C in INDICES for mesh in MESHES],
    "pressed": [PressedSection(8.0, *mesh) for mesh in MESHES]
    + [PressedSection(C, *MESHES[2]) for C in INDICES if C != 8.0]
    + [PressedSection(8.0, *MESHES[1], steps) for steps in (6, 24, 48)],
}


def run(store: Store, cases: Cases = STANDARD, solver: str = "auto") -> Found:
    """Run what is missing.

    Args:
        store: Store.
        cases: STANDARD, or WHOLE.
        solver: see `coilset.model.core.equilibrium.newton.methods`.

    Returns:
        Found.
    """
    results = [store.get(case.name, partial(elastic.run, case, store.comm)) for case in cases["elastic"]]
    found: Found = {"elastic": results, "pressed": []}
    for case in cases["pressed"]:
        solid = store.get(case.name, partial(pressing.run_solid, case, store.comm, solver, store.report))
        rod = store.get(f"rod-{case.name}", partial(pressing.run_rod, case))
        found["pressed"].append((case, solid, rod))
    return found


def diameter(result: Numbers, moment: str) -> tuple[np.ndarray, np.ndarray]:
    """Shear stress τ13 along the diameter that points to the coil's axis.

    Args:
        result: of `run_solid` or `run_rod`.
        moment: ``full`` or ``end``.

    Returns:
        Places y, ascending, negative towards the inside of the coil, mm; τ13 there, MPa. A ring without a point on the
        diameter gives the mean of the two points beside it.
    """
    places = np.array([result[moment]["y"], result[moment]["z"]])
    radius, angle = np.round(np.hypot(*places), 9), np.arctan2(places[1], places[0])
    shear = np.array(result[moment]["stress"])[:, 2]
    shears: dict[float, float] = {}
    for ring in np.unique(radius):
        for side, wanted in ((1.0, 0.0), (-1.0, np.pi)):
            off = np.abs(np.angle(np.exp(1j * (angle - wanted))))
            nearest = radius == ring
            nearest &= off < off[nearest].min() + 1e-6
            shears[side * ring] = float(shear[nearest].mean())
    y = np.array(sorted(shears))
    return y, np.array([shears[place] for place in y])


def numbers(case: PressedSection, solid: Numbers, rod: Numbers) -> dict[str, tuple[float, float]]:
    """What is compared for one pressed section: name → (solid, rod); N, N mm, mm, MPa."""
    i = case.steps
    at = 0.45 * pressing.WIRE  # 0.9 of the radius; the rod's outermost ring of points lies at 0.99
    out = {
        "force at full travel": (solid["force"][i], rod["force"][i]),
        "torque at full travel": (solid["torque"][i], rod["torque"][i]),
        "set": (solid["set"], rod["set"]),
    }
    for moment, when in (("full", "at full travel"), ("end", "after release")):
        lines = [diameter(result, moment) for result in (solid, rod)]
        for place, y in (("inside", -at), ("outside", at)):
            of_solid, of_rod = (float(np.interp(y, *line)) for line in lines)
            out[f"shear {place} {when}"] = of_solid, of_rod
    return out


def finest(found: Found) -> list[Pressed]:
    """(PressedSection, solid, rod) of each index's finest mesh, by index; of equal meshes the one with 12 steps."""
    best: dict[float, Pressed] = {}
    for result in sorted(found["pressed"], key=lambda r: (r[1]["unknowns"], -abs(r[0].steps - PressedSection.steps))):
        best[result[0].index] = result
    return [best[index] for index in sorted(best)]


def records(found: Found) -> list[dict[str, Any]]:
    """Comparison records of each index's finest mesh: quantity, ours, reference, source, tolerance (relative)."""
    out = elastic.records(found["elastic"])
    for case, solid, rod in finest(found):
        label = f"D/d = {case.index:g}, {{}} (rod; solid of {solid['unknowns']} unknowns)"
        compared = numbers(case, solid, rod)
        for name, tolerance in (("force at full travel", 0.02), ("set", 0.03)):
            reference, ours = compared[name]
            out.append(
                {
                    "quantity": label.format(name),
                    "ours": ours,
                    "reference": reference,
                    "source": "solid",
                    "tolerance": tolerance,
                }
            )
    return out


def table(found: Found) -> list[TableRow]:
    """Rows for a table: case, unknowns, quantity, solid, rod, rod over solid − 1 (None for stresses near zero)."""
    rows = []
    for case, solid, rod in found["pressed"]:
        for name, (a, b) in numbers(case, solid, rod).items():
            deviation = b / a - 1 if not name.startswith("shear") else None
            rows.append((case.name, solid["unknowns"], name, a, b, deviation))
    return rows
