"""The helical slice: one section of a uniform coil as the whole three-dimensional problem."""
