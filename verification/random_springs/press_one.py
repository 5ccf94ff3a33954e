"""Run the load programs of springs, one after the other, for `coilset bench --springs`.

    scripts/coilset python verification/random_springs/press_one.py

Reads a case and the seconds that it may take as a line of JSON and prints what became of it as one, until there are no
more. It runs in this checkout and in others: it uses only what they have, too.
"""

import json
import signal
import sys
import time
from typing import Any

from coilset.model.core.base.errors import InputError, SolveError


def press(data: dict[str, Any], limit: float) -> dict[str, Any]:
    """Run one case on one thread.

    Args:
        data: of a case file.
        limit: seconds of processor time after which it is given up.

    Returns:
        Dict: `end`: complete, refused, unsolved or too slow; `message`, `seconds` of the processor, `steps`,
        `iterations`, `evaluations`, `cuts`; `force_N`, the greatest, and `length_mm`, the last height of the seats.
    """
    from mpi4py import MPI

    from coilset.model.compose.analysis import Analysis
    from coilset.model.core.case import check

    def give_up(*_: object) -> None:
        raise KeyboardInterrupt  # as by hand: the analysis lets no other error through PETSc unchanged

    steps: list[Any] = []
    end, message = "complete", ""
    signal.signal(signal.SIGPROF, give_up)
    began = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        analysis = Analysis(check(data), MPI.COMM_SELF, detailed=False, threads=1)
        analysis.run(steps.append)
    except InputError as error:
        end, message = "refused", str(error)
    except SolveError as error:
        end, message = "unsolved", str(error)
    except KeyboardInterrupt:
        end = "too slow"
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    return {
        "end": end,
        "message": message,
        "seconds": time.process_time() - began,
        "steps": len(steps),
        **{name: sum(getattr(step, name) for step in steps) for name in ("iterations", "evaluations", "cuts")},
        "force_N": max((step.force_N for step in steps), default=None),
        "length_mm": steps[-1].seat_height_mm if steps else None,
    }


if __name__ == "__main__":
    from coilset.model.core.runtime.caches import load_without_compiler

    load_without_compiler()
    answers = sys.stdout
    sys.stdout = sys.stderr  # warnings of the program are no answers
    for line in sys.stdin:
        print(json.dumps(press(*json.loads(line))), file=answers, flush=True)
