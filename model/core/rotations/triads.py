"""Triads of unit vectors along given directions."""

import numpy as np


def chord_triads(chords: np.ndarray) -> np.ndarray:
    """Right-handed orthonormal triads (columns) with the first axis along the chords, shape (n, 3) → (n, 3, 3).

    The second axis is as level as possible; for a round wire its direction is free (the external node 3 of 5.2.5).
    """
    e1 = chords / np.linalg.norm(chords, axis=1, keepdims=True)
    helper = np.where(np.abs(e1[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    e2 = np.cross(helper, e1)
    e2 /= np.linalg.norm(e2, axis=1, keepdims=True)
    return np.stack([e1, e2, np.cross(e1, e2)], axis=-1)
