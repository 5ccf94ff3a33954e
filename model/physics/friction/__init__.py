"""Friction of coils, seats and guides."""
