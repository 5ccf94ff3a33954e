"""Sections of curved wires: elastic ones against Göhner's equation, plastic ones against the solid."""
