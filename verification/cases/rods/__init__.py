"""Rods at large rotations against closed and published solutions."""
