"""A turn of tube far beyond yield and released: sections that warp, and those that do not, against the solid

The wall of a tube in a coil must carry the same ∫ τ (R − y)² all around, so that its inside, nearer to the coil's axis,
yields first, and it warps (`yielding-ring`). The solid assumes nothing of this: one turn of tube 4 × 2.4 mm, D = 40 mm,
pitch 10 mm, whose yield stress rises by 300 from 400 MPa (Voce), pressed by 4.834 mm between clamped heads and let go,
in the same steps as the rod.

The mesh has twelve quadratic hexahedra around, two through the wall, 24 along the turn; three through the wall change
the force by 0.02 %, the set by 0.13 % and the residual stress by less than 0.1 MPa. Limits are three times what was
found or more, and far below what sections that keep the elastic warping are off, which are shown: 1.6 % of the force,
7 % of the set and a fifth of the residual stress.
"""

import tempfile
from pathlib import Path
from typing import Any

import yaml
from mpi4py import MPI

from coilset.meshes.solids.grid import SectionGrid
from coilset.meshes.solids.solid import coil_section
from coilset.model.compose.analysis import Analysis
from coilset.model.compose.summary import summarise
from coilset.model.core.case import check
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.program import AxialProgram
from coilset.model.physics.solid.sampling import SectionSample
from coilset.verification.study import Study

FAST = False
OUTER, INNER, DIAMETER, PITCH, TRAVEL = 4.0, 2.4, 40.0, 10.0, 4.834  # mm
AROUND, THROUGH, LAYERS = 12, 2, 24
DOWN, BACK = 12, 4
QUANTITIES = ("force at full travel, N", "set, mm", "residual shear inside, MPa")
LIMITS = (2e-3, 2e-2, 2e-2)
STEEL: dict[str, Any] = {
    "name": "saturating",
    "description": "Voce's law",
    "source": "assumed",
    "units": "N, mm, K",
    "validity": {"plastic_work": 100.0, "remark": "assumed"},
    "temperatures": [
        {
            "temperature": 293.15,
            "elasticity": {"G": 80000.0, "nu": 0.3},
            "isotropic": {"law": "voce", "yield_stress": 400.0, "rise": 300.0, "rate": 40.0},
            "kinematic": "none",
            "non_normality": "none",
        }
    ],
}


def solid() -> tuple[float, float, float]:
    """QUANTITIES by the solid."""
    grid = SectionGrid(AROUND // 4, THROUGH, INNER / OUTER)
    wire = coil_section(OUTER, DIAMETER, PITCH, 360.0, LAYERS, MPI.COMM_SELF, grid)
    problem = SolidProblem(wire, MaterialPoints(Law(MaterialFile.model_validate(STEEL))))
    inside = SectionSample(problem.solid, 0.5 * wire.length, [-0.5 * OUTER], [0.0])
    program = AxialProgram(problem)
    program.press(TRAVEL, DOWN)
    full = program.stations[-1].force
    program.release(BACK)
    return float(full), float(program.stations[-1].travel), float(inside.stress()[0, 2])


def rod(kind: str) -> tuple[float, float, float]:
    """QUANTITIES by the rod with sections of a kind, between heads that hold it after its release, too."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "steel.yaml"
        file.write_text(yaml.safe_dump(STEEL), encoding="utf-8")
        case = check(
            {
                "spring": {
                    "wire": {"tube": {"outer": OUTER, "inner": INNER}},
                    "mean_diameter": DIAMETER,
                    "turns": 1.0,
                    "pitch": PITCH,
                },
                "material": str(file),
                "ends": "clamped",
                "release": "held",
                "accuracy": "none",
                "mesh": {"elements_per_turn": 33, "section": {"kind": kind}},  # odd: one lies in the middle
                "loading": [{"to": {"travel": TRAVEL}, "steps": DOWN}, {"to": {"force": 0}, "steps": BACK}],
            }
        )
        analysis = Analysis(case, MPI.COMM_SELF)
        summary = summarise(analysis.setup, analysis.run())
    return summary["force_max_N"], summary["set_mm"], summary["residual_shear_inside_MPa"]


def run(study: Study) -> None:
    """Both kinds of sections against the solid."""
    reference = solid()
    rows = [["solid", *reference]]
    for kind in ("warping", "curved"):
        found = rod(kind)
        rows.append([f"rod, {kind}", *found])
        for name, ours, theirs, limit in zip(QUANTITIES, found, reference, LIMITS, strict=True):
            if kind == "warping":
                study.check(f"{kind}: {name}", ours, theirs, "3D solid", limit)
            else:
                study.shown(f"{kind}: {name}", ours, theirs, "3D solid", "it keeps the elastic warping")
    study.table("Tube 4 × 2.4, one turn", ["", *QUANTITIES], rows)
