"""What of a spring is permitted: values, limits with their sources, and what lies between."""
