"""Sweeps: one base case, some entries varied, every case run once, and the results in one labelled data set."""
