"""Several back stresses, and their spin."""
