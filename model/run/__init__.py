"""From a case to the records of its run."""
