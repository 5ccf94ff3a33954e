"""`python -m coilset.scripts`, and the installed command."""

import os
import signal


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
    os.environ.setdefault("PYTHONSAFEPATH", "coilset")  # as scripts/coilset; see coilset.model.core.runtime.apart
    from coilset.scripts.running import run

    run()


if __name__ == "__main__":
    main()
