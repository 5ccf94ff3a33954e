"""Inverse design: entries of a case sought so that its run meets conditions; `wish` holds the entries, `search` the way."""
