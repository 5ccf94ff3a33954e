"""Load programs: where the spring is driven to, in which steps, and what is recorded on the way."""
