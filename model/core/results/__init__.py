"""Results of a run: summary, steps, fields, point state and figures."""
