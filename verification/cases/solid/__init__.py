"""The slice, the solid and the rod against each other."""
