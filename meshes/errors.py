"""What can go wrong, in words: every error that a user may see is one of these, and its text is one line."""


def printable(text: str) -> str:
    """A line with those letters escaped that no screen shows, or that are orders to it; names of files may hold any."""
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in text)


class CoilsetError(Exception):
    """Base of the errors that end a run with one clear line; `exit_code` is that of the command."""

    exit_code = 1


class InputError(CoilsetError):
    """Wrong input: says the file, the place in it, the value, and what would be right.

    Args:
        problem: what is wrong and what would be right, without a full stop.
        place: the entry, as in ``spring.wire_diameter``, or a column or line; empty if there is none.
        file: the file's path as the user gave it; empty if the input came from elsewhere.
    """

    exit_code = 2

    def __init__(self, problem: object, place: str = "", file: object = "") -> None:
        self.problem, self.place, self.file = problem, place, file
        text = ": ".join(str(part) for part in (file, place, problem) if part)
        super().__init__(printable(text))


class SolveError(CoilsetError):
    """A solve that did not converge or cannot go on; results up to there are kept."""

    exit_code = 3
