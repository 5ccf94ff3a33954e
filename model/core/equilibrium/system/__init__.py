"""Unknowns, heads, loads, the residual of all bodies and contacts, and the tangent matrix."""
