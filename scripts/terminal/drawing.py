"""Pictures are drawn by separate processes, after the answer is printed.

    python -m coilset.scripts.terminal.drawing PART

If a core is free they are started first, and load their libraries while the spring is being solved. They end with the
process that started them, however it ends.
"""

import contextlib
import gc
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

from coilset.model.core.base.errors import CoilsetError, how_to_install
from coilset.model.core.runtime.libraries import LazyFinder
from coilset.model.core.runtime.processes import end_with_parent, first_rank, number_of_ranks, usable_cores

PARTS = ("figures", "scene")  # of coilset.model.tools.figures.pictures
MODEST = 5  # niceness of these processes relative to the one that solves
PATIENCE = 5.0  # seconds that a terminated process has for cleaning up


class Drawings:
    """The processes that draw the pictures of a run; leaving this context ends them.

    Args:
        environment: of the processes, from before MPI is started, which changes it.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        self.environment = dict(environment)
        self.processes: dict[str, subprocess.Popen[bytes]] = {}

    def start_if_free(self) -> None:
        """Start the processes now if there is a core for them besides those of the ranks."""
        if first_rank() and usable_cores() > number_of_ranks():
            self._start()

    def _start(self) -> None:
        for part in PARTS:
            if part not in self.processes:
                self.processes[part] = subprocess.Popen(
                    [sys.executable, "-m", "coilset.scripts.terminal.drawing", part],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    env=self.environment,
                    start_new_session=True,
                    preexec_fn=end_with_parent,
                )

    def draw(self, folder: Path) -> list[str]:
        """Draw the run in a folder and wait; meanwhile SIGTERM raises KeyboardInterrupt, like SIGINT.

        Returns:
            Warnings, one line each.

        Raises:
            CoilsetError: with the first reason why a picture is missing; all processes have ended by then.
        """
        before = signal.signal(signal.SIGTERM, signal.getsignal(signal.SIGINT))
        try:
            self._start()
            for process in self.processes.values():
                _give(process, folder)
            answers = [_answer(process) for process in self.processes.values()]
        finally:
            signal.signal(signal.SIGTERM, before)
        found = _together(answers)
        if found["problem"]:
            raise CoilsetError(found["problem"])
        return found["warnings"]

    def __enter__(self) -> "Drawings":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in self.processes.values():
            process.terminate()
        for process in self.processes.values():
            try:
                process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None and not pipe.closed:
                    _close(pipe)


def _give(process: subprocess.Popen[bytes], folder: Path) -> None:
    assert process.stdin is not None
    with contextlib.suppress(BrokenPipeError):  # it has died, as its answer will show
        process.stdin.write(os.fsencode(folder))
    _close(process.stdin)


def _close(pipe: Any) -> None:
    with contextlib.suppress(BrokenPipeError):
        pipe.close()


def _answer(process: subprocess.Popen[bytes]) -> dict[str, Any]:
    assert process.stdout is not None
    line = process.stdout.readline()
    if line.endswith(b"\n"):
        return json.loads(line)
    return _ended(process.wait())


def _together(answers: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The first problem, and all warnings."""
    problem = next((answer["problem"] for answer in answers if answer["problem"]), None)
    return {"problem": problem, "warnings": [warning for answer in answers for warning in answer["warnings"]]}


def _ended(status: int) -> dict[str, Any]:
    how = f"signal {-status}" if status < 0 else f"exit code {status}"
    return {"problem": f"not all pictures are drawn: the process that draws them ended with {how}", "warnings": []}


def draw_part(part: str, task: BinaryIO) -> dict[str, Any] | None:
    """Load the libraries of a part, wait for the folder of the run, and draw it; None if no folder is given."""
    try:
        from coilset.model.tools.figures import pictures

        draw = pictures.PARTS[part]()
    except ModuleNotFoundError as error:
        if (words := how_to_install(error)) is None:
            raise
        return {"problem": None, "warnings": [f"no pictures are drawn: {words}"]} if task.read() else None
    folder = task.read()
    if not folder:
        return None
    before = signal.signal(signal.SIGTERM, _leave)
    try:
        return {"problem": None, "warnings": draw(Path(os.fsdecode(folder)))}
    except CoilsetError as error:
        return {"problem": str(error), "warnings": []}
    except Exception as error:  # of the libraries that draw; the numbers are there all the same
        return {"problem": None, "warnings": [pictures.not_drawn("not all pictures are drawn", error)]}
    finally:
        signal.signal(signal.SIGTERM, before)


def _leave(*_: object) -> None:
    """End like an error, so that nothing is left half written."""
    sys.exit(128 + signal.SIGTERM)


def main(part: str) -> None:
    """The process that draws a part."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that solves
    os.nice(MODEST)
    gc.disable()  # it ends soon
    sys.meta_path.insert(0, LazyFinder(["matplotlib.pyplot"]))  # pyvista loads it and does not use it
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # output of libraries must not mix with the answers
    answer = draw_part(part, sys.stdin.buffer)
    if answer is not None:
        answers.write(json.dumps(answer) + "\n")
        answers.close()


if __name__ == "__main__":
    main(sys.argv[1])
