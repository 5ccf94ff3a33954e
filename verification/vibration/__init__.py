"""Reference for small vibrations."""
