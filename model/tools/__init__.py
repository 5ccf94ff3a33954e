"""What is done with runs: each folder is a package that can be deleted."""
