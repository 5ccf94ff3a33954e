"""What every room may use: errors, entries of files, warnings, compatibility with versions of DOLFINx."""
