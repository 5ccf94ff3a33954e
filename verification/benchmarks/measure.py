"""One measurement, in a process of its own so that its memory is its own: prints one line of JSON.

    python -m coilset.verification.benchmarks.measure example [REPEATS]
    mpirun -n RANKS python -m coilset.verification.benchmarks.measure press ELEMENTS [REPEATS [TOUCHING [ESTIMATED]]]

The stages: `law` updates all section points (strains of the sections, material law, resultants, tangents); `assemble`
the forces and the matrix; `contact` finds and evaluates coils and seats; `factorise` and `solve` are PETSc's, from its
own log; `other` is what is left of the iteration. `set-up` is what an analysis does before its first step, without the
`mesh`.
"""

import json
import math
import resource
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.runtime.caches import load_without_compiler
from coilset.verification.benchmarks.stopwatch import Stopwatch

if TYPE_CHECKING:  # at run time their import is measured
    from mpi4py import MPI

    from coilset.model.compose.analysis import Analysis
    from coilset.model.core.case import Case

TURNS = 2.5  # of the example's spring
MOST_TURNS = 256  # of springs whose coils touch: a thousand do not come to block in one step
TRAVEL = 10.0  # mm, in one step: three times the travel at which the wire begins to yield
STAGES = ("mesh", "set-up", "law", "contact", "assemble", "factorise", "solve", "other")
ITERATION = STAGES[2:]  # of the equilibrium iteration
SAME = ("mesh.section.radial=4", "mesh.section.angular=12")  # so that times of all versions refer to the same work
STEPS = ("loading.0.steps=12", "loading.1.steps=12")
FACTORISE, SOLVE = ("MatLUFactorSym", "MatLUFactorNum"), ("MatSolve",)  # PETSc's events


def watch_analysis(watch: Stopwatch, analysis: "Analysis") -> None:
    """Make the stages of a solve count."""
    watch.watch(analysis.rod, "update", "law")
    for owner, function in ((analysis.rod, "internal_forces"), (analysis.system, "last_tangent")):
        watch.watch(owner, function, "assemble")
    for contact in analysis.system.contacts:
        watch.watch(contact, "evaluate", "contact")
    watch.watch(analysis.newton.limit, "step_length", "contact")


def petsc_seconds(events: Iterable[str]) -> float:
    """Elapsed seconds in PETSc's log for these events."""
    from petsc4py import PETSc

    return sum(PETSc.Log.Event(event).getPerfInfo()["time"] for event in events)


class Logged:
    """Charges what PETSc's log says was factorised and solved, and leaves the rest in `other`."""

    def __init__(self, watch: Stopwatch) -> None:
        from petsc4py import PETSc

        PETSc.Log.begin()
        self.watch, self.before = watch, self._read()

    def _read(self) -> dict[str, float]:
        return {"factorise": petsc_seconds(FACTORISE), "solve": petsc_seconds(SOLVE)}

    def charge(self) -> None:
        """Move what has been logged since the last call out of `other`."""
        now = self._read()
        self.watch.split("other", {name: now[name] - self.before[name] for name in now})
        self.before = now


def read_example(settings: Iterable[str] = ()) -> "Case":
    """The example's Case, with 4 x 12 points in a section."""
    from coilset.model.core.case import read_case

    return read_case(EXAMPLES / "ck15_presetting.yaml", [*SAME, *settings])


def build(watch: Stopwatch, case: "Case", comm: "MPI.Comm") -> "Analysis":
    """An Analysis whose stages are watched."""
    from coilset.model.compose.analysis import Analysis

    with watch.stage("set-up"):
        analysis = Analysis(case, comm)
    watch_analysis(watch, analysis)
    return analysis


def watch_meshing() -> Stopwatch:
    """The Stopwatch whose stage `mesh` is what the analysis has made in `meshes`."""
    from coilset.model.compose import build as module

    watch = Stopwatch()
    for function in ("line_mesh", "section_placement"):
        watch.watch(module, function, "mesh")
    return watch


def example(repeats: int = 5) -> dict[str, Any]:
    """The example, 40 elements, 12 steps down and up with contact, several times in one process.

    Returns:
        Dict: `import`; `first`: the first analysis, which loads or compiles the kernels and forms; `stages`: seconds of
        the following analyses, the minimum of all repeats for each stage; `analysis`: the minimum of their sums;
        `output` and `pictures`; all as pairs of wall and CPU seconds. And counts.
    """
    start = Stopwatch()
    with start.stage("import"):
        from mpi4py import MPI

        import coilset.model.compose.analysis  # noqa: F401
    watch, runs = watch_meshing(), []
    logged = Logged(watch)
    for _ in range(repeats + 1):
        watch.wall.clear()
        watch.cpu.clear()
        analysis = build(watch, read_example(STEPS), MPI.COMM_SELF)
        with watch.stage("other"):
            result = analysis.run()
        logged.charge()
        runs.append({stage: (watch.wall[stage], watch.cpu[stage]) for stage in STAGES})
    first, warm = runs[0], runs[1:]
    write(start, analysis)
    sums = [tuple(sum(run[stage][kind] for stage in STAGES) for kind in range(2)) for run in warm]
    return {
        "import": pair(start, "import"),
        "first": [sum(first[stage][kind] for stage in STAGES) for kind in range(2)],
        "stages": {stage: [min(run[stage][kind] for run in warm) for kind in range(2)] for stage in STAGES},
        "analysis": [min(total[kind] for total in sums) for kind in range(2)],
        "output": pair(start, "output"),
        "pictures": pair(start, "pictures"),
        "elements": len(analysis.setup.turns) - 1,
        "section_points": len(analysis.rod.rule),
        "steps": len(result.steps),
        "iterations": sum(step.iterations for step in result.steps),
        "memory_GiB": peak_memory(),
    }


def pair(watch: Stopwatch, stage: str) -> list[float]:
    """Wall and CPU seconds of a stage."""
    return [watch.wall[stage], watch.cpu[stage]]


def write(watch: Stopwatch, analysis: "Analysis") -> None:
    """Everything that `coilset solve` writes, into a folder that is thrown away."""
    from coilset.model.compose.run_files import write_run
    from coilset.model.compose.summary import summarise
    from coilset.model.core.results.records.provenance import origin
    from coilset.model.tools.figures.pictures import PARTS

    records, made_with = (analysis.setup, analysis.result), origin(analysis.case)
    with tempfile.TemporaryDirectory() as folder:
        with watch.stage("output"):
            write_run(Path(folder), *records, summarise(*records), made_with)
        with watch.stage("pictures"):
            for load in PARTS.values():
                load()(Path(folder))


def pressed(elements: int, touching: bool) -> list[str]:
    """Settings of a spring between clamped heads and of one step: see `press`."""
    if touching:
        per_turn = max(16, math.ceil(elements / MOST_TURNS))
        return [
            "ends=clamped",
            f"spring.turns={elements / per_turn}",
            "spring.pitch=5.25",
            f"mesh.elements_per_turn={per_turn}",
            "loading=[{to: block, steps: 1}]",
        ]
    return [
        "ends=clamped",
        f"mesh.elements_per_turn={elements / TURNS}",
        f"loading=[{{to: {{travel: {TRAVEL}}}, steps: 1}}]",
    ]


def press(elements: int, repeats: int = 1, touching: int = 0, estimated: int = 1) -> dict[str, Any]:
    """One step of a spring between clamped heads, in many elements.

    Args:
        elements: their number.
        repeats: how often it is measured.
        touching: 0: the example's spring in elements of any length, compressed far into the plastic range, without
            contact; 1: windings of 16 elements, or more where there would be too many of them, whose pitch is 5 % more
            than the wire's diameter, pressed to block.
        estimated: 0: the error of the step is not estimated.

    Returns:
        Dict of counts, the force, the share of plastic points, peak memory of a rank, and `stages`: wall and CPU
        seconds, the largest of the ranks, the smallest of the repeats.
    """
    from mpi4py import MPI

    comm, watch, runs = MPI.COMM_WORLD, watch_meshing(), []
    logged = Logged(watch)
    case = read_example([*pressed(elements, bool(touching)), *([] if estimated else ["accuracy=none"])])
    for _ in range(repeats):
        watch.wall.clear()
        watch.cpu.clear()
        analysis = build(watch, case, comm)
        with watch.stage("other"):
            taken = list(analysis.program.run(analysis.stage(0)))
        logged.charge()
        ranks = comm.allgather({stage: pair(watch, stage) for stage in STAGES})
        runs.append({stage: [max(rank[stage][kind] for rank in ranks) for kind in range(2)] for stage in STAGES})
    plastic = analysis.rod.point_state[..., 6] > 0.0
    return {
        "elements": len(analysis.setup.turns) - 1,
        "estimated": bool(estimated),
        "ranks": comm.size,
        "unknowns": analysis.layout.size,
        "force_N": analysis.control.force,
        "iterations": sum(step.outcome.iterations for step in taken),
        "contacts": analysis.system.last.closed,
        "cuts": sum(step.cuts for step in taken),
        "evaluations": taken[-1].outcome.evaluations,
        "plastic": comm.allreduce(int(plastic.sum())) / comm.allreduce(plastic.size),
        "memory_GiB": max(comm.allgather(peak_memory())),
        "stages": {stage: [min(run[stage][kind] for run in runs) for kind in range(2)] for stage in STAGES},
    }


def per_element(run: dict[str, Any]) -> float:
    """Processor time of an element in a Newton iteration of `press`, µs."""
    return 1e6 * sum(run["stages"][name][1] for name in ITERATION) / (run["elements"] * run["iterations"])


def peak_memory() -> float:
    """Maximum resident memory of this process so far, GiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


Job = Callable[..., dict[str, Any]]
JOBS: dict[str, Job] = {"example": example, "press": press}


def main(job: str, *arguments: str) -> None:
    """Run a job with whole numbers as arguments and print what it found; kernels are loaded as commands load them."""
    load_without_compiler()
    found = JOBS[job](*map(int, arguments))
    from mpi4py import MPI

    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
