"""What a body is to the solver, and the state that a step changes."""
