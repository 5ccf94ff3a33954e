"""Output of commands and input from the user."""
