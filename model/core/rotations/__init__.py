"""Finite rotations by rotation vectors: `kernels` for single nodes, `vectors` for derivatives, `triples` of numbers."""
