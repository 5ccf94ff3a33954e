"""Inverse design: find entries of a case so that its run meets conditions; `design` is the entry point."""
