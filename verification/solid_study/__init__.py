"""A coil section as a 3D solid: against closed solutions, and the rod against it."""
