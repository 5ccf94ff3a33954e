"""Triads along chords."""

import numpy as np

from coilset.model.core.rotations.triads import chord_triads


def test_triads_are_right_handed_with_the_chord_first():
    chords = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, -5.0], [0.0, 1.0, 0.0]])
    E = chord_triads(chords)
    np.testing.assert_allclose(np.einsum("nji,njk->nik", E, E), np.tile(np.eye(3), (3, 1, 1)), atol=1e-15)
    np.testing.assert_allclose(np.linalg.det(E), 1.0, rtol=1e-14)
    np.testing.assert_allclose(E[:, :, 0], chords / np.linalg.norm(chords, axis=1)[:, None], rtol=1e-15)
