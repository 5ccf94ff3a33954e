"""References of the cases, computed from the equations by other means than the program's: none imports the rod."""
