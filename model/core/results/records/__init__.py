"""Numbers of a run as frozen records."""
