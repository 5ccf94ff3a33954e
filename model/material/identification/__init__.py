"""Identification of a material's constants from tests."""
