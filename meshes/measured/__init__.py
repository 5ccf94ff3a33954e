"""A spring from a measured centre line."""
