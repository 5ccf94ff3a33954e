"""A turn or more of a cylindrical spring as a 3D solid, beside the rod."""
