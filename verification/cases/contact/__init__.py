"""Contact of rods, coils and seats."""
