"""`python -m coilset.scripts`, and the installed command."""

import gc
import os
import signal

GARBAGE = 100_000  # objects after which Python looks for circular ones: not for each 700 of the many that a run keeps


def _leave(*_: object) -> None:
    os.write(2, b"coilset: interrupted\n")
    os._exit(128 + signal.SIGINT)


def main() -> None:
    """Run the command; Ctrl-C while its libraries are still being loaded ends it at once.

    scripts/coilset starts Python with SIGINT blocked; otherwise Ctrl-C would cause a traceback until this point.
    """
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _leave)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    from coilset.model.runtime.switches import enabled

    if enabled("garbage"):
        gc.set_threshold(GARBAGE)
    from coilset.scripts.running import run

    run()


if __name__ == "__main__":
    main()
