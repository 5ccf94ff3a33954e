"""How far a coil spring sets, and what stress remains in it. Import `coilset.api` and `coilset.open`."""

__version__ = "0.1.0"
