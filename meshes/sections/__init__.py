"""Outlines of wire, and meshes of its section."""
