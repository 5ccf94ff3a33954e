"""The cases, one a module; see coilset.verification."""
