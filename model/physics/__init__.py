"""What may be added to the core: each folder is a package that can be deleted."""
