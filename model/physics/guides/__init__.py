"""Grooves, slots, arbors, sleeves and springs that hold wire or seats."""
