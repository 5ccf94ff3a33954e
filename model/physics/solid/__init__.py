"""The 3D solid model of a wire: updated Lagrange on a moving mesh, finite rotations, elasto-plastic points."""
