"""Many steps: load program, step control with its error, stability and snap-through."""
