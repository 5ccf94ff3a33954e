"""The arrays of a law with several back stresses."""

from collections import namedtuple

# What the law's kernels take in the place of the parameter array: that array, and ⅔Cᵢ and γᵢ, shape (terms, 2).
BackStresses = namedtuple("BackStresses", "plastic terms")


def columns(components: int, terms: int) -> int:
    """How many numbers all back stresses but the last add to a point's state."""
    return components * (terms - 1)
