"""A spring by the formulas of the standards, beside its run."""
