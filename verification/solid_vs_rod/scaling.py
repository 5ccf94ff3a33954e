"""Iterations of the multigrid over the number of unknowns, and time over the number of ranks.

`scripts/coilset -n RANKS python -m coilset.verification.solid_vs_rod.scaling FOLDER [SIZE ...]`
"""

import sys

from mpi4py import MPI

from coilset.meshes.solid import SectionGrid, coil_section
from coilset.model.material import library
from coilset.model.solid.heads import Motion
from coilset.model.solid.points import MaterialPoints
from coilset.model.solid.problem import SolidProblem
from coilset.verification.solid_vs_rod.pressing import WIRE, PressedSection
from coilset.verification.solid_vs_rod.store import Store

# elements along the core's side and of rings, and along the wire: name → 20,000 to 500,000 unknowns
SIZES = {"20k": (3, 32), "50k": (4, 48), "120k": (5, 72), "200k": (6, 86), "500k": (8, 122)}


def measure(size, comm, solver="multigrid"):
    """One elastic and one plastic step of the pressed section of D/d = 8.

    The first step stays elastic; the second goes to a travel at which nearly all of the wire's section flows.

    Returns:
        Dict: unknowns, ranks, and for each step (`elastic`, `plastic`) its linear solves, iterations of the linear
        solver in one solve on average, and seconds at the points, in assembly, and in solving.
    """
    grid, layers = SIZES[size]
    case = PressedSection()
    wire = coil_section(WIRE, case.mean_diameter, case.pitch, 360.0, layers, comm, SectionGrid(grid, grid))
    problem = SolidProblem(wire, MaterialPoints(library.load(case.material)), solver)
    problem.step(Motion((0.0, 0.0, -1e-4)))  # compiles and plans; not counted
    out = {"size": size, "unknowns": problem.unknowns, "ranks": comm.size}
    for name, travel in (("elastic", 0.5), ("plastic", 2.5)):
        problem.seconds.update(dict.fromkeys(problem.seconds, 0.0))
        effort = problem.step(Motion((0.0, 0.0, -travel)))
        spent = comm.allreduce(problem.seconds["all"], op=MPI.MAX)
        points, assembly = (comm.allreduce(problem.seconds[k]) / comm.size for k in ("points", "assembly"))
        out[name] = {
            "solves": effort.iterations, "iterations": effort.linear_iterations / effort.iterations,
            "points": points, "assembly": assembly, "solving": spent - points - assembly, "all": spent,
        }  # fmt: skip
    return out


def main(folder, *sizes):
    """Measure and print a table."""
    comm = MPI.COMM_WORLD
    store = Store(folder, comm, print)
    for size in sizes or SIZES:
        result = store.get(f"scaling-{size}-{comm.size}", lambda size=size: measure(size, comm))
        for name in ("elastic", "plastic"):
            store.report(f"{result['unknowns']:8d} unknowns, {result['ranks']} ranks, {name}: " + ", ".join(
                f"{key} {value:.3g}" for key, value in result[name].items()))  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
