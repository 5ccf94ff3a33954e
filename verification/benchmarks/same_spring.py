"""The same spring in coilset and in OpenSees: forces, sets, and the time of the analysis alone.

The example's wire between clamped heads, with linear isotropic hardening, is compressed by 10 mm in 40 equal steps and
released in as many. Both programs get the same nodes and the same 32 points in each of an element's two sections.
OpenSees's element is the corotational `timoshenkoBeamColumn`, which knows shear as coilset's does, with von Mises
fibres of three stresses (`NDFiber`, `J2BeamFiber`). It joins the nodes by straight chords; so does coilset here, unless
it is asked for its curved axis, which no element of OpenSees has.

Processor time is that of one thread. OpenSees has one; a run of coilset takes as many as there are cores, unless it is
told otherwise, and the time that it then takes by the clock is measured beside.

OpenSees is wanted, not needed: `pip install --target FOLDER openseespy`, Debian's libblas3 and liblapack3, and
`PYTHONPATH=FOLDER scripts/coilset bench`. Where it is missing only coilset is measured, and the bench says so.
"""

import importlib.util
import json
import math
import sys
import time
from typing import TYPE_CHECKING, Any

from coilset.model.run.examples import EXAMPLES
from coilset.verification.benchmarks.process import read_json

if TYPE_CHECKING:
    from coilset.model.run.analysis import Analysis

TURNS, TRAVEL, STEPS = 2.5, 10.0, 40
MATERIAL, YIELD_STRESS, HARDENING = "linear_isotropic", 400.0, 2000.0  # N/mm², as in the library's file
THEIRS = "coilset.verification.benchmarks.opensees"


def compare(elements: int, curved: int = 0, repeats: int = 3) -> dict[str, Any]:
    """Measure coilset, and OpenSees where it is.

    Args:
        elements: of the spring.
        curved: 1: coilset takes its curved axis instead of the chords.
        repeats: of which the least time counts.

    Returns:
        Dict: `elements`, `axis`, and for `coilset`, for it without the error of its steps, which OpenSees does not
        estimate either (`unestimated`), and for `opensees` (None where it is missing) a dict of `force_N` at the end of
        the compression, `set_mm`, `iterations`, `seconds` of the processor with one thread, and `elapsed` seconds with
        `threads` of them.
    """
    axis = "curved" if curved else "chords"
    analysis, ours = _coilset(elements, axis, repeats)
    _, unestimated = _coilset(elements, axis, repeats, "accuracy=none")
    theirs = run_opensees(_model(analysis), repeats) if importlib.util.find_spec("openseespy") else None
    return {"elements": elements, "axis": axis, "coilset": ours, "unestimated": unestimated, "opensees": theirs}


def _coilset(elements: int, axis: str, repeats: int, *more: str) -> tuple["Analysis", dict[str, Any]]:
    from mpi4py import MPI

    from coilset.model.case import read_case
    from coilset.model.run.analysis import Analysis
    from coilset.model.runtime.threads import usual

    down, back = f"{{to: {{travel: {TRAVEL}}}, steps: {STEPS}}}", f"{{to: {{force: 0}}, steps: {STEPS}}}"
    settings = [
        "ends=clamped",
        f"material={MATERIAL}",
        f"mesh.elements_per_turn={elements / TURNS}",
        f"mesh.axis={axis}",
        "mesh.section={kind: plane, radial: 4, angular: 8}",
        f"loading=[{down}, {back}]",
        *more,
    ]
    case = read_case(EXAMPLES / "ck15_presetting.yaml", settings)
    spent, threads = {"seconds": math.inf, "elapsed": math.inf}, usual(1)
    for _ in range(repeats + 1):  # the first one loads the compiled code
        for name, number, clock in (("seconds", 1, time.process_time), ("elapsed", threads, time.perf_counter)):
            analysis = Analysis(case, MPI.COMM_SELF, threads=number)
            begun = clock()
            steps = analysis.run().steps
            spent[name] = min(spent[name], clock() - begun)
    force = max(step.force_N for step in steps)
    iterations = sum(step.iterations for step in steps)
    return analysis, {
        "force_N": force,
        "set_mm": steps[-1].travel_mm,
        "iterations": iterations,
        "threads": threads,
        **spent,
    }


def _model(analysis: "Analysis") -> dict[str, Any]:
    """Everything that OpenSees needs, as plain data."""
    rod, law = analysis.rod, analysis.law
    R = rod.largest_radius
    fibres = [
        (R * y, R * z, math.pi * R * R * weight)
        for (y, z), weight in zip(rod.rule.points.tolist(), rod.rule.weights.tolist(), strict=True)
    ]
    material = {"E": law.E, "nu": 0.5 * law.E / law.G - 1.0, "yield_stress": YIELD_STRESS, "hardening": HARDENING}
    return {
        "nodes": rod.line.stations.tolist(),
        "third_axes": rod.line.in_order(rod.E0)[:, :, 2].tolist(),
        "fibres": fibres,
        "material": material,
        "travel": TRAVEL,
        "steps": STEPS,
    }


def run_opensees(model: dict[str, Any], repeats: int) -> dict[str, Any]:
    """The fastest of some runs, in a process without PETSc: the two do not live together.

    Raises:
        CoilsetError: if it failed.
    """
    return read_json([sys.executable, "-m", THEIRS, str(repeats)], "OpenSees", text=json.dumps(model))
