"""The helical slice: one section of a uniform coil represents the whole three-dimensional problem."""
