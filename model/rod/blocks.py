"""Cells that are taken together."""


def blocks(cells: slice, size: int) -> list[slice]:
    """A range of cells in blocks of so many; the last has what is left."""
    return [slice(first, min(first + size, cells.stop)) for first in range(cells.start, cells.stop, size)]
