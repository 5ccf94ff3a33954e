"""References of the cases, computed from the equations by means other than the program's: none imports the rod."""
