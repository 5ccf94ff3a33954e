"""A spring in OpenSees: its data as JSON on the standard input, what was found on the standard output.

    python -m coilset.verification.benchmarks.opensees REPEATS < model.json

`same_spring` says what it is compared with and writes the data. Nothing of coilset is loaded here.
"""

import json
import sys
import time
from typing import Any

import openseespy.opensees as ops

UNBALANCE = 1e-6  # N and N mm that may be left; coilset's 1e-9 of what a step changes is not more


def run(model: dict[str, Any]) -> dict[str, Any]:
    """Compress the spring in equal steps and release it in as many.

    Args:
        model: `nodes`, `third_axes` of the elements, `fibres` as y, z, area, `material`, `travel`, `steps`; N and mm.

    Returns:
        Dict: `force_N` at the end of the compression, `set_mm`, `iterations`, and of all steps `seconds` of the
        processor and `elapsed` ones, with one of its `threads`.
    """
    _build(model)
    top, steps = len(model["nodes"]), model["steps"]
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandSPD")  # the fastest of those that were tried
    ops.test("NormUnbalance", UNBALANCE, 50)
    ops.algorithm("Newton")
    ops.integrator("DisplacementControl", top, 3, -model["travel"] / steps)
    ops.analysis("Static")
    begun = time.process_time(), time.perf_counter()
    there = _take(steps)
    force = -ops.getTime()  # factor of the unit load
    ops.integrator("LoadControl", force / steps)
    back = _take(steps)
    seconds, elapsed = time.process_time() - begun[0], time.perf_counter() - begun[1]
    return {
        "force_N": force,
        "set_mm": -ops.nodeDisp(top, 3),
        "iterations": there + back,
        "threads": 1,
        "seconds": seconds,
        "elapsed": elapsed,
    }


def _build(model: dict[str, Any]) -> None:
    material, top = model["material"], len(model["nodes"])
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for number, x in enumerate(model["nodes"], 1):
        ops.node(number, *x)
    ops.fix(1, 1, 1, 1, 1, 1, 1)
    ops.fix(top, 1, 1, 0, 1, 1, 1)
    isotropic, kinematic = material["hardening"], 0.0
    ops.nDMaterial("J2BeamFiber", 1, material["E"], material["nu"], material["yield_stress"], isotropic, kinematic)
    ops.section("NDFiber", 1)
    for fibre in model["fibres"]:
        ops.fiber(*fibre, 1)
    ops.beamIntegration("Legendre", 1, 1, 2)
    for number, axis in enumerate(model["third_axes"], 1):
        ops.geomTransf("Corotational", number, *axis)
        ops.element("timoshenkoBeamColumn", number, number, number + 1, number, 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(top, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def _take(steps: int) -> int:
    """Iterations of so many steps."""
    iterations = 0
    for step in range(steps):
        if ops.analyze(1):
            sys.exit(f"no equilibrium in step {step + 1}")
        iterations += ops.testIter()
    return iterations


if __name__ == "__main__":
    spring = json.load(sys.stdin)
    print(json.dumps(min((run(spring) for _ in range(int(sys.argv[1]))), key=lambda one: one["seconds"])))
