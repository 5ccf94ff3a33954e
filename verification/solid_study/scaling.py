"""How the solid's solver scales: multigrid iterations over the number of unknowns, and time over the number of ranks.

Iterations, on any number of ranks; it resumes where it stopped:

    scripts/coilset python -m coilset.verification.solid_study.scaling FOLDER

Time of one linearised step of 200,000 unknowns, five times; first on one rank, then on two, which also prints the
ratio:

    scripts/coilset [-n 2] python -m coilset.verification.solid_study.scaling FOLDER time
"""

import os
import sys
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

from mpi4py import MPI

from coilset.meshes.solids.solid import SectionGrid, coil_section
from coilset.model.core.material import library
from coilset.model.physics.solid.heads import Motion
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.physics.solid.problem import SolidProblem
from coilset.verification.solid_study.pressing import WIRE, PressedSection
from coilset.verification.solid_study.store import Store

# elements along the core's side and of rings, and along the wire: name → 20,000 to 500,000 unknowns
SIZES = {"20k": (3, 32), "50k": (4, 48), "120k": (5, 72), "200k": (6, 86), "500k": (8, 122)}
TIMED = "200k"
REPETITIONS = 5
STAGES = ("points", "assembly", "solve")


def pressed(size: str, comm: MPI.Comm, solver: str = "multigrid") -> SolidProblem:
    """The section of D/d = 8 after a first small step, which compiles and plans."""
    grid, layers = SIZES[size]
    case = PressedSection()
    wire = coil_section(WIRE, case.mean_diameter, case.pitch, 360.0, layers, comm, SectionGrid(grid, grid))
    problem = SolidProblem(wire, MaterialPoints(library.load(case.material)), solver)
    problem.step(Motion((0.0, 0.0, -1e-4)))
    return problem


def iterations(size: str, comm: MPI.Comm) -> dict[str, Any]:
    """One elastic step, and one to a travel at which nearly all of the wire's section flows.

    Returns:
        Dict: unknowns, ranks, and for each step (`elastic`, `plastic`) its linear solves, iterations of the linear
        solver in one of them on average, and seconds.
    """
    problem = pressed(size, comm)
    out = {"unknowns": problem.unknowns, "ranks": comm.size}
    for name, travel in (("elastic", 0.5), ("plastic", 2.5)):
        began = time.perf_counter()
        effort, _cuts = problem.step(Motion((0.0, 0.0, -travel)))
        seconds = comm.allreduce(time.perf_counter() - began, op=MPI.MAX)
        out[name] = {
            "solves": effort.iterations,
            "iterations": effort.linear_iterations / effort.iterations,
            "seconds": seconds,
        }
    return out


def timed(size: str, comm: MPI.Comm) -> dict[str, Any]:
    """Repeat a linearised step: stresses and moduli at the points and their forces, tangent and coarse one, solution.

    Returns:
        Dict: unknowns, ranks, and a list of repetitions: seconds of the three stages (the slowest rank's), and `share`,
        processor time over wall time (the minimum over the ranks); what is missing from 1 went to other programs.
    """
    problem = pressed(size, comm)
    repetitions = [_repetition(problem, comm) for _ in range(REPETITIONS)]
    return {"unknowns": problem.unknowns, "ranks": comm.size, "repetitions": repetitions}


def _repetition(problem: SolidProblem, comm: MPI.Comm) -> dict[str, float]:
    comm.barrier()
    assembled, cpu, wall = problem.solid.seconds["assembly"], time.process_time(), [time.perf_counter()]
    problem.system.restore()
    wall.append(time.perf_counter())
    load = problem.load(problem.bottom.motion, Motion((0.0, 0.0, -0.5)))
    linear = problem.predictor(load).linear_iterations
    wall.append(time.perf_counter())
    share = (time.process_time() - cpu) / (wall[2] - wall[0])
    assembly = problem.solid.seconds["assembly"] - assembled
    spent = wall[1] - wall[0], assembly, wall[2] - wall[1] - assembly
    out = dict(zip(STAGES, (comm.allreduce(t, op=MPI.MAX) for t in spent), strict=True))
    return {**out, "iterations": linear, "share": comm.allreduce(share, op=MPI.MIN)}


def best(result: dict[str, Any]) -> dict[str, float]:
    """Minimum time of each stage over the repetitions, and of all stages together."""
    out = {stage: min(r[stage] for r in result["repetitions"]) for stage in STAGES}
    return {**out, "all": min(sum(r[stage] for stage in STAGES) for r in result["repetitions"])}


def _report_iterations(store: Store, sizes: Sequence[str]) -> None:
    for size in sizes or SIZES:
        result = store.get(f"iterations-{size}", partial(iterations, size, store.comm))
        for name in ("elastic", "plastic"):
            step = result[name]
            store.report(
                f"{result['unknowns']:8d} unknowns, {name}: {step['iterations']:.1f} iterations per solve, "
                f"{step['solves']} solves, {step['seconds']:.0f} s on {result['ranks']} rank(s)"
            )


def _report_times(store: Store) -> None:
    result = store.put(f"time-{store.comm.size}", timed(TIMED, store.comm))
    store.report(f"{result['unknowns']} unknowns on {result['ranks']} rank(s), load {os.getloadavg()[0]:.1f}; seconds")
    for r in result["repetitions"]:
        store.report(
            ", ".join(f"{stage} {r[stage]:.2f}" for stage in STAGES)
            + f"; {r['iterations']} iterations, share of the processor {r['share']:.2f}"
        )
    one = store.read("time-1")
    if result["ranks"] > 1 and one:
        one, more = best(one), best(result)
        store.report(
            "best of one rank over best of these: " + ", ".join(f"{name} {one[name] / more[name]:.2f}" for name in more)
        )


def main(folder: str, *what: str) -> None:
    """Measure and print."""
    store = Store(folder, MPI.COMM_WORLD, print)
    if what == ("time",):
        _report_times(store)
    else:
        _report_iterations(store, what)


if __name__ == "__main__":
    main(*sys.argv[1:])
