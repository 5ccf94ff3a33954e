"""How the command `coilset` runs: its signals, one line and an exit code for every error, ranks that end together."""

import errno
import os
import re
import signal
import sys
import time
from difflib import get_close_matches
from types import FrameType
from typing import TYPE_CHECKING, Any

from coilset.model.core.base.errors import CoilsetError, InputError, how_to_install, printable
from coilset.model.core.runtime.processes import first_rank, number_of_ranks
from coilset.scripts.interrupt import INTERRUPTED, ONE_SIGNAL, STOPPED, Output, output_closed
from coilset.scripts.main import app
from coilset.scripts.startup import typer

if TYPE_CHECKING:  # commands load what they need
    from mpi4py import MPI

NO_ROOM = (errno.ENOSPC, errno.EFBIG, errno.EDQUOT, errno.EROFS)
TOGETHER = 10.0  # seconds within which all ranks meet an error that concerns them all
SOON_TOGETHER = 2.0  # and an interruption
HEARD = 0.5  # seconds for mpirun to pass on the output of a rank, before it ends the ranks and drops the rest
LONGEST_MESSAGE = 400  # characters of a wrong command line that a message repeats
SOON = 0.02  # seconds after which an interrupt that came during an import is tried again


def command_line_message(error: Any) -> str:
    """Click's message on a command line, with the user's words in it, in one line of limited length."""
    said = printable(error.format_message())
    if variable := _of_environment(error):
        said = re.sub(r"^Invalid value for '.*?'", f"Invalid value of {variable}", said)
    said = re.sub(r"^(No such command '.*?'\.) Did you mean .*", r"\1", said)  # the guess of newer versions of typer
    said += _hint(said)
    return said if len(said) <= LONGEST_MESSAGE else f"{said[: LONGEST_MESSAGE - 3]}..."


def _of_environment(error: Any) -> str:
    """The environment variable from which a wrong value came; empty if it came from the command line."""
    option, context = getattr(error, "param", None), getattr(error, "ctx", None)
    if option is None or context is None:
        return ""
    source = context.get_parameter_source(option.name)
    return str(option.envvar) if source is not None and source.name == "ENVIRONMENT" else ""


def _hint(said: str) -> str:
    """A suggestion of what may have been meant."""
    if said.startswith("No such option: -n"):
        return "; -n goes before the command, as in coilset -n 2 solve"
    if unknown := re.fullmatch(r"No such command '(.*)'\.", said):
        names = [str(command.name or getattr(command.callback, "__name__", "")) for command in app.registered_commands]
        near = get_close_matches(unknown[1], [*names, "material"], 1)
        return f" Is {near[0]} meant?" if near else " coilset --help lists the commands."
    return ""


def run() -> None:
    """Entry point of the command: one line and an exit code for every foreseeable error."""
    sys.stdout = Output(sys.stdout)
    # PETSc would treat a closed pipe, which Output handles, as a crash.
    os.environ["PETSC_OPTIONS"] = f"{os.environ.get('PETSC_OPTIONS', '')} -no_signal_handler"
    status = 1
    try:
        _listen()
        _refuse_unreadable(sys.argv[1:])
        status = app(prog_name="coilset", standalone_mode=False) or 0
    except CoilsetError as error:
        status = error.exit_code
        _leave_together(status, TOGETHER, str(error))
        _complain(str(error))
    except ModuleNotFoundError as error:
        if (words := how_to_install(error)) is None:
            _crash()
            raise
        status = InputError.exit_code
        _leave_together(status, TOGETHER, words)
        _complain(words)
    except OSError as error:
        if error.errno not in NO_ROOM:
            _crash()
            raise
        status = 1
        _complain(f"{error.filename or 'a file'}: cannot be written: {error.strerror}")
    except typer.Exit as error:
        status = error.exit_code
    except (typer.Abort, KeyboardInterrupt):
        status = INTERRUPTED
    except Exception as error:
        if not hasattr(error, "format_message"):  # of click, which newer versions of typer include under another name
            _crash()
            raise
        status = getattr(error, "exit_code", 1)
        _complain(command_line_message(error))
    if status == INTERRUPTED:  # typer may have converted the exception to an exit code
        status = _interrupted()
    sys.exit(status)


def _refuse_unreadable(words: list[str]) -> None:
    """A name that was written in another encoding: DOLFINx cannot be imported beside it.

    Raises:
        InputError: naming it.
    """
    for word in words:
        if re.search("[\ud800-\udfff]", word):  # what Python makes of bytes that are no UTF-8
            raise InputError("is not written in UTF-8; rename it", "", word)


def _listen() -> None:
    """Ctrl-C raises KeyboardInterrupt; on ranks started by `-n` it comes as SIGUSR1, and they end with mpirun.

    Where Python cannot pass an exception on, as in a destructor or a library's callback, it is raised again soon.
    """
    last = -ONE_SIGNAL

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal last
        if _cannot_pass_on(frame):
            signal.setitimer(signal.ITIMER_REAL, SOON)
            return
        before, last = last, time.monotonic()
        if last - before > ONE_SIGNAL:
            raise KeyboardInterrupt

    def unraisable(lost: "sys.UnraisableHookArgs") -> None:
        nonlocal last
        if lost.exc_type is KeyboardInterrupt:
            last = -ONE_SIGNAL
            signal.setitimer(signal.ITIMER_REAL, SOON)
        else:
            sys.__unraisablehook__(lost)

    sys.unraisablehook = unraisable
    signal.signal(signal.SIGALRM, interrupt)
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, interrupt)
    if "COILSET_RANKS" in os.environ:
        from coilset.model.core.runtime.processes import end_with_parent

        end_with_parent()
        signal.signal(signal.SIGUSR1, interrupt)
        if os.path.exists(os.environ.get(STOPPED, "")):  # the signal came before this process
            raise KeyboardInterrupt


def _cannot_pass_on(frame: FrameType | None) -> bool:
    """Is a module imported there, or an entry checked, where an unexpected exception becomes another, or a crash?"""
    while frame is not None:
        file = frame.f_code.co_filename
        if file.startswith("<frozen importlib") or "/pydantic/" in file:
            return True
        frame = frame.f_back
    return False


def _crash() -> None:
    """An unforeseen error on one of several ranks: end them all, since the others would wait forever."""
    if world := _several_ranks():
        import traceback

        traceback.print_exc()
        _abort(world, 1)


def _interrupted() -> int:
    """Report an interruption in one line; returns its exit code.

    A rank that waits for another one inside MPI receives no signal: if it does not come within SOON_TOGETHER, all end.
    Before MPI runs, a rank leaves at once: a thread may just be starting it, and its end would wait for the others.
    """
    closed = output_closed()  # like any program whose reader has gone
    status = 128 + signal.SIGPIPE if closed else INTERRUPTED
    if not closed:
        _complain("interrupted")
    if _several_ranks():
        for number in (signal.SIGINT, signal.SIGUSR1, signal.SIGALRM):
            signal.signal(number, signal.SIG_IGN)  # the end is near
        _leave_together(status, SOON_TOGETHER)
    elif number_of_ranks() > 1:
        sys.stderr.flush()
        os._exit(status)
    return status


def _leave_together(exit_code: int, seconds: float, line: str = "") -> None:
    """An error on all ranks is reported by the first; an error on only some of them ends them all.

    Args:
        exit_code: of ranks that end without the others.
        seconds: that a rank waits for the others.
        line: that it reports then; empty: it has been reported.
    """
    if (world := _several_ranks()) is None:
        return
    arrived, until = world.Ibarrier(), time.monotonic() + seconds
    while not arrived.Test():
        if time.monotonic() > until:
            if line:
                print(f"coilset: {line}", file=sys.stderr, flush=True)
            _abort(world, exit_code)
        time.sleep(0.01)


def _abort(world: "MPI.Comm", exit_code: int) -> None:
    """End all ranks without losing their output so far."""
    sys.stderr.flush()
    time.sleep(HEARD)
    world.Abort(exit_code)


def _several_ranks() -> "MPI.Comm | None":
    """The communicator of all ranks, if MPI runs on several."""
    if "mpi4py.MPI" not in sys.modules:
        return None
    from mpi4py import MPI

    alive = MPI.Is_initialized() and not MPI.Is_finalized()
    return MPI.COMM_WORLD if alive and MPI.COMM_WORLD.size > 1 else None


def _complain(line: str) -> None:
    if first_rank():
        print(f"coilset: {printable(line)}", file=sys.stderr)
