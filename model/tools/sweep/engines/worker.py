"""A process that runs cases: each line in is a JSON list of tasks, each line out the list of their records.

The first line in names the file for its other output. Imports, compiled forms and compiled kernels are reused from case
to case. It ends when its input ends, and with the process that started it, however that ends.
"""

import json
import os
import signal
import sys

from coilset.model.core.runtime.caches import load_without_compiler
from coilset.model.core.runtime.processes import end_with_parent


def main() -> None:
    """`python -m coilset.model.tools.sweep.engines.worker`."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is handled by the leading process
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # output of libraries must not mix with the answers

    load_without_compiler()
    from mpi4py import MPI

    from coilset.model.core.results.files.folder import not_linked
    from coilset.model.tools.sweep.evaluate import evaluate_in_worker

    first = sys.stdin.readline()
    if not first:
        return
    log = not_linked(json.loads(first), os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    for output in (1, 2):
        os.dup2(log, output)
    for line in sys.stdin:
        records = evaluate_in_worker(json.loads(line), MPI.COMM_SELF)
        answers.write(json.dumps(records, allow_nan=False) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
