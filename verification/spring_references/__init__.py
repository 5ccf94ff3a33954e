"""Whole springs solved by other means than rods: rates, characteristics, presetting coil by coil, vibrations."""
