"""The elastic coil section: shear stress at the inside of the coil against Wahl's and Göhner's factors."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from coilset.meshes.solids.solid import SectionGrid, coil_section
from coilset.model.core.material import library
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.model.physics.solid.sampling import SectionSample
from coilset.verification.solid_study import references

WIRE = 5.0  # mm


@dataclass(frozen=True)
class ElasticCase:
    """One full turn without pitch between rigid heads that are pulled apart along the axis.

    A full turn, because then the force stays on the axis with heads that do not rotate: the moment that could hold
    them, M₀ cos θ in the torque and M₀ sin θ in the bending, does no work with F R over a turn.

    Attributes:
        index: D/d.
        grid: elements along a side of the section's core, and rings.
        layers: elements round the turn.
    """

    index: float
    grid: int
    layers: int

    @property
    def name(self) -> str:
        """For the store."""
        return f"elastic-C{self.index:g}-{self.grid}x{self.layers}"


def run(case: ElasticCase, comm: MPI.Comm) -> dict[str, Any]:
    """Factors of 8 F D / (π d³) at mid-section, and the head's force over G d⁴ δ / (8 D³), as a dict."""
    D = case.index * WIRE
    law = library.load("elastic")
    wire = coil_section(WIRE, D, 0.0, 360.0, case.layers, comm, SectionGrid(case.grid, case.grid))
    problem = SolidProblem(wire, MaterialPoints(law))
    travel = 1e-4 * D
    problem.step(Motion((0.0, 0.0, travel)))
    force = problem.reactions(np.zeros(3))[1].force[2]
    radius = 0.5 * WIRE
    sample = SectionSample(problem.solid, 0.5 * wire.length, np.array([-radius, radius]), np.zeros(2))
    inside, outside = np.abs(sample.stress()[:, 2]) * np.pi * WIRE**3 / (8 * force * D)
    return {
        "index": case.index,
        "grid": case.grid,
        "layers": case.layers,
        "unknowns": problem.unknowns,
        "inside": float(inside),
        "outside": float(outside),
        "force": float(force / (law.G * WIRE**4 * travel / (8 * D**3))),
    }


def records(results: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Comparison records of the finest mesh of each spring index, with the change from the mesh before it."""
    out = []
    for index in sorted({result["index"] for result in results}):
        meshes = sorted((r for r in results if r["index"] == index), key=lambda r: r["unknowns"])
        best, exact = meshes[-1], references.goehner_exact(index)
        change = abs(best["inside"] / meshes[-2]["inside"] - 1) if len(meshes) > 1 else float("nan")
        label = f"D/d = {index:g}, {{}} ({best['unknowns']} unknowns, last refinement {100 * change:.2f} %)"
        for place, ours, reference, source, tolerance in (
            ("shear factor inside", best["inside"], references.wahl_factor(index), "Wahl 1963", 0.02),
            ("shear factor inside", best["inside"], references.goehner_series(index), "Göhner 1930, series", 0.02),
            ("shear factor inside", best["inside"], exact[0], "Göhner's equation, solved", 0.005),
            ("shear factor outside", best["outside"], exact[1], "Göhner's equation, solved", 0.005),
        ):
            out.append(
                {
                    "quantity": label.format(place),
                    "ours": ours,
                    "reference": reference,
                    "source": source,
                    "tolerance": tolerance,
                }
            )
    return out
