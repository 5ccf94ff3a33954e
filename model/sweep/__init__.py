"""Sweeps: one base case, some entries varied, every case run once, and what they found in one labelled data set."""
