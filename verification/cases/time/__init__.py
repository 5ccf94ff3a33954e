"""Creep, relaxation and heat."""
