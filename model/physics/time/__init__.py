"""Creep, overstress and heat: laws and rods that depend on time."""
