"""Identification of a material's constants from tests: `fit` is the entry point, `experiments` reads the tests."""
