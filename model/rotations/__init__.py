"""Finite rotations by rotation vectors: compiled `kernels` for single nodes, `vectors` for derivatives, `triples` of numbers."""
