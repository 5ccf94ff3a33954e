"""The uniform rod: a coil whose state is the same all along the wire."""
