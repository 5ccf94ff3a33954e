"""The command line of coilset."""
