"""The cases of the study, the numbers drawn from them, and their comparison records."""

import numpy as np

from coilset.verification.solid_vs_rod import elastic, pressing
from coilset.verification.solid_vs_rod.elastic import ElasticCase
from coilset.verification.solid_vs_rod.pressing import PressedSection

INDICES = (4.0, 6.0, 8.0, 12.0)
# elements along the core's side and of rings, and along the wire
MESHES = ((1, 12), (2, 16), (3, 24), (4, 24))

STANDARD = {
    "elastic": [ElasticCase(C, *mesh) for C in (4.0, 12.0) for mesh in MESHES[1:3]],
    "pressed": [PressedSection(8.0, 2, 16)],
}
WHOLE = {
    "elastic": [ElasticCase(C, *mesh) for C in INDICES for mesh in MESHES],
    "pressed": [PressedSection(8.0, *mesh) for mesh in MESHES]
    + [PressedSection(C, *MESHES[2]) for C in INDICES if C != 8.0]
    + [PressedSection(8.0, *MESHES[1], steps) for steps in (6, 24, 48)],
}


def run(store, cases=STANDARD, solver="auto"):
    """Run what is not known yet.

    Args:
        store: Store.
        cases: STANDARD, or WHOLE.
        solver: see `coilset.model.solid.solvers`.

    Returns:
        Dict: `elastic`: list of results; `pressed`: list of (PressedSection, solid's result, rod's result).
    """
    found = {"elastic": [store.get(c.name, lambda c=c: elastic.run(c, store.comm)) for c in cases["elastic"]]}
    found["pressed"] = []
    for case in cases["pressed"]:
        solid = store.get(case.name, lambda c=case: pressing.run_solid(c, store.comm, solver, store.report))
        rod = store.get(f"rod-{case.name}", lambda c=case: pressing.run_rod(c))
        found["pressed"].append((case, solid, rod))
    return found


def shear_at(result, moment, y):
    """Shear stress τ13 on the diameter through the coil's axis at y (outward), MPa.

    Args:
        result: of `run_solid` or `run_rod`.
        moment: ``full`` or ``end``.
        y: place, mm; linear interpolation of the points of the polar grid, at constant distance from the centre.
    """
    places = np.array([result[moment]["y"], result[moment]["z"]])
    radius, angle = np.hypot(*places), np.arctan2(places[1], places[0])
    around = np.array(result[moment]["stress"])[:, 2]
    wanted = 0.0 if y > 0 else np.pi
    rings, values = [], []
    for ring in np.unique(np.round(radius, 9)):
        on = np.abs(radius - ring) < 1e-6
        off = np.abs(np.angle(np.exp(1j * (angle[on] - wanted))))
        nearest = np.argsort(off)[:2]  # on the diameter itself, or the two beside it
        chosen = nearest[:1] if off[nearest[0]] < 1e-9 else nearest
        rings.append(ring)
        values.append(float(np.mean(around[on][chosen])))
    return float(np.interp(abs(y), rings, values))


def numbers(case, solid, rod):
    """What is compared for one pressed section: name → (solid, rod); N, N mm, mm, MPa."""
    i = case.steps
    r = 0.5 * pressing.WIRE
    at = 0.9 * r  # the rod's outermost ring of points lies at 0.99 r
    out = {
        "force at full travel": (solid["force"][i], rod["force"][i]),
        "torque at full travel": (solid["torque"][i], rod["torque"][i]),
        "set": (solid["set"], rod["set"]),
    }
    for moment, when in (("full", "at full travel"), ("end", "after release")):
        out[f"shear inside {when}"] = tuple(shear_at(result, moment, -at) for result in (solid, rod))
        out[f"shear outside {when}"] = tuple(shear_at(result, moment, at) for result in (solid, rod))
    return out


def records(found):
    """Comparison records: quantity, ours, reference, source, tolerance (relative)."""
    out = elastic.records(found["elastic"])
    for case, solid, rod in found["pressed"]:
        label = f"D/d = {case.index:g}, {{}} (rod; solid of {solid['unknowns']} unknowns)"
        compared = numbers(case, solid, rod)
        for name, tolerance in (("force at full travel", 0.02), ("set", 0.03)):
            reference, ours = compared[name]
            out.append({"quantity": label.format(name), "ours": ours, "reference": reference, "source": "solid",
                        "tolerance": tolerance})  # fmt: skip
    return out


def table(found):
    """Rows for a table: case, unknowns, quantity, solid, rod, rod over solid − 1 (None for stresses near zero)."""
    rows = []
    for case, solid, rod in found["pressed"]:
        for name, (a, b) in numbers(case, solid, rod).items():
            deviation = b / a - 1 if not name.startswith("shear") else None
            rows.append((case.name, solid["unknowns"], name, a, b, deviation))
    return rows
