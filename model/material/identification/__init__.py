"""Identification of a material's constants from tests: `fit` is the way in, `experiments` reads the tests."""
