"""What a run leaves behind: summary, steps, fields, point state and figures."""
