"""Files of a results folder."""
