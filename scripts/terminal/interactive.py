"""`coilset solve --interactive`: watch each step, and change size, method and target before the next."""

import signal
from collections.abc import Callable

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.entry import check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.yaml import load_yaml
from coilset.model.core.case.phases import Phase
from coilset.model.core.results.records.record import Step

HELP = """\
Enter            the next step
run              continue without asking
size S           the next step is S regular steps long, as in: size 0.25
to TARGET        another target from here, as in: to {height: 20}, to block; append ', steps: 8' to say how many
method NAME      another iteration method, as in: method bfgs
stop             end here; the results are written, and --resume continues"""


class Prompt:
    """Prompt after each step; usable as the report of `Analysis.run`.

    Args:
        say: prints a line.
        ask: returns the user's line for a prompt.
    """

    def __init__(self, analysis: Analysis, say: Callable[[str], object], ask: Callable[[str], str] = input) -> None:
        self.analysis, self.say, self.ask, self.free = analysis, say, ask, False

    def __call__(self, step: Step) -> None:
        """Prompt until the user starts the next step."""
        while not self.free:
            try:
                word, _, rest = self._answer().strip().partition(" ")
            except EOFError:
                word, rest = "run", ""
            if word == "":
                return
            try:
                self.obey(word, rest.strip())
            except (InputError, ValueError) as error:
                self.say(str(error))

    def _answer(self) -> str:
        """The user's line. Ctrl-C ends the run at once, as no step is in progress."""
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            return self.ask("coilset> ")
        finally:
            signal.signal(signal.SIGINT, before)

    def obey(self, word: str, rest: str) -> None:
        """Carry out one command.

        Raises:
            InputError, ValueError: if it is wrong; then nothing changes.
            KeyboardInterrupt: for `stop`.
        """
        if word == "run":
            self.free = True
        elif word == "stop":
            raise KeyboardInterrupt
        elif word == "size":
            size = float(rest)
            if not 0.0 < size <= 1000.0:
                raise ValueError("a size is a number above 0, in regular steps")
            self.analysis.continuation.steps.resize(size)
        elif word == "method":
            self.analysis.use_method(rest)
        elif word == "to":
            self.analysis.redirect(parse_phase(rest))
        else:
            self.say(HELP)


def parse_phase(text: str) -> Phase:
    """A Phase from `{height: 20}, steps: 8` or `block`.

    Raises:
        InputError: if it is not a phase.
    """
    try:
        return check_entries(load_yaml(f"{{to: {text}}}"), Phase)
    except InputError as error:
        problem = f"{error.problem}; a target is block, {{travel: mm}}, {{height: mm}} or {{force: N}}"
        raise InputError(problem, error.place) from None
