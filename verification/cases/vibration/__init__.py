"""Small vibrations."""
