"""Inverse design: entries of a case sought so that its run meets conditions; `design` is the way in."""
