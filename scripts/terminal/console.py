"""The console of all commands: names and messages are printed as they are, though brackets in them look like markup."""

from typing import Any

from rich import console
from rich.markup import escape


class Console(console.Console):
    """As rich's, which highlights nothing; what is printed with `print` may have rich's markup.

    Args:
        options: of rich's.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(highlight=False, **options)

    def say(self, text: str, whole: bool = False) -> None:
        """A line with names of the user's, wrapped at the width of the console unless it stays whole."""
        self.print(text, markup=False, soft_wrap=whole)

    def warn(self, text: str, kind: str = "warning") -> None:
        """A warning, or another line that begins with its kind."""
        self.print(f"[yellow]{kind}:[/] {escape(text)}")
