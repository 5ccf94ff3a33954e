"""Finite rotations by rotation vectors: compiled `kernels` for one node at a time, `vectors` for arrays, also complex."""
