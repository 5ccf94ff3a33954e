"""Some turns as a solid beside the rod, springs gone on to a state; files and figures of slices and vibrations."""
