"""Counting what an analysis does without changing what it does."""

from collections.abc import Callable
from typing import Any


def listen(owner: object, method: str, hear: Callable[[Any], object]) -> None:
    """Have `hear` called with what each call of a method of `owner` has returned."""
    inner = getattr(owner, method)

    def heard(*arguments: Any, **named: Any) -> Any:
        found = inner(*arguments, **named)
        hear(found)
        return found

    setattr(owner, method, heard)
