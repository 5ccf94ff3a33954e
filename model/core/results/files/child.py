"""Readers that run in a child process, as libraries in C can crash on a damaged file, HDF5 and VTK among them."""

import os
import signal
import tempfile
import warnings
from collections.abc import Callable, Mapping
from typing import IO, NoReturn

import numpy as np

from coilset.model.core.base.errors import reason

CRASHES = (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT, signal.SIGFPE, signal.SIGILL)
PROBLEM = "problem"  # name of the array that says why nothing was read


def in_child(read: Callable[[], Mapping[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """The arrays that a reader returns; its child process is what a crash ends, and what it corrupts.

    Args:
        read: returns numbers and words by name, none of them PROBLEM.

    Raises:
        ValueError: if `read` raises, with its reason in one line, or if it crashes.
    """
    with tempfile.TemporaryFile() as file:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which the child does without
            child = os.fork()
        if not child:
            _answer(read, file)
        try:
            _, status = os.waitpid(child, 0)
        except BaseException:  # Ctrl-C, which does not reach a child that is within a library
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise
        if status:
            raise ValueError("it is damaged: the library that reads such files crashes")
        file.seek(0)
        with np.load(file, allow_pickle=False) as found:
            names, *values = (found[f"arr_{number}"] for number in range(len(found.files)))
    arrays = dict(zip(names.tolist(), values, strict=True))
    if PROBLEM in arrays:
        raise ValueError(str(arrays[PROBLEM]))
    return arrays


def _answer(read: Callable[[], Mapping[str, np.ndarray]], file: IO[bytes]) -> NoReturn:
    """Write the arrays to a file and end the child, without what ends a command."""
    status = 1
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # for the last words of libraries
        for crash in CRASHES:
            signal.signal(crash, signal.SIG_DFL)
        try:
            arrays = dict(read())
        except Exception as error:
            arrays = {PROBLEM: np.array(reason(error))}
        np.savez(file, np.array(list(arrays)), *arrays.values())  # not by name: one may be that of an argument
        file.flush()
        status = 0
    finally:
        os._exit(status)
