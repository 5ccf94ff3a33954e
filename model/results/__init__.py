"""What a run leaves behind: summary, history, fields, point state and figures."""
